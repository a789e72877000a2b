//! The record of a run as a CSV table, one row per reply.

use std::fmt::Write;

use motorlink_protocol::{Instant, Setpoint};

use crate::runner::{Record, SentSetpoint};

/// The columns. `docs/experiments.md` explains them.
const HEAD: &str =
    "time,motor,speed_rpm,current_a,angle_deg,temperature_c,setpoint,setpoint_unit,step,sent\n";

/// The table. A cell is empty if the reply does not have the value, or if nothing was sent yet.
#[must_use]
pub fn record_to_csv(record: &Record) -> String {
    let mut out = HEAD.to_owned();
    let began = record.began_at();
    let seconds = |at: Instant| began.map_or(0.0, |began| at.since(began).as_secs_f64());
    let mut sent = record.sent_setpoints().iter().peekable();
    let mut marks = record.marks().iter().peekable();
    let mut last: Vec<SentSetpoint> = Vec::new();
    let mut step = None;
    for sample in record.samples() {
        while let Some(next) = sent.next_if(|next| next.at <= sample.at) {
            last.retain(|other| other.id != next.id);
            last.push(*next);
        }
        while let Some(mark) = marks.next_if(|mark| mark.at <= sample.at) {
            step = Some(mark.step);
        }
        // Writing to a string cannot fail.
        let _ = write!(out, "{:.6},{},", seconds(sample.at), sample.id.get());
        if let Some(rpm) = sample.rpm {
            let _ = write!(out, "{rpm}");
        }
        out.push(',');
        if let Some(current) = sample.current {
            let _ = write!(out, "{:.3}", current.amps());
        }
        out.push(',');
        if let Some(degrees) = sample.degrees {
            let _ = write!(out, "{degrees:.2}");
        }
        out.push(',');
        if let Some(celsius) = sample.celsius {
            let _ = write!(out, "{celsius}");
        }
        let sent = last.iter().find(|sent| sent.id == sample.id);
        let (value, unit) = sent.map_or_else(Default::default, |sent| shown(sent.setpoint));
        let sent = sent.map_or_else(String::new, |sent| format!("{:.6}", seconds(sent.at)));
        let step = step.map_or_else(String::new, |step: usize| step.to_string());
        let _ = writeln!(out, ",{value},{unit},{step},{sent}");
    }
    out
}

fn shown(setpoint: Setpoint) -> (String, &'static str) {
    match setpoint {
        Setpoint::Velocity { speed, .. } => (speed.rpm().to_string(), "rpm"),
        Setpoint::Brake => ("0".to_owned(), "brake"),
        Setpoint::Current(target) => (format!("{:.3}", target.amps()), "A"),
        Setpoint::Position(target) => (format!("{:.2}", target.degrees()), "deg"),
        Setpoint::OpenLoop(target) => (target.raw().to_string(), "raw"),
    }
}
