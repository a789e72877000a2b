//! What a reply changes for its motor.

use motorlink_protocol::{Instant, Layout, Reply, Setpoint, family::Reading};

use crate::motor::{Control, Motor};

/// The reply that this reading makes, unless it only names the loop. `measured` is when the motor read its angle: when it
/// was asked, as far as that is known.
pub(crate) fn as_reply(
    motor: &mut Motor,
    now: Instant,
    measured: Option<Instant>,
    reading: &Reading,
    asked: Option<Layout>,
) -> Option<Reply> {
    let Reading::Combined(reply) = reading else {
        return motor.separate.record(now, measured, motor.model, reading);
    };
    Some(reply.in_layout(asked))
}

/// What a reply to a request of this moment changes for a motor that is switched, stopped or driven.
pub(crate) fn act_on_reply(
    motor: &mut Motor,
    now: Instant,
    sent: Instant,
    reply: &Reply,
    names_loop: bool,
    unconfirmed: bool,
) {
    if matches!(motor.control, Control::Stopping(_)) {
        // It had not answered before its stop began, and may turn.
        motor.rest.doubt();
    }
    motor.angle_estimate.replied(now, reply);
    let seen = motor.angle_estimate.confirmed_now(now);
    let angle_stands = motor.standstill.record(now, reply);
    // With separate frames a reply may come before the motor has named its loop.
    let unnamed = motor.model.has_separate_frames() && motor.last_mode().is_none();
    match &mut motor.control {
        Control::Switching(switch) if names_loop => switch.record_mode(reply.mode),
        // A late reply may report the time before a switch.
        Control::Stopping(stop) if sent >= stop.began() && !unconfirmed && !unnamed => {
            stop.record_reply(reply, angle_stands);
        }
        Control::Stopping(stop) => stop.record_uncertain_reply(reply.mode),
        Control::Driven(driven) => {
            // A reply soon after Hold may tell where the wheel was then.
            if let Some(hold) = driven.hold
                && let Some(speed) = reply.speed
                && let Some(held) = hold.refined(now, seen, speed)
            {
                driven.goal = Setpoint::Position(held);
                driven.next_frame = now;
                driven.hold = None;
            }
        }
        Control::Idle | Control::Switching(_) => {}
    }
}
