//! What is known of a motor: its fresh readings, its silence, its status.

use std::time::Duration;

use motorlink_protocol::{Celsius, Faults, Instant, Reply, Rpm, family::Request};

use super::{Control, Driven, Motor};
use crate::{
    counters::LinkQuality,
    event::WithdrawReason,
    motor_status::{Activity, MotorStatus},
    safety::Known,
    timing::{DRIVEN_UNANSWERED_MAX, FRESH_FOR, SILENT_AFTER, TEMPERATURE_UNKNOWN_MAX},
};

impl Motor {
    pub(super) fn fresh(&self, now: Instant) -> Option<Reply> {
        self.last
            .filter(|sample| now.since(sample.at) <= FRESH_FOR)
            .map(|sample| sample.reply)
    }

    /// Whether it is known to obey drive frames.
    pub(crate) fn obeys(&self) -> bool {
        self.separate.loop_known.obeys(self.model)
    }

    /// Whether it answers and must be enabled, and the bus may try that now without a command.
    pub(crate) fn needs_enable(&self, now: Instant) -> bool {
        !self.obeys() && self.separate.enabling.may_try(now) && self.fresh(now).is_some()
    }

    /// Whether it answers and turns, and ignores brake frames because it is not enabled. A stop enables no motor that
    /// stands.
    pub(crate) fn must_be_enabled_to_brake(&self, now: Instant) -> bool {
        let turns = self
            .fresh_speed(now)
            .is_some_and(|speed| speed.magnitude() >= 1);
        turns && !self.obeys() && !self.is_without_answer()
    }

    /// The next request for telemetry.
    pub(crate) const fn next_query(&self) -> Request {
        let id = self.id;
        let switches = matches!(self.control, Control::Switching(_));
        if self.model.has_separate_frames() && (self.separate.asks_loop || switches) {
            Request::ModeQuery { id }
        } else {
            Request::Query { id }
        }
    }

    pub(crate) fn fresh_speed(&self, now: Instant) -> Option<Rpm> {
        let (_, speed) = self.speed.filter(|(at, _)| now.since(*at) <= FRESH_FOR)?;
        Some(speed)
    }

    /// Whether it is certain to stand, by speed and angle.
    pub(crate) fn stands(&self, now: Instant) -> bool {
        let by_speed = self
            .fresh_speed(now)
            .is_some_and(|speed| speed.magnitude() == 0);
        by_speed && self.standstill.for_certain(now)
    }

    pub(crate) fn fresh_faults(&self, now: Instant) -> Option<Faults> {
        self.fresh(now).map(|reply| reply.faults)
    }

    pub(super) fn fresh_temperature(&self, now: Instant) -> Option<Celsius> {
        let (_, temperature) = self
            .temperature
            .filter(|(at, _)| now.since(*at) <= FRESH_FOR)?;
        Some(temperature)
    }

    pub(crate) fn known(&self, now: Instant) -> Known {
        Known {
            reported: self.fresh_mode(now).or(self.driven_loop()),
            faults: self.fresh_faults(now),
            temperature: self.fresh_temperature(now),
        }
    }

    pub(crate) const fn has_answered(&self) -> bool {
        self.answered.is_some()
    }

    /// Whether nothing here drives, switches or stops it, and no raw frame has moved it.
    pub(super) const fn is_free(&self) -> bool {
        matches!(self.control, Control::Idle) && !self.moved_raw
    }

    /// Whether its last requests in a row had no answer.
    pub(crate) const fn is_without_answer(&self) -> bool {
        self.unanswered_in_a_row >= DRIVEN_UNANSWERED_MAX
    }

    /// Since when the motor is silent.
    pub(crate) fn silent_since(&self) -> Instant {
        self.told
            .map_or(self.watched_since, |at| at.max(self.watched_since))
    }

    /// When it counts as silent, if no reply comes until then.
    pub(crate) fn silent_at(&self) -> Instant {
        self.silent_since() + self.stalled + SILENT_AFTER
    }

    /// Whether it has just fallen silent: it was asked, and did not answer.
    pub(crate) fn falls_silent(&self, now: Instant) -> bool {
        let was_asked = self.lost_in_a_row >= DRIVEN_UNANSWERED_MAX;
        !self.answer.is_silent() && was_asked && now >= self.silent_at()
    }

    /// How long a driven motor has been silent, from the command at the earliest.
    pub(crate) fn silence_while_driven(&self, now: Instant, driven: &Driven) -> Duration {
        self.silent_for(now, driven.silent_from())
    }

    /// How long it has been silent, from `since` at the earliest. While the computer stalled, it had nothing to answer.
    pub(crate) fn silent_for(&self, now: Instant, since: Instant) -> Duration {
        now.since(self.silent_since().max(since) + self.stalled)
    }

    /// Why a motor driven since then must be stopped, if its temperature is too old to judge the limit.
    pub(crate) fn temperature_unknown(
        &self,
        now: Instant,
        since: Instant,
    ) -> Option<WithdrawReason> {
        let known = self.temperature.map_or(since, |(at, _)| at.max(since));
        (now.since(known) > TEMPERATURE_UNKNOWN_MAX).then_some(WithdrawReason::TemperatureUnknown)
    }

    pub(crate) fn activity(&self) -> Activity {
        match self.control {
            Control::Idle => Activity::Idle,
            Control::Switching(switch) => Activity::Switching { to: switch.to },
            Control::Driven(driven) => Activity::Driven {
                setpoint: driven.goal,
            },
            Control::Stopping(stop) => Activity::Stopping {
                confirmed: stop.confirmed(),
            },
        }
    }

    /// Of a silent motor the round trip is of the time before, and the loss grows only with each query, once a second: both
    /// are unknown.
    fn link(&self, now: Instant) -> LinkQuality {
        let answers = !self.answer.is_silent();
        LinkQuality {
            command_hz: self.drive_frames.hertz(now),
            round_trip_us: self.round_trip.median_us().filter(|_| answers),
            loss_per_mille: self.loss.per_mille().filter(|_| answers),
            late_per_mille: self.loss.late_per_mille().filter(|_| answers),
        }
    }

    pub(crate) fn status(&self, now: Instant) -> MotorStatus {
        MotorStatus {
            id: self.id,
            activity: self.activity(),
            waiting: self.waiting_setpoint(),
            last: self.last,
            speed: self.speed,
            current: self.current,
            position: self.position,
            temperature: self.temperature,
            turns: self.turns.turns(),
            answer: self.answer,
            may_turn: self.may_turn(),
            turns_unasked: self.is_free() && self.turning_unasked.is_shown(),
            link: self.link(now),
            counters: self.counters,
        }
    }
}
