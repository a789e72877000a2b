//! Brings motors to a standstill: velocity loop, zero and brake, until their replies confirm it.

use std::time::Duration;

use motorlink_protocol::{
    Drive, Instant, Layout, Mode, MotorId, Reply, Setpoint,
    family::{Model, Request},
};

use crate::{
    event::{StopOutcome, StopReason, StopReport},
    group::waiting::WaitingGroup,
    safety::{StopPlan, stop_plan},
    start::Start,
    timing::{
        DRIVEN_UNANSWERED_MAX, SILENT_SWITCHES, STANDSTILL_REPLIES, STOP_PERIOD, STOP_WINDOW,
        SWITCH_FRAMES, SWITCH_PERIOD,
    },
};

/// The stop of one motor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stopping {
    plan: StopPlan,
    began: Instant,
    /// When the operator last asked for it.
    asked: Instant,
    /// When the last frame was sent to this motor since the stop began, and its request. Of the motors whose frame is due,
    /// the one whose last frame is the oldest gets it, so that no wheel brakes first.
    last_frame: Option<(Instant, Request)>,
    pub(crate) next_frame: Instant,
    /// How many frames were sent; `None` once a reply has come that can only answer one of them.
    sent_unanswered: Option<u32>,
    /// Whether a brake frame was sent to the motor in the velocity loop.
    has_brake: bool,
    switches: u8,
    next_switch: Instant,
    /// Brakes and queries that go before the next switch. Otherwise rounds longer than [`SWITCH_PERIOD`] would starve
    /// them.
    asks_left: u8,
    /// Replies in a row that report standstill in the velocity loop, by their speed.
    standstill_replies: u8,
    /// Whether the last angle since the stop began shows standstill.
    angle_stands: bool,
    last_query: Option<Instant>,
    last_brake: Option<Instant>,
    /// Whether the motor is in the position loop by the last that is known: by the last reply, of any age, or by what was
    /// known before the stop.
    last_in_position: bool,
    /// What a person has started, for when the motor stands. Any other stop clears it.
    pub(crate) then: Option<Start>,
}

impl Stopping {
    /// Starts a stop of a motor whose loop is `fresh`, or was `last` known.
    pub(crate) fn begin(now: Instant, fresh: Option<Mode>, last: Option<Mode>) -> Self {
        let plan = stop_plan(fresh, last);
        // If the brake is harmless before the switch, it goes first.
        let first_switch = if plan == StopPlan::SwitchThenBrake {
            now
        } else {
            now + STOP_PERIOD
        };
        Self {
            plan,
            began: now,
            asked: now,
            last_frame: None,
            next_frame: now,
            sent_unanswered: Some(0),
            has_brake: false,
            switches: 0,
            next_switch: first_switch,
            asks_left: 0,
            standstill_replies: 0,
            angle_stands: false,
            last_query: None,
            last_brake: None,
            last_in_position: fresh.or(last) == Some(Mode::Position),
            then: None,
        }
    }

    /// The next request to the motor.
    ///
    /// A turning motor that `must_be_enabled` ignores the brake, so it is enabled and switched in turns. Of one that is
    /// `without_loop`, only a reply to a query for the loop counts.
    pub(crate) fn next_request(
        &self,
        now: Instant,
        model: Model,
        id: MotorId,
        must_be_enabled: bool,
        without_loop: bool,
    ) -> Request {
        let switches = self.plan != StopPlan::Brake || must_be_enabled;
        if switches && now >= self.next_switch && self.asks_left == 0 {
            if must_be_enabled && self.switches.is_multiple_of(2) {
                Request::Enable { id, on: true }
            } else {
                Request::SwitchMode {
                    id,
                    mode: Mode::Velocity,
                }
            }
        } else if self.asks_angle(model) && !without_loop {
            Request::Query { id }
        } else if self.may_brake() && !self.asks_loop(model, without_loop) {
            let drive = Drive::from(Setpoint::Brake);
            Request::Drive { id, drive }
        } else if model.has_separate_frames() {
            Request::ModeQuery { id }
        } else {
            Request::Query { id }
        }
    }

