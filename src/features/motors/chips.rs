//! The chips of the strip: the motors that have answered, and what each reports.

use motorlink_i18n::tr;
use std::fmt::Write;

use motorlink_messages::protocol::{Faults, MotorId};

use crate::{
    model::{
        motor_list::edit_button,
        names_and_sides::{NamesAndSides, Side},
        snapshot::{Reading, Session},
        terms,
    },
    ui::{
        escape::escaped,
        format::{self, UNKNOWN},
    },
};

/// The labels of [`FIGURES`], in the same order.
pub(crate) const FIGURES: [&str; 5] = ["speed", "current", "temperature", "faults", "age"];

/// A figure of a chip.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Figure {
    pub(crate) text: String,
    /// Its class.
    pub(crate) look: &'static str,
}

impl Figure {
    fn of<T>(reading: Option<Reading<T>>, show: impl FnOnce(T) -> String) -> Self {
        match reading {
            Some(reading) => Self {
                look: if reading.is_fresh() { "fresh" } else { "stale" },
                text: show(reading.value),
            },
            None => Self {
                text: UNKNOWN.to_owned(),
                look: "stale",
            },
        }
    }
}

/// The content that does not change with every report, as HTML.
pub(crate) fn chips_html(found: &[MotorId], names: &NamesAndSides, selected: MotorId) -> String {
    let mut html = String::new();
    for id in found {
        let member = names.member(*id).cloned().unwrap_or_default();
        let name = escaped(member.name().trim());
        let (side, of_side) = match member.side {
            Side::None => ("", ""),
            Side::Left => (tr!("L" as "left side"), tr!("left")),
            Side::Right => (tr!("R" as "right side"), tr!("right, mirrored")),
        };
        let title = if member.side.mirror().is_mirrored() {
            let words = tr!("Mirrored: speed and current have the opposite sign on the bus");
            format!(" title=\"{words}\"")
        } else {
            String::new()
        };
        let mut label = tr!("Motor {id}", id);
        for part in [name.as_str(), of_side] {
            if !part.is_empty() {
                label = format!("{label}, {part}");
            }
        }
        let _ = write!(
            html,
            "<div class=\"motor-chip\" role=\"listitem\"{title}>\
             <button type=\"button\" class=\"motor-chip-button\" value=\"{}\" aria-pressed=\"{}\" \
             aria-label=\"{label}\"><b>{id}</b> <span class=\"motor-name\">{name}</span></button>\
             <span class=\"motor-side\">{side}</span>{}",
            id.get(),
            *id == selected,
            edit_button(*id)
        );
        for name in FIGURES {
            let _ = write!(
                html,
                "<span class=\"motor-figure\" data-figure=\"{name}\">{UNKNOWN}</span>"
            );
        }
        html.push_str("</div>");
    }
    if html.is_empty() {
        let words = tr!("No motors found yet.");
        let _ = write!(
            html,
            "<span class=\"quiet\" role=\"listitem\">{words}</span>"
        );
    }
    html
}

/// The present values of a chip, in the order of [`FIGURES`].
pub(crate) fn figures(session: &Session, id: MotorId) -> [Figure; 5] {
    let speed = session.speed(id);
    let age = speed.map(|reading| reading.age);
    let mut faults = Figure::of(session.faults(id), brief);
    let is_bad = session
        .faults(id)
        .is_some_and(|faults| !faults.value.is_none());
    let answer = session.motor(id).map(|motor| motor.answer);
    if let Some(trouble) = answer.and_then(terms::trouble_of_replies) {
        faults = Figure {
            text: trouble.to_owned(),
            look: "silent",
        };
    } else if is_bad && faults.look == "fresh" {
        faults.look = "bad";
    }
    [
        Figure::of(speed, format::speed_in_rpm),
        Figure::of(session.current(id), |current| {
            let (figure, unit) = format::current_in(current, session.is_current_certain());
            format!("{figure} {unit}")
        }),
        Figure::of(session.temperature(id), |temperature| {
            format!("{} °C", temperature.degrees())
        }),
        faults,
        Figure {
            text: age.map_or_else(|| UNKNOWN.to_owned(), format::age),
            look: "age",
        },
    ]
}

/// `OK`, or the fault byte: the names do not fit here, and the card of the selected motor has them.
fn brief(faults: Faults) -> String {
    if faults.is_none() {
        "OK".to_owned()
    } else {
        let byte = format!("0x{:02X}", faults.byte());
        tr!("fault {byte}", byte)
    }
}

#[cfg(test)]
mod tests {

    use motorlink_messages::bus::Answer;
    use motorlink_messages::protocol::Mode;

    use super::*;
    use crate::model::{
        scan_texts::tests::id,
        snapshot::tests::{ID, session, status},
    };

    fn texts(session: &Session) -> Vec<(String, &'static str)> {
        let figures = figures(session, ID);
        figures.map(|figure| (figure.text, figure.look)).into()
    }

    #[test]
    fn a_chip_says_who_it_is_and_who_is_chosen() {
        let mut names = NamesAndSides::default();
        names.change(id(2), |member| {
            member.set_name("<i>\"A\"&B ");
            member.side = Side::Right;
        });
        let html = chips_html(&[id(1), id(2)], &names, id(2));
        assert!(
            html.contains("value=\"1\" aria-pressed=\"false\" aria-label=\"Motor 0x01\""),
            "{html}"
        );
        assert!(
            html.contains(
                "aria-label=\"Motor 0x02, &lt;i&gt;&quot;A&quot;&amp;B, right, mirrored\""
            ),
            "{html}"
        );
        assert!(!html.contains("<i>"), "{html}");
        assert_eq!(html.matches("aria-pressed=\"true\"").count(), 1);
        assert_eq!(html.matches("data-figure").count(), 2 * FIGURES.len());
        assert!(chips_html(&[], &names, ID).contains("No motors found yet."));
    }

    #[test]
    fn figures_grow_old_and_what_is_not_known_is_no_zero() {
        let mut session = session(1_016, status(1_000, Mode::Velocity, -100));
        let now = [
            ("\u{2212}100 rpm", "fresh"),
            ("+0.02 A", "fresh"),
            ("33 °C", "fresh"),
            ("OK", "fresh"),
            ("0.1 s", "age"),
        ];
        let now = now.map(|(text, look)| (text.to_owned(), look));
        assert_eq!(texts(&session), now);
        session.now = session.now + std::time::Duration::from_secs(1);
        let later = texts(&session);
        assert_eq!(later[0], ("\u{2212}100 rpm".to_owned(), "stale"));
        assert_eq!(later[4].0, "1.1 s");
        session.motors[0].temperature = None;
        assert_eq!(texts(&session)[2], (UNKNOWN.to_owned(), "stale"));
        assert_eq!(texts(&Session::default())[0].0, UNKNOWN);
    }

    #[test]
    fn a_silent_motor_is_not_ok() {
        let mut session = session(4_000, status(1_000, Mode::Velocity, 0));
        session.motors[0].answer = Answer::Missing;
        assert_eq!(texts(&session)[3], ("No reply".to_owned(), "silent"));
    }

    #[test]
    fn a_fault_is_told_by_its_byte() {
        let mut session = session(1_016, status(1_000, Mode::Velocity, 0));
        let reply = &mut session.motors[0].last.as_mut().unwrap().reply;
        reply.faults = Faults::from_byte(0x18);
        assert_eq!(texts(&session)[3], ("fault 0x18".to_owned(), "bad"));
    }
}
