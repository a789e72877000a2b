//! Whether a control can be used now, and the reason if it cannot.
//!
//! The bus decides and refuses. The guards repeat those of its rules that the page can check beforehand, so that
//! a button shows the reason before it is pressed. docs/decisions/0031 says why they are not functions of the bus.

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
    bus::{Activity, Answer, GroupError, GroupSetpoints, Refusal},
    protocol::{Mode, MotorId},
};

/// Why this motor cannot be commanded now.
fn request_blocked_by(session: &Session, id: MotorId) -> Option<String> {
    if let Some(reason) = blocked_by_connection(session.connection) {
        return Some(reason.to_owned());
    }
    if session.halted {
        return Some(terms::refusal(Refusal::Halted));
    }
    let reported = session.mode(id).filter(super::snapshot::Reading::is_fresh);
    if session.job.is_some() {
        return Some(terms::refusal(Refusal::JobRunning));
    }
    if reported.is_none() {
        return blocked_by_silence(session, id)
            .or_else(|| Some(terms::refusal(Refusal::NotAnswering(id))));
    }
    let mut activities = session.motors.iter().map(|motor| motor.activity);
    activities
        .any(|activity| activity == Activity::DrivenRaw)
        .then(|| terms::refusal(Refusal::RawRunning))
}

/// That this motor is silent, or that its replies are corrupted: in the words of the notice.
pub(crate) fn blocked_by_silence(session: &Session, id: MotorId) -> Option<String> {
    let motor = session.motor(id)?;
    let garbled = motor.answer == Answer::Corrupted;
    motor
        .is_silent()
        .then(|| notice_texts::of_silence(&[id], garbled).title)
}

fn blocked_by_connection(connection: Connection) -> Option<&'static str> {
    match connection {
        Connection::Connected(Adapter::Recording) => Some(replay::blocked()),
        Connection::Connected(Adapter::Watched) => Some(tr!("Take control first.")),
        Connection::Connected(_) => None,
        Connection::Disconnected | Connection::Failed(_) => {
            Some(tr!("Not connected. Press Connect motor or Virtual motor."))
        }
        Connection::Connecting => Some(tr!("Opening the port.")),
        Connection::Reconnecting(_) => Some(tr!("The adapter is unplugged. Plug it back in.")),
    }
}

/// Why this motor cannot be driven in this loop now. The bus stops and switches it first.
pub(crate) fn drive_blocked_by(session: &Session, id: MotorId, mode: Mode) -> Option<String> {
    // A key asks for any loop.
    let model = session.line.map(|line| line.model);
    if let Some(model) = model.filter(|model| !model.has(mode)) {
        return Some(terms::refusal(Refusal::NoSuchLoop { model, mode }));
    }
    if let Some(reason) = request_blocked_by(session, id) {
        return Some(reason);
    }
    let faults = session.faults(id)?.value;
    faults
        .any_named()
        .then(|| terms::refusal(Refusal::FaultActive { id, faults }))
}

/// Why a run cannot drive this motor at once, without a stop or a switch.
pub(crate) fn in_loop_blocked_by(session: &Session, id: MotorId, mode: Mode) -> Option<String> {
    if let Some(reason) = drive_blocked_by(session, id, mode) {
        return Some(reason);
    }
    let refusal = match session.motor(id)?.activity {
        Activity::Stopping { .. } => Refusal::Stopping(id),
        Activity::Switching { .. } => Refusal::Switching(id),
        Activity::Idle | Activity::Driven { .. } | Activity::DrivenRaw => {
            let reported = session.mode(id)?.value;
            if reported == mode {
                return None;
            }
            Refusal::OtherLoop {
                id,
                asked: mode,
                reported,
            }
        }
    };
    Some(terms::refusal(refusal))
}

/// Why these motors cannot be driven together in the velocity loop now. The bus stops and switches them first.
pub(crate) fn group_drive_blocked_by(session: &Session, members: &GroupMembers) -> Option<String> {
    if let Some(reason) = blocked_by_connection(session.connection) {
        return Some(reason.to_owned());
    }
    if session.halted {
        return Some(terms::refusal(Refusal::Halted));
    }
    if session.job.is_some() {
        return Some(terms::refusal(Refusal::JobRunning));
    }
    if members.is_empty() {
        return Some(tr!("Select the motors to drive.").to_owned());
    }
    if members.len() > GroupSetpoints::MAX {
        return Some(terms::not_together(GroupError::TooMany));
    }
    first_blocked(members, &|id| drive_blocked_by(session, id, Mode::Velocity))
}

/// Why these motors cannot be steered as a vehicle now. The drive pad never waits.
pub(crate) fn steer_blocked_by(session: &Session, members: &GroupMembers) -> Option<String> {
    if let Some(reason) = group_drive_blocked_by(session, members) {
        return Some(reason);
    }
    let at_once = |id| {
        let is_idle = session.motor(id)?.activity == Activity::Idle;
        let reported = session.mode(id)?.value;
        if !is_idle || reported == Mode::Velocity {
            return in_loop_blocked_by(session, id, Mode::Velocity);
        }
        let reported = terms::mode(reported);
        Some(tr!(
            "Motor {id} is in the {reported}. Press its Stop, which switches it to the velocity loop.",
            id,
            reported
        ))
    };
    first_blocked(members, &at_once).or_else(|| {
        let (id, _) = members.iter().find(|(_, side)| *side == Side::None)?;
        Some(tr!("To steer, set the side of motor {id}.", id))
    })
}

/// Why the first of these motors is blocked, with its name.
fn first_blocked(
    members: &GroupMembers,
    why: &dyn Fn(MotorId) -> Option<String>,
) -> Option<String> {
    members.iter().find_map(|(id, _)| {
        let reason = why(*id)?;
        let named = reason.contains(&id.to_string());
        Some(if named {
            reason
        } else {
            tr!("Motor {id}: {reason}", id, reason)
        })
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

/// Why this motor cannot be stopped by its own button. "Stop all motors" can always be pressed.
pub(crate) fn stop_blocked_by(session: &Session) -> Option<String> {
    blocked_by_connection(session.connection).map(str::to_owned)
}

/// Why a scan cannot start. Driven motors do not prevent it: the scan stops them first.
pub(crate) fn scan_blocked_by(session: &Session) -> Option<String> {
    if let Some(reason) = blocked_by_connection(session.connection) {
        return Some(reason.to_owned());
    }
    let job_runs = session.job.is_some();
    job_runs.then(|| terms::refusal(Refusal::JobRunning))
}

/// Why no ID can be changed. The scan that proves that one motor is on the bus would run, and the change be refused.
pub(crate) fn id_change_blocked_by(session: &Session) -> Option<String> {
    send_blocked_by(session, true)
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
    scan_blocked_by(session)
        .or_else(|| (hazardous && session.halted).then(|| terms::refusal(Refusal::Halted)))
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
