//! Whether a control can be used now, and the reason if it cannot.
//!
//! The bus decides and refuses. `ReportedState` of its crate says beforehand what it refuses; the guards have the words,
//! so that a button shows the reason before it is pressed.

use crate::{
    link::{serial_ports, worker_link::WorkerState},
    model::{
        names_and_sides::{GroupMembers, Side},
        notice_texts, replay,
        snapshot::{Session, is_active},
        terms,
    },
};
use motorlink_i18n::tr;
use motorlink_messages::{
    Adapter, Connection,
    bus::{Activity, GroupError, GroupSetpoints, Refusal, ReportedState},
    protocol::{Mode, MotorId, family::Model},
};

/// That this motor is silent, or that its replies are corrupted: in the words of the notice.
pub(crate) fn blocked_by_silence(session: &Session, id: MotorId) -> Option<String> {
    let silent = session.motor(id)?.silent;
    silent.then(|| notice_texts::of_silence(&[id], session.garbled.contains(&id)).title)
}

fn blocked_by_connection(connection: Connection) -> Option<String> {
    let reason = match connection {
        Connection::Connected(Adapter::Recording) => replay::blocked(),
        Connection::Connected(_) => return None,
        Connection::Disconnected | Connection::Failed(_) => {
            tr!("Not connected. Press Connect or Virtual motor.")
        }
        Connection::Connecting => tr!("Opening the port."),
        Connection::Reconnecting(_) => tr!("The adapter is unplugged. Plug it back in."),
    };
    Some(reason.to_owned())
}

/// The state that decides about commands.
fn reported(session: &Session) -> ReportedState<'_> {
    ReportedState {
        now: session.now,
        model: session.line.map_or(Model::Ddsm115, |line| line.model),
        halted: session.halted,
        has_job: session.job.is_some(),
        motors: &session.motors,
    }
}

/// A refusal in the words that name the button to press.
fn words(session: &Session, refusal: Refusal) -> String {
    let switches_to = |id| match session.motor(id)?.activity {
        Activity::Switching { to } => Some(switching(id, to)),
        _ => None,
    };
    let better = match refusal {
        Refusal::NotAnswering(id) => blocked_by_silence(session, id),
        Refusal::Switching(id) => switches_to(id),
        Refusal::OtherLoop {
            id,
            asked,
            reported,
        } => switches_to(id)
            // A disabled button is no advice.
            .or_else(|| switch_blocked_by(session, id, asked))
            .or_else(|| {
                Some(tr!(
                    "Motor {id} is in the {reported}. Press Switch to {mode} first.",
                    id,
                    reported = terms::mode(reported),
                    mode = terms::mode(asked)
                ))
            }),
        _ => None,
    };
    better.unwrap_or_else(|| terms::refusal(refusal))
}

fn switching(id: MotorId, to: Mode) -> String {
    tr!(
        "Motor {id} is switching to the {mode}.",
        id,
        mode = terms::mode(to)
    )
}

/// Why this motor cannot be driven in this loop now.
pub(crate) fn drive_blocked_by(session: &Session, id: MotorId, mode: Mode) -> Option<String> {
    blocked_by_connection(session.connection).or_else(|| {
        let refusal = reported(session).check_drive(id, mode).err()?;
        Some(words(session, refusal))
    })
}

/// Why these motors cannot be driven together in the velocity loop now.
pub(crate) fn group_drive_blocked_by(session: &Session, members: &GroupMembers) -> Option<String> {
    if let Some(reason) = blocked_by_connection(session.connection) {
        return Some(reason);
    }
    let state = reported(session);
    if let Err(refusal) = state.check_motion() {
        return Some(terms::refusal(refusal));
    }
    if members.is_empty() {
        return Some(tr!("Select the motors to drive.").to_owned());
    }
    if members.len() > GroupSetpoints::MAX {
        return Some(terms::not_together(GroupError::TooMany));
    }
    members.iter().find_map(|(id, _)| {
        let refusal = state.check_member(*id, Mode::Velocity).err()?;
        let reason = words(session, refusal);
        let named = reason.contains(&id.to_string());
        Some(if named {
            reason
        } else {
            tr!("Motor {id}: {reason}", id, reason)
        })
    })
}

