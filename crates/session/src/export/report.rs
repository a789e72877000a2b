//! A report of a session as one self-contained HTML file.

use std::time::Duration;

use motorlink_markup::Element;
use motorlink_protocol::MotorId;
use motorlink_recorder::push_iso;

use super::graph::{QUANTITIES, graph};
use crate::{
    overview::{Mark, MotorOverview, Overview},
    reader::Problems,
    record::EventKind,
};

/// Maximal events in the table, so that it stays readable.
const EVENTS_MAX: usize = 500;

const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;\
color:#1a1a1a;background:#fff}table{border-collapse:collapse;margin:.5rem 0 1.5rem}th,td{text-align:left;\
padding:.2rem .8rem .2rem 0;border-bottom:1px solid #ccc;vertical-align:top}td.number{text-align:right}\
svg{width:100%;border:1px solid #ccc;margin:.3rem 0}path{fill:none;stroke-width:1.2}.zero{stroke:#999}\
.mark{stroke:#c00;stroke-dasharray:3 3}svg text{font-size:11px;fill:#555}.bad{color:#a00}";

/// Content of the report besides the overview.
#[derive(Clone, Copy, Debug)]
pub struct About<'a> {
    /// The name of the file.
    pub name: &'a str,
    /// The unreadable parts of the session.
    pub problems: &'a Problems,
}

/// Which sign the figures have.
const SIGN: &str = "Speeds and currents have the sign of the motor itself. A motor that is mounted mirrored reports a \
    negative speed when its wheel turns forward.";

/// The report.
#[must_use]
pub fn report(overview: &Overview, about: About<'_>) -> String {
    let title = format!("Session {}", about.name);
    let head = Element::new("head")
        .child(Element::new("meta").with("charset", "utf-8"))
        .child(Element::new("title").text(title.clone()))
        .child(Element::new("style").text(STYLE));
    let problems = about.problems.iter().map(|(problem, times)| {
        let text = format!("{problem} ({times})");
        Element::new("p").with("class", "bad").text(text)
    });
    let motors = overview
        .motors()
        .flat_map(|(id, motor)| motor_section(overview, id, motor));
    let body = Element::new("body")
        .child(Element::new("h1").text(title))
        .children(problems)
        .child(summary(overview))
        .child(Element::new("p").text(SIGN))
        .children(motors)
        .children(events(overview));
    let page = Element::new("html")
        .with("lang", "en")
        .child(head)
        .child(body);
    let mut out = "<!DOCTYPE html>\n".to_owned();
    page.write(&mut out);
    out.push('\n');
    out
}

fn summary(overview: &Overview) -> Element {
    let time = |ns: Option<u64>| {
        let us = ns.and_then(|ns| i64::try_from(ns / 1_000).ok());
        let mut text = String::new();
        push_iso(&mut text, us.unwrap_or_default());
        text
    };
    let span = overview.span_ns();
    let count = |kind| {
        let marks = overview.marks().iter().filter(|mark| mark.kind == kind);
        marks.count().to_string()
    };
    let rows = [
        ("From", time(span.map(|(from, _)| from))),
        ("To", time(span.map(|(_, to)| to))),
        ("Duration", duration_text(overview.duration())),
        ("Motors", overview.motors().count().to_string()),
        ("Frames sent", overview.sent.to_string()),
        ("Replies", overview.received.to_string()),
        (
            "Lost",
            share(overview.lost, overview.received + overview.lost),
        ),
        ("Pieces of invalid bytes", overview.junk.to_string()),
        (
            "Frames that the port refused",
            overview.not_sent.to_string(),
        ),
        ("Stops", count(EventKind::StopEnded)),
        ("Limits crossed", count(EventKind::Limit)),
    ];
    table(rows)
}

fn table<const N: usize>(rows: [(&str, String); N]) -> Element {
    let rows = rows.into_iter().map(|(name, value)| {
        let name = Element::new("th").with("scope", "row").text(name);
        Element::new("tr")
            .child(name)
            .child(Element::new("td").text(value))
    });
    Element::new("table").children(rows)
}

fn motor_section(overview: &Overview, id: MotorId, motor: &MotorOverview) -> Vec<Element> {
    let unknown = || "unknown".to_owned();
    let extent = motor.extent();
    let speed = extent.map(|extent| format!("{} to {}", extent.speed.0, extent.speed.1));
    let current = extent.and_then(|extent| extent.current);
    let current = current.map(|(least, most)| format!("{least} to {most}"));
    let temperature = motor
        .temperature_max_c
        .map(|degrees| format!("{degrees} °C"));
    let faults = if motor.faults.is_none() {
        "none".to_owned()
    } else {
        motor.faults.to_string()
    };
    let rows = [
        ("Speed", speed.unwrap_or_else(unknown)),
        ("Current", current.unwrap_or_else(unknown)),
        ("Highest temperature", temperature.unwrap_or_else(unknown)),
        ("Faults", faults),
        ("Frames sent to it", motor.sent.to_string()),
        ("Replies", motor.replies.to_string()),
        ("Lost", share(motor.lost, motor.replies + motor.lost)),
    ];
    let mut section = vec![
        Element::new("h2").text(format!("Motor {}", id.get())),
        table(rows),
    ];
    for quantity in QUANTITIES.iter().filter(|_| extent.is_some()) {
        section.push(Element::new("h3").text(format!("{} ({})", quantity.name, quantity.unit)));
        section.push(graph(overview, motor, quantity));
    }
    section
}

fn events(overview: &Overview) -> Vec<Element> {
    let row = |mark: &Mark| {
        let time = format!("{:.3} s", mark.after.as_secs_f64());
        let class = if mark.error { "bad" } else { "good" };
        Element::new("tr")
            .child(Element::new("td").with("class", "number").text(time))
            .child(Element::new("td").text(mark.kind.name().replace('_', " ")))
            .child(
                Element::new("td")
                    .with("class", class)
                    .text(mark.text.clone()),
            )
    };
    let marks = overview.marks();
    let rows = marks.iter().take(EVENTS_MAX).map(row);
    let mut section = vec![
        Element::new("h2").text("Events"),
        Element::new("table").children(rows),
    ];
    let left_out = marks.len().saturating_sub(EVENTS_MAX) as u64 + overview.marks_left_out;
    if left_out > 0 {
        section.push(Element::new("p").text(format!("{left_out} more events are in the file.")));
    }
    section
}

fn duration_text(duration: Duration) -> String {
    let seconds = duration.as_secs();
    let (hours, minutes) = (seconds / 3600, seconds / 60 % 60);
    let millis = duration.subsec_millis();
    format!("{hours}:{minutes:02}:{:02}.{millis:03}", seconds % 60)
}

/// `12 (0.4 %)`, in integer arithmetic.
fn share(part: u64, whole: u64) -> String {
    let tenths = part.saturating_mul(1_000).checked_div(whole).unwrap_or(0);
    format!("{part} ({}.{} %)", tenths / 10, tenths % 10)
}
