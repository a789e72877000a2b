//! Bringing motors to a standstill: velocity loop, zero, brake, until their replies say so.

use std::time::Duration;

use motorlink_protocol::{Instant, Mode, MotorId, Reply, Request, Setpoint};

use crate::{
    event::{StopOutcome, StopReason, StopReport},
    safety::{StopPlan, stop_plan},
    timing::{
        SILENT_SWITCHES, STANDSTILL_REPLIES, STOP_PERIOD, STOP_WINDOW, SWITCH_FRAMES, SWITCH_PERIOD,
    },
};

/// A motor on its way to a standstill.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stopping {
    plan: StopPlan,
    began: Instant,
    /// When an operator asked for it last.
    asked: Instant,
    /// Frames sent to this motor since. All motors of a stop get their nth frame before any gets
    /// its next, so that no wheel bites first.
    pub(crate) round: u32,
    pub(crate) next_frame: Instant,
    /// Until the first frame is sent it goes before everything else on the line.
    pub(crate) first_frame_sent: bool,
    switches: u8,
    next_switch: Instant,
    /// Replies in a row that reported standstill in the velocity loop.
    still: u8,
    /// Whether the last reply since it began, of whatever age, reports the position loop.
    says_position: bool,
}

impl Stopping {
    /// A stop that begins now, for a motor whose loop is `fresh` or was `last` known. `round` is that
    /// of the motors that are being stopped already: they keep their brake while this one joins.
    pub(crate) fn begin(now: Instant, fresh: Option<Mode>, last: Option<Mode>, round: u32) -> Self {
        let plan = stop_plan(fresh, last);
        // Where the brake may come first, it does, and the switch follows it.
        let first_switch = if plan == StopPlan::SwitchThenBrake {
            now
        } else {
            now + STOP_PERIOD
        };
        Self {
            plan,
            began: now,
            asked: now,
            round,
            first_frame_sent: false,
            next_frame: now,
            switches: 0,
            next_switch: first_switch,
            still: 0,
            says_position: false,
        }
    }

    /// What goes to the motor next.
    pub(crate) fn next_request(&self, now: Instant, id: MotorId) -> Request {
        if self.plan != StopPlan::Brake && now >= self.next_switch {
            Request::SwitchMode {
                id,
                mode: Mode::Velocity,
            }
        } else if self.may_brake() {
            Request::drive(id, Setpoint::Brake)
        } else {
            Request::Query { id }
        }
    }

    /// Out of the position loop the motor has to say that it has left it. One that does not say so, and not
    /// the contrary either, gets the brake after many switches: it heard enough of them, or hears nothing.
    fn may_brake(&self) -> bool {
        let has_left = !self.says_position && self.switches >= SILENT_SWITCHES;
        self.plan != StopPlan::SwitchThenBrake || has_left
    }

    /// A frame was sent; the next round begins `period` later.
    ///
    /// Between two switches a motor that answers is asked for its loop; one that does not is asked behind
    /// every fifth, since each question costs a window.
    pub(crate) fn sent(
        &mut self,
        now: Instant,
        request: &Request,
        period: Duration,
        answers: bool,
    ) {
        self.round += 1;
        self.first_frame_sent = true;
        self.next_frame = now + period;
        if matches!(request, Request::SwitchMode { .. }) {
            self.switches = self.switches.saturating_add(1);
            self.next_switch = now + SWITCH_PERIOD;
            // A switch is not answered; what follows it need not wait for a round.
            let asks = answers || self.may_brake() || self.switches.is_multiple_of(SWITCH_FRAMES);
            self.next_frame = if asks { now } else { self.next_switch };
        }
    }

    /// A reply to a request of this stop.
    pub(crate) fn heard(&mut self, reply: &Reply) {
        self.says_position = reply.mode == Mode::Position;
        self.plan = stop_plan(Some(reply.mode), None);
        let standing = reply.mode == Mode::Velocity && reply.speed.magnitude() < 1;
        self.still = if standing {
            self.still.saturating_add(1)
        } else {
            0
        };
    }

    /// A reply that may be older than this stop. Where it reports the position loop, that counts.
    pub(crate) fn heard_uncertain(&mut self, mode: Mode) {
        self.says_position = mode == Mode::Position;
        if mode == Mode::Position {
            self.plan = stop_plan(Some(mode), None);
            self.still = 0;
        }
    }

    pub(crate) const fn began(&self) -> Instant {
        self.began
    }

    /// It was asked for once more: it gets its whole window again.
    pub(crate) fn asked_again(&mut self, now: Instant) {
        self.asked = now;
    }

    pub(crate) fn confirmed(&self) -> bool {
        self.still >= STANDSTILL_REPLIES
    }

    pub(crate) fn over(&self, now: Instant) -> bool {
        self.confirmed() || now >= self.window_ends()
    }

    pub(crate) fn window_ends(&self) -> Instant {
        self.asked + STOP_WINDOW
    }
}

/// The stop that is under way; its report is made when the last motor is done.
#[derive(Clone, Debug)]
pub(crate) struct ActiveStop {
    reason: StopReason,
}

impl ActiveStop {
    pub(crate) const fn new(reason: StopReason) -> Self {
        Self { reason }
    }

    /// A stop of all motors takes over a stop of one, and that before a scan takes over none of all.
    pub(crate) fn join(&mut self, reason: StopReason) {
        let weaker = match reason {
            StopReason::OneMotor => true,
            StopReason::Survey => self.reason != StopReason::OneMotor,
            _ => false,
        };
        if !weaker {
            self.reason = reason;
        }
    }

    pub(crate) const fn report(&self, motors: Vec<StopOutcome>) -> StopReport {
        StopReport {
            reason: self.reason,
            motors,
        }
    }
}
