//! Load of the line: what it carries, and how drive frames and queries share it.

use std::time::Duration;

use motorlink_protocol::Instant;

use crate::{
    bus::Bus,
    line_use::LineStatus,
    motor::Motor,
    rate::CommandRate,
    timing::{BUSY_PER_MILLE, BUSY_QUERY_PERIOD, QUERY_PERIOD},
};

/// How long the exchanges with the motors of a line take, in microseconds.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Load {
    /// One exchange with each driven motor.
    pub(crate) driven_us: u64,
    /// One exchange with each motor that is queried.
    pub(crate) asked_us: u64,
}

impl Load {
    /// Share of the line that the drive frames need at this rate, per mille. May exceed 1,000.
    fn drive_need(self, rate: CommandRate) -> u64 {
        self.driven_us * u64::from(rate.hertz()) / 1_000
    }

    /// Time between two queries of a motor that answers. Drive frames go first: when they need much
    /// of the line, queries become rarer.
    fn query_period(self, rate: CommandRate) -> Duration {
        if self.drive_need(rate) < u64::from(BUSY_PER_MILLE) {
            QUERY_PERIOD
        } else {
            BUSY_QUERY_PERIOD
        }
    }

    /// Drive frames of each driven motor in 1,000 seconds, if the line cannot carry this rate.
    pub(crate) fn carries(self, rate: CommandRate) -> Option<u64> {
        let period_us = u64::try_from(self.query_period(rate).as_micros()).unwrap_or(u64::MAX);
        let free_us = 1_000_000_u64.saturating_sub(self.asked_us * 1_000_000 / period_us.max(1));
        let need_us = self.driven_us * u64::from(rate.hertz());
        (need_us > free_us).then(|| free_us * 1_000 / self.driven_us.max(1))
    }
}

impl Bus {
    /// How the line is used and how well it works.
    #[must_use]
    pub fn line_status(&self, now: Instant) -> LineStatus {
        let [drive, query, other, waiting] = self.line_use.shares(now);
        LineStatus {
            model: self.model,
            model_known: self.model_known(),
            exchanges_hz: self.line_use.exchanges_hz(now),
            drive_per_mille: drive,
            query_per_mille: query,
            other_per_mille: other,
            waiting_per_mille: waiting,
            round_trip: self.round_trip.status(),
            late_hz: self.late.hertz(now),
            carries_hz: self.carries_hz(),
            unaddressed: self.counters,
        }
    }

    pub(crate) fn any_driven(&self) -> bool {
        self.motors.iter().any(Motor::is_driven)
    }

    /// Time between two queries of a motor that answers.
    pub(crate) fn query_period(&self) -> Duration {
        self.load().query_period(self.settings.rate)
    }

    /// Time between two queries on the line while several motors are driven. The queries of six
    /// motors in a row would take as long as all their drive frames and delay each of them. It is
    /// less than an even share, so that a delay can be caught up.
    pub(crate) fn query_distance(&self) -> Duration {
        let several = self.motors.iter().filter(|motor| motor.is_driven()).count() > 1;
        let watched = u32::try_from(self.motors.len()).unwrap_or(u32::MAX);
        if several {
            self.query_period() * 3 / 4 / watched.max(1)
        } else {
            Duration::ZERO
        }
    }

    fn load(&self) -> Load {
        let sum = |counts: fn(&Motor) -> bool| {
            let motors = self.motors.iter().filter(|motor| counts(motor));
            motors.map(|motor| self.exchange_us(motor)).sum()
        };
        Load {
            driven_us: sum(Motor::is_driven),
            asked_us: sum(|motor| !motor.answer.is_silent()),
        }
    }

    /// Drive frames per second of each driven motor, if the line cannot carry the command rate.
    fn carries_hz(&self) -> Option<u16> {
        let carried = self.load().carries(self.settings.rate)?;
        u16::try_from(carried / 1_000).ok()
    }

    fn exchange_us(&self, motor: &Motor) -> u64 {
        let own = motor.round_trip.measured();
        let usual = own.unwrap_or_else(|| self.round_trip.usual());
        u64::try_from(usual.as_micros()).unwrap_or(u64::MAX)
    }
}
