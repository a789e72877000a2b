//! What a motor with separate frames has told: each reply has a part of what a DDSM115 says in one.

use motorlink_protocol::{
    Detail, Instant, Mode, Reply,
    family::{ModeReading, Model, Reading},
};

use super::{enabling::Enabling, loop_known::LoopKnown, odometry::LastOdometry, units};

/// State of one motor with separate frames.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Separate {
    pub(crate) loop_known: LoopKnown,
    odometry: LastOdometry,
    /// Whether the next query asks for the loop. The two kinds alternate.
    pub(crate) asks_loop: bool,
    pub(crate) enabling: Enabling,
    /// Whether a drive reply has told the speed since the last odometry reply.
    drive_told_speed: bool,
}

impl Separate {
    /// Records a reading. Returns what it tells of the wheel, unless it only names the loop, or the loop is unknown.
    ///
    /// A drive reply has no speed in the position loop, and an odometry reply has none of its own. Two odometry replies
    /// tell the mean speed between them, unless a drive reply between them tells a newer one. It counts from when the
    /// motor measured, since an adapter delivers one reply later than another; if that is uncertain, they tell no speed.
    pub(crate) fn record(
        &mut self,
        now: Instant,
        measured: Option<Instant>,
        model: Model,
        reading: &Reading,
    ) -> Option<Reply> {
        match reading {
            Reading::Combined(_) => None,
            Reading::Mode(reading) => {
                self.record_loop(now, model, *reading);
                None
            }
            Reading::Drive(reading) => {
                let mode = self.loop_known.last()?;
                let speed = reading.speed(model, mode).map(units::speed);
                self.drive_told_speed |= speed.is_some();
                Some(Reply {
                    id: reading.id,
                    mode,
                    current: Some(units::current(reading.current)),
                    speed,
                    detail: Detail::Temperature(reading.temperature),
                    faults: reading.faults,
                })
            }
            Reading::Odometry(reading) => {
                let (turns, position) = (reading.turns, reading.position);
                let moved = self.odometry.speed(now, measured, turns, position);
                let is_superseded = std::mem::take(&mut self.drive_told_speed);
                Some(Reply {
                    id: reading.id,
                    mode: self.loop_known.last()?,
                    current: None,
                    speed: moved.filter(|_| !is_superseded),
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
