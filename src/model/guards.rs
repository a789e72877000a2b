//! Whether a control applies now, and the reason to show where it does not.
//!
//! The bus decides what is driven and refuses what must not be; these are its rules as far as a
//! person can know them beforehand, so that a button says why before it is pressed.

use crate::{
    link::{serial_ports, worker_link::WorkerState},
    model::{
        fleet::{Crew, Side},
        snapshot::{Session, is_in_hand},
        terms,
    },
};
use motorlink_i18n::tr;
use motorlink_messages::{
    Connection,
    bus::{Activity, GroupError, GroupSetpoints, Refusal, check_position_switch},
    protocol::{Mode, MotorId},
};

/// Why nothing can be asked of this motor now.
fn why_not_asked(session: &Session, id: MotorId) -> Option<String> {
    if let Some(reason) = why_not_connected(session.connection) {
        return Some(reason.to_owned());
    }
    if session.halted {
        return Some(terms::refusal(Refusal::Halted));
    }
    let heard = session.mode(id).filter(super::snapshot::Reading::is_fresh);
    if session.job.is_some() {
        return Some(terms::refusal(Refusal::JobRunning));
    }
    if heard.is_none() {
        return Some(terms::refusal(Refusal::NotAnswering(id)));
    }
    let mut activities = session.motors.iter().map(|motor| motor.activity);
    activities
        .any(|activity| activity == Activity::DrivenRaw)
        .then(|| terms::refusal(Refusal::RawRunning))
}

fn why_not_connected(connection: Connection) -> Option<&'static str> {
    match connection {
        Connection::Connected(_) => None,
        Connection::Disconnected | Connection::Failed(_) => {
            Some(tr!("Not connected. Press Connect or Virtual motor."))
        }
        Connection::Connecting => Some(tr!("Opening the port.")),
        Connection::Reconnecting(_) => Some(tr!("The adapter is unplugged. Plug it back in.")),
    }
}

/// What a motor has to be through with first.
fn why_not_yet(id: MotorId, activity: Activity) -> Option<String> {
    match activity {
        Activity::Stopping { .. } => Some(terms::refusal(Refusal::Stopping(id))),
        Activity::Switching { to } => Some(tr!(
            "Motor {id} is switching to the {mode}.",
            id,
            mode = terms::mode(to)
        )),
        Activity::Idle | Activity::Driven { .. } | Activity::DrivenRaw => None,
    }
}

/// Why this motor cannot be driven in this loop now.
pub(crate) fn why_not_drive(session: &Session, id: MotorId, mode: Mode) -> Option<String> {
    if let Some(reason) = why_not_asked(session, id) {
        return Some(reason);
    }
    if let Some(reason) = why_not_yet(id, session.motor(id)?.activity) {
        return Some(reason);
    }
    let faults = session.faults(id)?.value;
    if faults.any_named() {
        return Some(terms::refusal(Refusal::FaultActive { id, faults }));
    }
    let reported = session.mode(id)?.value;
    (reported != mode).then(|| {
        tr!(
            "Motor {id} is in the {reported}. Press Switch to {mode} first.",
            id,
            reported = terms::mode(reported),
            mode = terms::mode(mode)
        )
    })
}

/// Why these motors cannot be driven together in the velocity loop now.
pub(crate) fn why_not_together(session: &Session, crew: &Crew) -> Option<String> {
    if let Some(reason) = why_not_connected(session.connection) {
        return Some(reason.to_owned());
    }
    if session.halted {
        return Some(terms::refusal(Refusal::Halted));
    }
    if session.job.is_some() {
        return Some(terms::refusal(Refusal::JobRunning));
    }
    if crew.is_empty() {
        return Some(tr!("Select the motors to drive.").to_owned());
    }
    if crew.len() > GroupSetpoints::MAX {
        return Some(terms::not_together(GroupError::TooMany));
    }
    crew.iter().find_map(|(id, _)| {
        let reason = why_not_drive(session, *id, Mode::Velocity)?;
        let named = reason.contains(&id.to_string());
        Some(if named {
            reason
        } else {
            tr!("Motor {id}: {reason}", id, reason)
        })
    })
}

