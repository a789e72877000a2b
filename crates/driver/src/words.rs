//! What the bus reports, in words for a terminal and for session files.

use motorlink_bus::{CommandKind, Event, StopOutcome, StopReason, StopReport, WithdrawReason};
use motorlink_protocol::MotorId;
use motorlink_session::{Event as Mark, EventKind};

use crate::entry::Entry;

/// The event of a session file, for an entry that is no frame; `None` if it is routine.
#[must_use]
pub fn session_event(entry: &Entry) -> Option<Mark> {
    if let Entry::Event(Event::StopEnded(report)) = entry {
        return Some(Mark {
            kind: EventKind::StopEnded,
            error: report.motors.iter().any(|motor| !motor.confirmed),
            text: of_stop(report),
            motors: report.motors.clone(),
        });
    }
    let kind = match entry {
        Entry::PortLost { .. } => EventKind::Disconnected,
        Entry::PortBack => EventKind::Connected,
        _ => EventKind::Notice,
    };
    Some(Mark::new(kind, of_entry(entry)?))
}

/// The IDs with commas between.
#[must_use]
pub fn ids(ids: impl IntoIterator<Item = MotorId>) -> String {
    let ids = ids.into_iter().map(|id| id.to_string());
    ids.collect::<Vec<_>>().join(", ")
}

/// What a person should know of an entry, whatever the command is; `None` if it is routine.
#[must_use]
pub fn of_entry(entry: &Entry) -> Option<String> {
    Some(match entry {
        Entry::Event(event) => return of_event(event),
        Entry::Run(_) => return None,
        Entry::Refused { command, refusal } => match command {
            CommandKind::Other | CommandKind::Forget => return None,
            _ => format!("not done: {refusal}"),
        },
        Entry::TooLate(_) => "not done: this computer was too busy. Try again.".to_owned(),
        Entry::NotConnected(_) => "not done: no port is open for it.".to_owned(),
        Entry::PortLost { driven } if driven.is_empty() => {
            "the port is gone. Waiting for it.".to_owned()
        }
        Entry::PortLost { driven } => format!(
            "the port is gone, and the wheels of {} may keep turning: cut their power, or plug the adapter in again, which stops them.",
            ids(driven.iter().copied())
        ),
        Entry::PortBack => "the port is back.".to_owned(),
        Entry::NotRemembered => {
            "what is driven cannot be remembered on disk: if this program is killed, the next one does not stop it.".to_owned()
        }
    })
}

fn of_event(event: &Event) -> Option<String> {
    Some(match event {
        Event::StopBegan(reason) => return why_stopped(*reason).map(str::to_owned),
        Event::StopEnded(report) if report.reason == StopReason::LeftDriven => {
            let is_silent = |motor: &StopOutcome| !motor.confirmed && motor.speed.is_none();
            let hint = if report.motors.iter().any(is_silent) {
                " If it has no power any more: motorlink stop --forget."
            } else {
                ""
            };
            format!(
                "an earlier program had left motors running. {}{hint}",
                of_stop(report)
            )
        }
        Event::NotStarted { id, refusal } => format!("motor {id} not started: {refusal}"),
        Event::Withdrawn { id, reason } => {
            format!("motor {id} is stopped: {}.", why_withdrawn(*reason))
        }
        Event::ModeSwitchFailed {
            id,
            asked,
            reported,
        } => match reported {
            Some(reported) => format!("motor {id} is still in the {reported}, not the {asked}."),
            None => format!("motor {id} did not confirm the switch to the {asked}."),
        },
        Event::MotorSilent { id, garbled: true } => {
            format!("no valid reply from motor {id} for 2 s: its bytes are corrupted.")
        }
        Event::MotorSilent { id, garbled: false } => {
            format!("no reply from motor {id} for 2 s. Check its supply, A and B, and its ID.")
        }
        Event::MotorBack(id) => format!("motor {id} answers again."),
        Event::OtherModel { expected, found } => {
            format!("a {found} answers on this line, not a {expected}: all motors are stopped.")
        }
        Event::SendsText { is_json: true } => {
            "a driver board sends JSON: set its switch to the plain USB bridge.".to_owned()
        }
        Event::SendsText { is_json: false } => {
            "another device sends text on this port. Is it the right one?".to_owned()
        }
        Event::Telemetry(_)
        | Event::IdQueryEnded(_)
        | Event::Line(_)
        | Event::ScanEnded(_)
        | Event::IdChangeEnded { .. }
        | Event::ModeSwitched { .. }
        | Event::StopEnded(_)
        | Event::PingPage => return None,
    })
}

/// Why all motors are stopped, where nobody asked for it.
fn why_stopped(reason: StopReason) -> Option<&'static str> {
    match reason {
        StopReason::PageSilent => {
            Some("all motors are stopped: this program did not run for a second.")
        }
        StopReason::OperatorLost => Some(
            "all motors are stopped: the page or controller that drove lost or gave up control.",
        ),
        StopReason::ComputerSlept => Some("all motors are stopped: the computer slept."),
        StopReason::LoopDelayed => {
            Some("all motors are stopped: this computer was too busy to drive them.")
        }
        StopReason::LeftDriven => Some("stopping motors that an earlier program left running."),
        StopReason::Operator
        | StopReason::PageHidden
        | StopReason::PageGone
        | StopReason::Disconnect
        | StopReason::Job
        | StopReason::OneMotor
        | StopReason::OtherModel => None,
    }
}

fn why_withdrawn(reason: WithdrawReason) -> String {
    match reason {
        WithdrawReason::Silent => "no reply for 200 ms".to_owned(),
        WithdrawReason::Fault(faults) => format!("it reports a fault ({faults})"),
        WithdrawReason::OtherLoop { reported } => {
            format!("it is now in the {reported} (power loss, or another master)")
        }
        WithdrawReason::NotEnabled => "it is not enabled any more (power loss)".to_owned(),
        WithdrawReason::Limit(exceeded) => format!("a limit was exceeded ({exceeded})"),
        WithdrawReason::TemperatureUnknown => {
            "its temperature has not been known for 2 s".to_owned()
        }
        WithdrawReason::AngleMisfits => "its angle does not fit its motion".to_owned(),
    }
}

/// What a stop has shown of each motor.
#[must_use]
pub fn of_stop(report: &StopReport) -> String {
    let of_motor = |motor: &StopOutcome| {
        let id = motor.id;
        match (motor.confirmed, motor.speed) {
            (true, _) => format!("Motor {id} stands, confirmed."),
            (false, Some(speed)) => {
                format!("MOTOR {id} IS NOT CONFIRMED TO STAND: it reports {speed}.")
            }
            (false, None) => format!("MOTOR {id} IS NOT CONFIRMED TO STAND: it does not answer."),
        }
    };
    let motors: Vec<_> = report.motors.iter().map(of_motor).collect();
    motors.join(" ")
}
