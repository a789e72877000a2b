//! Which motors are affected by the same event, so that one notice names all of them.

use motorlink_messages::{
    bus::{Activity, MotorStatus},
    protocol::MotorId,
};

use crate::model::snapshot::Session;

/// This motor, and all others that have not answered for two seconds.
pub(crate) fn silent(session: &Session, id: MotorId) -> Vec<MotorId> {
    with(session, id, MotorStatus::is_silent)
}

/// This motor, and all others that are being stopped: a group is stopped for one of its motors.
pub(crate) fn stopping(session: &Session, id: MotorId) -> Vec<MotorId> {
    with(session, id, |motor| {
        matches!(motor.activity, Activity::Stopping { .. })
    })
}

fn with(session: &Session, id: MotorId, which: fn(&MotorStatus) -> bool) -> Vec<MotorId> {
    let motors = session.motors.iter();
    let motors = motors.filter(|motor| motor.id == id || which(motor));
    let mut ids: Vec<MotorId> = motors.map(|motor| motor.id).collect();
    if !ids.contains(&id) {
        ids.push(id);
    }
    ids
}