/// Why these motors cannot be steered as a vehicle now.
pub(crate) fn why_not_steer(session: &Session, crew: &Crew) -> Option<String> {
    why_not_together(session, crew).or_else(|| {
        let (id, _) = crew.iter().find(|(_, side)| *side == Side::None)?;
        Some(tr!("To steer, set the side of motor {id}.", id))
    })
}

/// Why this motor's side cannot be changed now: a setpoint that stands would turn with it.
pub(crate) fn why_not_side(session: &Session, id: MotorId) -> Option<String> {
    let in_hand = session.motor(id).is_some_and(is_in_hand);
    in_hand.then(|| {
        tr!(
            "Motor {id} is running or stopping. Stop it, then change its side.",
            id
        )
    })
}

/// Why this motor's loop cannot be changed to this one now.
pub(crate) fn why_not_switch(session: &Session, id: MotorId, mode: Mode) -> Option<String> {
    if let Some(reason) = why_not_asked(session, id) {
        return Some(reason);
    }
    if let Some(reason) = why_not_yet(id, session.motor(id)?.activity) {
        return Some(reason);
    }
    if session.mode(id)?.value == mode {
        return Some(tr!(
            "The motor is already in the {mode}.",
            mode = terms::mode(mode)
        ));
    }
    if mode != Mode::Position {
        return None;
    }
    let speed = session.speed(id).filter(super::snapshot::Reading::is_fresh);
    let speed = speed.map(|reading| reading.value);
    check_position_switch(id, speed).err().map(terms::refusal)
}

/// Why this motor cannot be stopped on its own. Stop all motors has no such reason, ever.
pub(crate) fn why_not_stop(session: &Session) -> Option<String> {
    why_not_connected(session.connection).map(str::to_owned)
}

/// Why nobody can be asked who is there. What is driven is no reason: it is stopped first.
pub(crate) fn why_not_scan(session: &Session) -> Option<String> {
    if let Some(reason) = why_not_connected(session.connection) {
        return Some(reason.to_owned());
    }
    let surveying = session.job.is_some();
    surveying.then(|| terms::refusal(Refusal::JobRunning))
}

/// Why there is no scan to end.
pub(crate) fn why_not_cancel(session: &Session) -> Option<String> {
    session
        .job
        .is_none()
        .then(|| tr!("No scan is running.").to_owned())
}

/// Why a frame that a person wrote cannot be sent; one that moves nothing can while all motors are
/// stopped.
pub(crate) fn why_not_send(session: &Session, hazardous: bool) -> Option<String> {
    why_not_scan(session)
        .or_else(|| (hazardous && session.halted).then(|| terms::refusal(Refusal::Halted)))
}

/// Why no other setup can be taken in: it says which wheel is mirrored and who drives with whom, and
/// that changes under nobody's hands.
pub(crate) fn why_not_import(session: &Session, pad_is_held: bool) -> Option<String> {
    if pad_is_held {
        return Some(tr!("Let go of the drive pad first.").to_owned());
    }
    let motor = session.in_hand().next()?;
    Some(tr!("Motor {id} is in use. Stop it first.", id = motor.id))
}

/// Whether a port is open, being opened, or waited for.
pub(crate) fn is_in_use(connection: Connection) -> bool {
    match connection {
        Connection::Disconnected | Connection::Failed(_) => false,
        Connection::Connecting | Connection::Connected(_) | Connection::Reconnecting(_) => true,
    }
}

/// Why no port can be opened.
pub(crate) fn why_not_at_all(worker: WorkerState) -> Option<String> {
    (worker == WorkerState::Dead)
        .then(|| tr!("The background worker has stopped. Reload the page.").to_owned())
}

/// Why no serial port can be opened.
pub(crate) fn why_not_serial(worker: WorkerState) -> Option<String> {
    if !serial_ports::is_supported() {
        let words = tr!(
            "This browser does not support Web Serial. Use desktop Chrome, Edge or Firefox 151 or \
             later, over HTTPS. The virtual motor works in any browser."
        );
        return Some(words.to_owned());
    }
    why_not_at_all(worker)
}

#[cfg(test)]
#[path = "guards_tests.rs"]
mod tests;
