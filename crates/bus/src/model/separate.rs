//! What a motor with separate frames has told: each reply has a part of what a DDSM115 says in one.

use motorlink_protocol::{
    Current, Detail, Instant, Mode, Reply,
    family::{ModeReading, Model, Reading},
};

use crate::timing::FRESH_FOR;

use super::{enabling::Enabling, loop_known::LoopKnown, odometry::LastOdometry, units};

/// State of one motor with separate frames.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Separate {
    pub(crate) loop_known: LoopKnown,
    odometry: LastOdometry,
    /// Whether the next query asks for the loop. The two kinds alternate.
    pub(crate) asks_loop: bool,
    pub(crate) enabling: Enabling,
    /// When a drive reply last told the current.
    current_told: Option<Instant>,
}

impl Separate {
    /// Records a reading. Returns it as a reply with what `last` told of the rest, unless it only names the loop.
    ///
    /// Outside the position loop a driven motor reports its speed in every drive reply. Otherwise the
    /// speed is that of the odometry.
    pub(crate) fn record(
        &mut self,
        now: Instant,
        model: Model,
        reading: &Reading,
        last: Option<Reply>,
        is_driven: bool,
    ) -> Option<Reply> {
        match reading {
            Reading::Combined(_) => None,
            Reading::Mode(reading) => {
                self.record_loop(now, model, *reading);
                None
            }
            Reading::Drive(reading) => {
                self.current_told = Some(now);
                let mode = self.loop_known.last()?;
                let speed = reading.speed(model, mode).map(units::speed);
                Some(Reply {
                    id: reading.id,
                    mode,
                    current: units::current(reading.current),
                    speed: speed.or(last.map(|last| last.speed))?,
                    detail: Detail::Temperature(reading.temperature),
                    faults: reading.faults,
                })
            }
            Reading::Odometry(reading) => {
                // It powers up in the velocity loop.
                let mode = self.loop_known.last().unwrap_or(Mode::Velocity);
                let (turns, position) = (reading.turns, reading.position);
                let moved = self.odometry.speed(now, turns, position);
                let told = last.filter(|_| is_driven);
                // A motor that is driven by raw frames tells it too. An odometry reply between two drive replies must
                // not end an overcurrent.
                let is_recent = |told: Instant| now.since(told) <= FRESH_FOR;
                let current = told.or(last.filter(|_| self.current_told.is_some_and(is_recent)));
                let speed = match told.filter(|_| mode != Mode::Position) {
                    Some(told) => told.speed,
                    None => moved.or(last.map(|last| last.speed)).unwrap_or_default(),
                };
                Some(Reply {
                    id: reading.id,
                    mode,
                    current: current.map_or(Current::from_raw(0), |last| last.current),
                    speed,
                    detail: Detail::Odometry { turns, position },
                    faults: reading.faults,
                })
            }
        }
    }

    /// Whether the wheel is more than half a turn from the zero of its odometry, by its last recent report.
    pub(crate) fn is_far_from_zero(&self, now: Instant) -> bool {
        self.odometry.is_far_from_zero(now)
    }

    fn record_loop(&mut self, now: Instant, model: Model, reading: ModeReading) {
        match (reading.mode(model), reading.byte) {
            (Some(mode), _) => self.loop_known.reported(now, mode),
            (None, ModeReading::ENABLED) => {
                self.loop_known.enabled(true);
                self.enabling = Enabling::default();
            }
            (None, ModeReading::DISABLED) => {
                self.loop_known.enabled(false);
                // The loop it has once it is enabled and switched.
                self.loop_known.reported(now, Mode::Velocity);
            }
            (None, _) => {}
        }
    }

    /// Records an unanswered request. `may_be_off` says that the motor has been silent so long that it may have lost
    /// power.
    pub(crate) fn unanswered(&mut self, may_be_off: bool) {
        self.loop_known.unanswered(may_be_off);
        if may_be_off {
            self.odometry.forget();
            self.enabling = Enabling::default();
        }
    }
}
