//! Who speaks next on the line.

use std::time::Duration;

use motorlink_protocol::{Instant, MotorId};

use crate::{
    motor::{Control, Motor},
    timing::{EARLY, QUERY_PATIENCE},
};

/// What the line is to be used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Turn {
    /// Send this now.
    Now(Errand),
    /// Nothing is due before this.
    At(Instant),
    /// Nothing will be due.
    Never,
}

/// What the line is wanted for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Errand {
    /// The next frame of this motor's stop.
    Stop(MotorId),
    /// The next frame of this motor's mode switch.
    Switch(MotorId),
    /// This motor's setpoint, or the neutral frame during a mode switch.
    Drive(MotorId),
    /// This motor's telemetry.
    Query(MotorId),
    /// Who is there.
    IdQuery,
}

/// Stops first, then mode switches, then drive frames by deadline, then queries where they fit.
pub(crate) fn next_turn(motors: &[Motor], now: Instant, usual: Duration) -> Turn {
    let due = |at: Instant| now + EARLY >= at;
    let stop = next_stop(motors);
    let switch = earliest(motors, |motor| match &motor.control {
        Control::Switching(switch) => switch.next_frame(),
        _ => None,
    });
    let drive = earliest(motors, |motor| match &motor.control {
        Control::Driven(driven) => Some(driven.next_frame),
        Control::Switching(switch) => switch.meanwhile.map(|meanwhile| meanwhile.next_frame),
        _ => None,
    });
    let appointments = [
        stop.map(|(at, id)| (at, Errand::Stop(id))),
        switch.map(|(at, id)| (at, Errand::Switch(id))),
        drive.map(|(at, id)| (at, Errand::Drive(id))),
    ];
    let in_order = appointments.into_iter().flatten();
    if let Some((_, errand)) = in_order.clone().find(|(at, _)| due(*at)) {
        return Turn::Now(errand);
    }
    let next_appointment = in_order.map(|(at, _)| at).min();

    let Some((query_at, id)) = next_query(motors) else {
        return next_appointment.map_or(Turn::Never, Turn::At);
    };
    let fits = next_appointment.is_none_or(|at| now + usual <= at);
    let out_of_patience = now >= query_at + QUERY_PATIENCE;
    match next_appointment {
        _ if due(query_at) && (fits || out_of_patience) => Turn::Now(Errand::Query(id)),
        Some(at) if due(query_at) => Turn::At(at.min(query_at + QUERY_PATIENCE)),
        Some(at) => Turn::At(at.min(query_at)),
        None => Turn::At(query_at),
    }
}

/// The motor whose stop is furthest behind: no motor gets its next frame before all got this one.
fn next_stop(motors: &[Motor]) -> Option<(Instant, MotorId)> {
    motors
        .iter()
        .filter_map(|motor| match &motor.control {
            Control::Stopping(stop) => Some((stop.round, motor.id, stop.next_frame)),
            _ => None,
        })
        .min()
        .map(|(_, id, at)| (at, id))
}

fn next_query(motors: &[Motor]) -> Option<(Instant, MotorId)> {
    earliest(motors, |motor| {
        // A stop asks for what it needs by itself.
        if let Control::Stopping(_) = motor.control {
            return None;
        }
        let patience = motor.next_query + QUERY_PATIENCE;
        let clear_at = motor
            .drive_reply_pending_until()
            .unwrap_or(motor.next_query);
        Some(motor.next_query.max(clear_at.min(patience)))
    })
}

fn earliest(
    motors: &[Motor],
    at: impl Fn(&Motor) -> Option<Instant>,
) -> Option<(Instant, MotorId)> {
    motors
        .iter()
        .filter_map(|motor| Some((at(motor)?, motor.id)))
        .min()
}
