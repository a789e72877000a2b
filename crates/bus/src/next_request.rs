//! The next request to a motor: pure functions of its state.

use std::time::Duration;

use motorlink_protocol::{Instant, Mode, Request, Setpoint};

use crate::{
    mode_switch::{Meanwhile, Switch},
    motor::{Control, Driven, Motor},
    ramp::Ramp,
    safety::step_towards,
    schedule::Errand,
    timing::{CATCH_UP_MAX, DRIVEN_UNANSWERED_MAX, SILENT_STOP_PERIOD, STOP_PERIOD},
};

/// What was sent to a motor.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Sent {
    Stop,
    Switch {
        to: Mode,
        is_last: bool,
    },
    /// The setpoint; none between two loops, where zero is sent.
    Drive(Option<Setpoint>),
    Query(Tempo),
}

/// How often, and how fast.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tempo {
    /// Between two drive frames to one motor.
    pub(crate) period: Duration,
    /// Between two queries of one motor that answers.
    pub(crate) query_period: Duration,
    pub(crate) ramp: Option<Ramp>,
    pub(crate) others_driven: bool,
}

/// The request that an errand means now, and what its motor's control is once it was sent.
pub(crate) fn next_request(
    motor: &Motor,
    now: Instant,
    errand: Errand,
    tempo: Tempo,
) -> (Request, Control, Sent) {
    let id = motor.id;
    let period = tempo.period;
    match (motor.control, errand) {
        (Control::Stopping(mut stop), Errand::Stop(_)) => {
            let stop_period =
                if tempo.others_driven && motor.unanswered_in_a_row >= DRIVEN_UNANSWERED_MAX {
                    SILENT_STOP_PERIOD
                } else {
                    STOP_PERIOD
                };
            let request = stop.next_request(now, id);
            stop.sent(now, &request, stop_period, !motor.is_without_answer());
            (request, Control::Stopping(stop), Sent::Stop)
        }
        (Control::Switching(mut switch), Errand::Switch(_)) => {
            switch.frame_sent(now);
            let to = switch.to;
            let is_last = switch.next_frame().is_none();
            let request = Request::SwitchMode { id, mode: to };
            (
                request,
                Control::Switching(switch),
                Sent::Switch { to, is_last },
            )
        }
        (Control::Driven(driven), Errand::Drive(_)) => {
            let goal = step_towards(driven.goal, motor.torque.possible());
            let mut ramped = driven.ramped;
            let setpoint = ramped.step(now, goal, tempo.ramp, period);
            let (on_schedule, mut next_frame) = kept_schedule(driven.on_schedule, now, period);
            if motor.is_holding(now) {
                next_frame = next_frame.min(now + STOP_PERIOD);
            }
            let control = Control::Driven(Driven {
                next_frame,
                on_schedule,
                ramped,
                ..driven
            });
            (
                Request::drive(id, setpoint),
                control,
                Sent::Drive(Some(setpoint)),
            )
        }
        (
            Control::Switching(Switch {
                meanwhile: Some(meanwhile),
                ..
            }),
            Errand::Drive(_),
        ) => {
            let next_frame = next_on_schedule(meanwhile.next_frame, now, period);
            let mut control = motor.control;
            if let Control::Switching(switch) = &mut control {
                switch.meanwhile = Some(Meanwhile {
                    next_frame,
                    ..meanwhile
                });
            }
            let drive = meanwhile.drive;
            (Request::Drive { id, drive }, control, Sent::Drive(None))
        }
        (control, _) => (Request::Query { id }, control, Sent::Query(tempo)),
    }
}

/// When the frame behind the one that is sent now belongs, and when it may go out: what was held up a
/// little is made up for, two frames being half a period apart at least, so that a rate is kept on a
/// busy machine. More than [`CATCH_UP_MAX`] is given up.
fn kept_schedule(on_schedule: Instant, now: Instant, period: Duration) -> (Instant, Instant) {
    // A command that shows at once begins the schedule anew.
    let next = (on_schedule.min(now) + period).max(now - CATCH_UP_MAX);
    (next, next.max(now + period / 2))
}

/// A period after the last deadline, so that lateness does not add up; but where the line could not
/// keep the schedule, no burst makes up for it.
fn next_on_schedule(deadline: Instant, now: Instant, period: Duration) -> Instant {
    (deadline + period).max(now + period / 2)
}
