//! The messages of the page in the packet log. Made within [`untranslated`](motorlink_i18n::untranslated), they are
//! shown in the language that is chosen when they are read.

use motorlink_i18n::tr;
use motorlink_messages::{
    Connection, Notice, Update,
    bus::{Activity, IdQueryOutcome, MotorStatus, StopReason, StopReport},
    protocol::{MotorId, Setpoint},
};

use crate::{
    model::{
        mirror::Mirror,
        names_and_sides::NamesAndSides,
        notice_board::{NoticeText, Tone, Topic},
        notice_texts::of_stop_reason,
        snapshot::Session,
        terms,
    },
    ui::format,
};

/// A message for the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Line {
    /// Whether it is an error.
    pub(crate) error: bool,
    /// One line.
    pub(crate) text: String,
}

/// A message that is no error.
pub(crate) fn calm(text: impl Into<String>) -> Line {
    Line {
        error: false,
        text: text.into(),
    }
}

/// The message of a notice, without its advice; but with the advice if that is the reason why a command was
/// not sent.
pub(crate) fn of_notice(words: &NoticeText) -> Line {
    let refused = words.topic == Topic::Command && words.tone == Tone::Warning;
    let text = if refused {
        tr!(
            "{title}. {advice}",
            title = words.title,
            advice = words.advice.join(" ")
        )
    } else {
        words.title.clone()
    };
    Line {
        error: words.tone == Tone::Error,
        text,
    }
}

/// What begins with an update: motors that are driven or switched. Setpoints have the signs that the operator sees;
/// those of frames have the signs of the wire.
pub(crate) fn of_beginnings(before: &Session, update: &Update, names: &NamesAndSides) -> Vec<Line> {
    let begins = |motor: &MotorStatus| {
        let activity_before = before.motor(motor.id).map(|motor| motor.activity);
        let mirror = names.mirror(motor.id);
        of_activity(motor.id, mirror, activity_before, motor.activity)
    };
    update.motors.iter().filter_map(begins).collect()
}

/// What becomes of the port.
pub(crate) fn of_connection(before: Connection, after: Connection) -> Option<Line> {
    if after.is_same_line(before) {
        return None;
    }
    match after {
        Connection::Connected(adapter) => {
            let adapter = terms::adapter(adapter).replace(" · ", ", ");
            Some(calm(tr!("Connected to {adapter}", adapter)))
        }
        Connection::Disconnected => Some(calm(tr!("Disconnected"))),
        Connection::Connecting => Some(calm(tr!("Opening the port"))),
        // These are notices.
        Connection::Reconnecting(_) | Connection::Failed(_) => None,
    }
}

/// The start of driving. Later setpoints are in the frames.
fn of_activity(
    id: MotorId,
    mirror: Mirror,
    before: Option<Activity>,
    after: Activity,
) -> Option<Line> {
    let driven_before = matches!(before, Some(Activity::Driven { .. }));
    match after {
        Activity::Driven { .. } if driven_before => None,
        Activity::Driven {
            setpoint: Setpoint::Brake,
        } => Some(calm(tr!("Motor {id}: brake on", id))),
        Activity::Driven { setpoint } => {
            let shown = mirror.setpoint(setpoint);
            let mut goal = format::goal(shown);
            if shown != setpoint {
                // The frames beside it have the other sign.
                goal.push_str(tr!(" (mirrored)"));
            }
            Some(calm(tr!("Motor {id} is running: {goal}", id, goal)))
        }
        Activity::Switching { to } if before != Some(after) => Some(calm(tr!(
            "Switching motor {id} to the {mode}",
            id,
            mode = terms::mode(to)
        ))),
        _ => None,
    }
}

/// A notice that the page does not show.
pub(crate) fn of_quiet_notice(notice: &Notice) -> Option<Line> {
    Some(match notice {
        Notice::ModeSwitched { id, mode } => calm(tr!(
            "Motor {id} is in the {mode}",
            id,
            mode = terms::mode(*mode)
        )),
        Notice::MotorBack(id) => calm(tr!("Motor {id} is replying again", id)),
        Notice::IdQueryEnded(IdQueryOutcome::One(id)) => {
            calm(tr!("Motor {id} replied to the ID query", id))
        }
        Notice::StopBegan(reason) => of_stop_begun(*reason),
        Notice::StopEnded(report) => of_stop_ended(report),
        _ => return None,
    })
}

fn of_stop_begun(reason: StopReason) -> Line {
    match reason {
        StopReason::OneMotor => calm(tr!("Stopping a motor or group")),
        reason => calm(tr!("Stopping. {why}", why = of_stop_reason(reason))),
    }
}

/// A stop that every motor has confirmed; other stops are notices.
fn of_stop_ended(report: &StopReport) -> Line {
    let motors: Vec<MotorId> = report.motors.iter().map(|motor| motor.id).collect();
    if motors.is_empty() {
        return calm(tr!("Stopped: no motor was running"));
    }
    calm(terms::stopped(&motors))
}

#[cfg(test)]
#[path = "log_lines_tests.rs"]
mod tests;
