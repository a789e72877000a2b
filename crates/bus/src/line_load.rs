//! Load of the line: what it carries, and how drive frames and queries share it.

use std::time::Duration;

use motorlink_protocol::Instant;

use crate::{
    bus::Bus,
    line_use::LineStatus,
    motor::Motor,
    timing::{BUSY_PER_MILLE, BUSY_QUERY_PERIOD, QUERY_PERIOD},
};

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

    /// Time between two queries of a motor that answers. Drive frames go first: when they need much
    /// of the line, queries become rarer.
    pub(crate) fn query_period(&self) -> Duration {
        if self.drive_need() < BUSY_PER_MILLE {
            QUERY_PERIOD
        } else {
            BUSY_QUERY_PERIOD
        }
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

    /// Share of the line that the drive frames need at the command rate, per mille. May exceed
    /// 1,000.
    fn drive_need(&self) -> u32 {
        let driven = self.motors.iter().filter(|motor| motor.is_driven());
        let exchange_us: u64 = driven.map(|motor| self.exchange_us(motor)).sum();
        let need = exchange_us * u64::from(self.settings.rate.hertz()) / 1_000;
        u32::try_from(need).unwrap_or(u32::MAX)
    }

    /// Drive frames per second of each driven motor, if the line cannot carry the command rate.
    fn carries_hz(&self) -> Option<u16> {
        let need = u64::from(self.drive_need());
        let period_us = u64::try_from(self.query_period().as_micros()).unwrap_or(u64::MAX);
        let answering = self.motors.iter().filter(|motor| !motor.silent);
        let asked: u64 = answering.map(|motor| self.exchange_us(motor)).sum();
        let queries = asked * 1_000 / period_us.max(1);
        let free = 1_000_u64.saturating_sub(queries);
        if need <= free {
            return None;
        }
        let hertz = u64::from(self.settings.rate.hertz()) * free / need;
        u16::try_from(hertz).ok()
    }

    fn exchange_us(&self, motor: &Motor) -> u64 {
        let own = motor.round_trip.measured();
        let usual = own.unwrap_or_else(|| self.round_trip.usual());
        u64::try_from(usual.as_micros()).unwrap_or(u64::MAX)
    }
}