/// Why these motors cannot be steered as a vehicle now.
pub(crate) fn steer_blocked_by(session: &Session, members: &GroupMembers) -> Option<String> {
    group_drive_blocked_by(session, members).or_else(|| {
        let (id, _) = members.iter().find(|(_, side)| *side == Side::None)?;
        Some(tr!("To steer, set the side of motor {id}.", id))
    })
}

/// Why this motor's side cannot be changed now: it would reverse an active setpoint.
pub(crate) fn side_change_blocked_by(session: &Session, id: MotorId) -> Option<String> {
    let active = session.motor(id).is_some_and(is_active);
    active.then(|| {
        tr!(
            "Motor {id} is running or stopping. Stop it, then change its side.",
            id
        )
    })
}

/// Why this motor's loop cannot be changed to this one now.
pub(crate) fn switch_blocked_by(session: &Session, id: MotorId, mode: Mode) -> Option<String> {
    if let Some(reason) = blocked_by_connection(session.connection) {
        return Some(reason);
    }
    let known = session.mode(id).filter(super::snapshot::Reading::is_fresh);
    let refusal = match reported(session).check_switch(id, mode) {
        // The bus would switch it, and could not confirm that.
        Ok(()) | Err(Refusal::SpeedUnknown(_)) if known.is_none() => {
            Some(Refusal::NotAnswering(id))
        }
        checked => checked.err(),
    };
    if let Some(refusal) = refusal {
        return Some(words(session, refusal));
    }
    if let Activity::Switching { to } = session.motor(id)?.activity {
        return Some(switching(id, to));
    }
    (known?.value == mode).then(|| {
        tr!(
            "The motor is already in the {mode}.",
            mode = terms::mode(mode)
        )
    })
}

/// Why this motor cannot be stopped by its own button. "Stop all motors" can always be pressed.
pub(crate) fn stop_blocked_by(session: &Session) -> Option<String> {
    blocked_by_connection(session.connection)
}

/// Why a scan cannot start. Driven motors do not prevent it: the scan stops them first.
pub(crate) fn scan_blocked_by(session: &Session) -> Option<String> {
    blocked_by_connection(session.connection).or_else(|| {
        let refusal = reported(session).check_scan().err()?;
        Some(terms::refusal(refusal))
    })
}

/// Why no scan can be cancelled.
pub(crate) fn cancel_blocked_by(session: &Session) -> Option<String> {
    session
        .job
        .is_none()
        .then(|| tr!("No scan is running.").to_owned())
}

/// Why a raw frame cannot be sent. While all motors are stopped, only frames that move nothing can be.
pub(crate) fn send_blocked_by(session: &Session, hazardous: bool) -> Option<String> {
    blocked_by_connection(session.connection).or_else(|| {
        let refusal = reported(session).check_raw(hazardous).err()?;
        Some(terms::refusal(refusal))
    })
}

/// Why a setup cannot be imported: it changes sides and groups, which must not change while a motor is
/// driven.
pub(crate) fn import_blocked_by(session: &Session, pad_is_held: bool) -> Option<String> {
    if pad_is_held {
        return Some(tr!("Let go of the drive pad first.").to_owned());
    }
    let motor = session.active_motors().next()?;
    Some(tr!("Motor {id} is in use. Stop it first.", id = motor.id))
}

/// Whether a port is open, is being opened, or is expected back.
pub(crate) fn is_in_use(connection: Connection) -> bool {
    match connection {
        Connection::Disconnected
        | Connection::Failed(_)
        | Connection::Connected(Adapter::Recording) => false,
        Connection::Connecting | Connection::Connected(_) | Connection::Reconnecting(_) => true,
    }
}

/// Why no port can be opened.
pub(crate) fn port_blocked_by(worker: WorkerState) -> Option<String> {
    (worker == WorkerState::Dead)
        .then(|| tr!("The background worker has stopped. Reload the page.").to_owned())
}

/// Why no serial port can be opened.
pub(crate) fn serial_blocked_by(worker: WorkerState) -> Option<String> {
    if !serial_ports::is_supported() {
        let words = tr!(
            "This browser does not support Web Serial. Use desktop Chrome, Edge or Firefox 151 or \
             later, over HTTPS. The virtual motor works in any browser."
        );
        return Some(words.to_owned());
    }
    port_blocked_by(worker)
}

#[cfg(test)]
#[path = "guards_tests.rs"]
mod tests;
