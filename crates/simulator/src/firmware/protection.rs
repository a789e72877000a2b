//! When the motor protects itself, and when it comes back.

use std::time::Duration;

use motorlink_protocol::{Fault, Faults, Instant};

use super::sense::Sense;

/// Supply current that trips (maker's manual).
const BUS_MAX_A: f64 = 3.0;
/// Phase current that trips (maker's manual).
const PHASE_MAX_A: f64 = 4.6;
/// A wheel that is asked to move and stands this long is blocked (maker's manual).
const STALL_AFTER: Duration = Duration::from_secs(5);
/// Overcurrent and stall clear after this (maker's manual).
const CLEARS_AFTER: Duration = Duration::from_secs(5);
/// Trips at this winding temperature (maker's manual).
const HOT_C: f64 = 80.0;
/// Clears below this (maker's manual).
const COOL_C: f64 = 75.0;
/// Below this a wheel counts as standing. A blocked one may rock on its rubber.
const STANDS_RAD_S: f64 = 0.05;

/// A protection that clears by itself after a time.
#[derive(Clone, Copy, Debug, Default)]
enum Timed {
    #[default]
    Clear,
    Until(Instant),
}

impl Timed {
    fn update(&mut self, now: Instant, trips: bool) {
        if trips {
            *self = Self::Until(now + CLEARS_AFTER);
        } else if matches!(*self, Self::Until(end) if end <= now) {
            *self = Self::Clear;
        }
    }

    const fn is_active(self) -> bool {
        matches!(self, Self::Until(_))
    }
}

/// All protections of a motor.
#[derive(Clone, Debug, Default)]
pub(crate) struct Protections {
    bus: Timed,
    phase: Timed,
    stall: Timed,
    blocked_since: Option<Instant>,
    hot: bool,
    encoder_broken: bool,
}

impl Protections {
    /// One step. `wants_motion`: the command asks the wheel to turn.
    pub(crate) fn update(&mut self, now: Instant, sense: &Sense, wants_motion: bool) {
        let blocked = wants_motion && sense.speed_rad_s.abs() < STANDS_RAD_S;
        self.blocked_since = blocked.then(|| self.blocked_since.unwrap_or(now));
        let stalled = |since| now.since(since) > STALL_AFTER;
        self.stall
            .update(now, self.blocked_since.is_some_and(stalled));
        self.bus.update(now, sense.bus_a > BUS_MAX_A);
        self.phase.update(now, sense.phase_a > PHASE_MAX_A);
        self.hot = sense.winding_c >= HOT_C || (self.hot && sense.winding_c >= COOL_C);
        self.encoder_broken = sense.encoder_broken;
    }

    pub(crate) fn faults(&self) -> Faults {
        [
            (self.encoder_broken, Fault::Sensor),
            (self.bus.is_active(), Fault::BusOvercurrent),
            (self.phase.is_active(), Fault::PhaseOvercurrent),
            (self.stall.is_active(), Fault::Stall),
            (self.hot, Fault::OverTemperature),
        ]
        .into_iter()
        .filter(|(active, _)| *active)
        .fold(Faults::NONE, |faults, (_, fault)| faults.with(fault))
    }

    /// Whether nothing is active and nothing is about to be.
    pub(crate) fn are_idle(&self) -> bool {
        self.faults().is_none() && self.blocked_since.is_none()
    }
}
