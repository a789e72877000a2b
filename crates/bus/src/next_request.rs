//! The next request to a motor: pure functions of its state.

use std::time::Duration;

use motorlink_protocol::{
    Instant, Mode, Setpoint,
    family::{Model, Request},
};

use crate::{
    mode_switch::{NeutralDrive, Switch},
    motor::{Control, Driven, Motor},
    ramp::Ramp,
    safety::step_towards,
    schedule::DueFrame,
    timing::{
        CATCH_UP_MAX, DRIVEN_UNANSWERED_MAX, LOOP_QUERY_PERIOD, SILENT_STOP_PERIOD,
        SLOW_BRAKE_PERIOD, STOP_PERIOD,
    },
};

/// The frame that a request sends to a motor.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Sent {
    Stop,
    Switch {
        to: Mode,
        is_last: bool,
    },
    /// The setpoint; `None` for the neutral zero during a mode switch.
    Drive(Option<Setpoint>),
    Query(SendContext),
    /// A query in the place of a drive frame. Queries that have waited go after it as after a drive frame.
    LoopQuery(SendContext),
}

/// Rates and limits that apply to the next frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SendContext {
    pub(crate) model: Model,
    /// Time between two drive frames to one motor.
    pub(crate) period: Duration,
    /// Time between two queries of a motor that answers.
    pub(crate) query_period: Duration,
    pub(crate) ramp: Option<Ramp>,
    pub(crate) others_driven: bool,
    /// See [`BusSettings::slow_brake_frames`](crate::BusSettings::slow_brake_frames).
    pub(crate) slow_brake_frames: bool,
}

/// The request for the due frame, and the motor's control state once it is sent.
pub(crate) fn next_request(
    motor: &Motor,
    now: Instant,
    due_frame: DueFrame,
    context: SendContext,
) -> (Request, Control, Sent) {
    let id = motor.id;
    let SendContext { model, period, .. } = context;
    match (motor.control, due_frame) {
        (Control::Stopping(mut stop), DueFrame::Stop(_)) => {
            let must_be_enabled = motor.must_be_enabled_to_brake(now);
            let without_loop = motor.is_without_confirmed_loop();
            let request = stop.next_request(now, model, id, must_be_enabled, without_loop);
            let stop_period = if context.slow_brake_frames && stop.is_braked_by(request) {
                SLOW_BRAKE_PERIOD
            } else if context.others_driven && motor.unanswered_in_a_row >= DRIVEN_UNANSWERED_MAX {
                SILENT_STOP_PERIOD
            } else {
                STOP_PERIOD
            };
            stop.sent(now, model, request, stop_period, !motor.is_without_answer());
            (request, Control::Stopping(stop), Sent::Stop)
        }
        (Control::Switching(mut switch), DueFrame::Switch(_)) => {
            let is_first = switch.is_unsent();
            switch.frame_sent(now);
            let to = switch.to;
            let is_last = switch.next_frame().is_none();
            // A DDSM400 ignores a mode switch before it is enabled.
            let request = if model.spec().needs_enable && is_first {
                Request::Enable { id, on: true }
            } else {
                Request::SwitchMode { id, mode: to }
            };
            (
                request,
                Control::Switching(switch),
                Sent::Switch { to, is_last },
            )
        }
        (Control::Driven(driven), DueFrame::Drive(_)) => {
            let goal = step_towards(driven.goal, motor.torque.possible());
            let mut ramped = driven.ramped;
            let setpoint = ramped.step(now, goal, context.ramp, period);
            let (on_schedule, mut next_frame) = kept_schedule(driven.on_schedule, now, period);
            if motor.is_holding(now) {
                next_frame = next_frame.min(now + STOP_PERIOD);
            }
            let control = Control::Driven(Driven {
                next_frame,
                is_new: false,
                on_schedule,
                ramped,
                since: driven.silent_from(),
                silence: None,
                ..driven
            });
            (
                Request::drive(model, id, setpoint),
                control,
                Sent::Drive(Some(setpoint)),
            )
        }
        (
            Control::Switching(Switch {
                neutral_drive: Some(neutral_drive),
                ..
            }),
            DueFrame::Drive(_),
        ) => {
            let next_frame = next_on_schedule(neutral_drive.next_frame, now, period);
            let mut control = motor.control;
            if let Control::Switching(switch) = &mut control {
                switch.neutral_drive = Some(NeutralDrive {
                    next_frame,
                    ..neutral_drive
                });
            }
            let drive = neutral_drive.drive;
            (Request::Drive { id, drive }, control, Sent::Drive(None))
        }
        (mut control, DueFrame::LoopQuery(_)) => {
            // The drive frame goes once the motor has named its loop.
            if let Control::Driven(driven) = &mut control {
                driven.next_frame = now + LOOP_QUERY_PERIOD.min(period);
            }
            let request = if model.has_separate_frames() {
                Request::ModeQuery { id }
            } else {
                // Every reply names the loop.
                Request::Query { id }
            };
            (request, control, Sent::LoopQuery(context))
        }
        (control, _) => {
            let mut context = context;
            if motor.is_withheld(now) {
                context.query_period = period;
            }
            (motor.next_query(), control, Sent::Query(context))
        }
    }
}

/// The scheduled time of the next frame, and when it may go out. A short delay is caught up, with
/// at least half a period between two frames, so that a busy machine keeps the rate. A delay beyond
/// [`CATCH_UP_MAX`] is dropped.
fn kept_schedule(on_schedule: Instant, now: Instant, period: Duration) -> (Instant, Instant) {
    // A command that is sent at once restarts the schedule.
    let next = (on_schedule.min(now) + period).max(now - CATCH_UP_MAX);
    (next, next.max(now + period / 2))
}

/// One period after the last deadline, so that lateness does not add up. A missed schedule is not
/// caught up by a burst.
fn next_on_schedule(deadline: Instant, now: Instant, period: Duration) -> Instant {
    (deadline + period).max(now + period / 2)
}