    /// Whether the danger of a brake frame is the smaller one.
    ///
    /// A motor that is last known in the position loop must report that it has left it, however long it is silent: the
    /// switches may not have arrived, and the brake that is the first frame on a repaired line turns the wheel to 0
    /// degrees. Without a brake, the wheel turns to its target at most, and a switch that arrives ends that.
    ///
    /// A motor whose loop was never known may be in any other loop, where it may turn for ever. It gets the brake after many
    /// switches: it received enough of them, or receives nothing. In every other loop the brake never waits.
    fn may_brake(&self) -> bool {
        let has_left = !self.last_in_position && self.switches >= SILENT_SWITCHES;
        self.plan != StopPlan::SwitchThenBrake || has_left
    }

    /// Whether this request brakes the motor, as far as its loop is known.
    pub(crate) fn is_braked_by(&self, request: Request) -> bool {
        matches!(request, Request::Drive { .. }) && self.plan == StopPlan::Brake
    }

    /// Whether it is the turn of a query for the loop. The reply to a brake frame does not name it in separate frames, and
    /// a reply to a switch may be an echo: a DDSM210 answers with the same bytes. Once the motor has a brake, every other
    /// brake is such a query while the motor is `without_loop`.
    fn asks_loop(&self, model: Model, without_loop: bool) -> bool {
        let is_behind_switch = self.plan != StopPlan::Brake && self.asks_left == 1;
        let has_asked = matches!(self.last_frame, Some((_, Request::ModeQuery { .. })));
        let is_its_turn = self.has_brake && !has_asked;
        model.has_separate_frames() && (is_behind_switch || without_loop && is_its_turn)
    }

    /// Whether it is the turn of a query for the angle, which the reply to a brake frame does not have in separate frames.
    /// It takes turns with the brake, and only once the speed is that of a standstill.
    fn asks_angle(&self, model: Model) -> bool {
        let has_asked = matches!(self.last_frame, Some((_, Request::Query { .. })));
        model.has_separate_frames() && self.standstill_replies > 0 && !has_asked
    }

    /// Records a sent frame; the next round begins `period` later.
    ///
    /// Between two switches an answering motor is queried for its loop; a silent one is queried
    /// after every fifth, since each query costs a reply window.
    pub(crate) fn sent(
        &mut self,
        now: Instant,
        model: Model,
        request: Request,
        period: Duration,
        answers: bool,
    ) {
        self.last_frame = Some((now, request));
        self.next_frame = now + period;
        self.sent_unanswered = self.sent_unanswered.map(|sent| sent.saturating_add(1));
        self.asks_left = self.asks_left.saturating_sub(1);
        match request {
            Request::Query { .. } => self.last_query = Some(now),
            Request::Drive { .. } => self.last_brake = Some(now),
            _ => {}
        }
        self.has_brake |= self.is_braked_by(request);
        if matches!(request, Request::SwitchMode { .. } | Request::Enable { .. }) {
            self.switches = self.switches.saturating_add(1);
            self.next_switch = now + SWITCH_PERIOD;
            // A switch has no reply, so the next frame need not wait for a round.
            self.asks_left = match (answers, self.may_brake()) {
                (_, true) if model.has_separate_frames() => 2,
                (true, _) | (_, true) => 1,
                (false, false) => u8::from(self.switches.is_multiple_of(SWITCH_FRAMES)),
            };
            self.next_frame = if self.asks_left > 0 {
                now
            } else {
                self.next_switch
            };
        }
    }

    /// The last frame was not answered: it may be lost, so the next one does not wait.
    pub(crate) fn unanswered(&mut self, now: Instant) {
        self.next_frame = self.next_frame.min(now);
    }

    /// Whether the motor may have got no frame yet, so that its wheel keeps turning. After three without an answer, mode
    /// switches included, it more likely has no power.
    pub(crate) fn may_have_got_nothing(&self) -> bool {
        let sent = self.sent_unanswered;
        sent.is_some_and(|sent| (1..DRIVEN_UNANSWERED_MAX).contains(&sent))
    }

    /// A reply has come that can only answer a frame of this stop.
    pub(crate) const fn answered(&mut self) {
        self.sent_unanswered = None;
    }

    /// Records a reply to a request of this stop. `angle_stands` is what its angle tells, if it has one.
    pub(crate) fn record_reply(&mut self, reply: &Reply, angle_stands: Option<bool>) {
        self.record_loop(reply.mode);
        self.angle_stands = angle_stands.unwrap_or(self.angle_stands);
        let Some(speed) = reply.speed else {
            return;
        };
        let standing = reply.mode == Mode::Velocity && speed.magnitude() < 1;
        self.standstill_replies = if standing {
            self.standstill_replies.saturating_add(1)
        } else {
            0
        };
    }

    /// The layout of a reply to a request of this stop, sent at this moment or later, if all of them have the same.
    pub(crate) fn layout_since(&self, sent: Instant) -> Option<Layout> {
        let none = |last: Option<Instant>| last.is_none_or(|last| last < sent);
        match (none(self.last_query), none(self.last_brake)) {
            _ if sent < self.began => None,
            (true, false) => Some(Layout::Drive),
            (false, true) => Some(Layout::Query),
            _ => None,
        }
    }

    /// Records a reply that only names the loop.
    pub(crate) fn record_loop(&mut self, mode: Mode) {
        self.last_in_position = mode == Mode::Position;
        self.plan = stop_plan(Some(mode), None);
    }

    /// Records a reply that may be older than this stop. It counts if it reports the position loop.
    pub(crate) fn record_uncertain_reply(&mut self, mode: Mode) {
        self.last_in_position = mode == Mode::Position;
        if mode == Mode::Position {
            self.plan = stop_plan(Some(mode), None);
            self.standstill_replies = 0;
        }
    }

    /// When the last frame was sent. The first one has priority over everything else on the line.
    pub(crate) fn last_sent(&self) -> Option<Instant> {
        self.last_frame.map(|(at, _)| at)
    }

    /// Whether the motor, as far as its loop is known, has not got a brake frame yet.
    pub(crate) const fn waits_for_brake(&self) -> bool {
        !self.has_brake
    }

    pub(crate) const fn began(&self) -> Instant {
        self.began
    }

    /// The operator asked again: the stop window restarts, and nothing is driven after it.
    pub(crate) fn restart_window(&mut self, now: Instant) {
        self.asked = now;
        self.then = None;
    }

    pub(crate) fn confirmed(&self) -> bool {
        self.standstill_replies >= STANDSTILL_REPLIES && self.angle_stands
    }

    pub(crate) fn is_over(&self, now: Instant) -> bool {
        self.confirmed() || now >= self.window_ends()
    }

    pub(crate) fn window_ends(&self) -> Instant {
        self.asked + STOP_WINDOW
    }
}

/// The running stop. Its report follows when the last motor is done.
#[derive(Clone, Debug)]
pub(crate) struct ActiveStop {
    reason: StopReason,
    /// Whether it goes before everything else on the port, and nothing drives until it has ended.
    pub(crate) goes_first: bool,
    /// The group that a person has started, for when its motors stand. Any other stop of one of them clears it.
    pub(crate) then_group: Option<WaitingGroup>,
}

impl ActiveStop {
    pub(crate) const fn new(reason: StopReason) -> Self {
        Self {
            reason,
            goes_first: false,
            then_group: None,
        }
    }

    /// Another stop of these motors: what waits for the first one must not drive them.
    pub(crate) fn withdraw_group(&mut self, ids: &[MotorId]) {
        let is_stopped = |group: &WaitingGroup| ids.iter().any(|id| group.setpoints.has(*id));
        if self.then_group.as_ref().is_some_and(is_stopped) {
            self.then_group = None;
        }
    }

    /// Joins another stop. A stop of all motors replaces the reason of a stop of one; a stop for a
    /// job, or of what was left driven, does not replace that of a stop of all.
    pub(crate) fn join(&mut self, reason: StopReason) {
        let weaker = match reason {
            StopReason::OneMotor => true,
            StopReason::Job | StopReason::LeftDriven => self.reason != StopReason::OneMotor,
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

#[cfg(test)]
#[path = "stop_tests.rs"]
mod tests;
