//! Whether the angle of drive replies fits the motion.
//!
//! A motor was seen to report the angle 0x1234 for ever (`DDTRobot/motor-driver-examples#1`). Held, it would turn the
//! wheel there from wherever it is.

use std::time::Duration;

use motorlink_protocol::{Detail, Instant, Rpm};

/// The angle is judged each time the speed has taken the wheel this far.
const JUDGED_DEG: f32 = 60.0;
/// Largest error of the way that the speed gives: at 1 rpm, rounded, half of it.
const OFF_MAX_DEG: f32 = 45.0;
/// Largest distance of the coarse angle from the fine one: its step, and the lag of a speed.
const COARSE_OFF_MAX_DEG: f32 = 20.0;
/// After a longer gap the way is unknown. At 330 rpm a wheel makes half a turn in it.
const GAP_MAX: Duration = Duration::from_millis(100);

/// The way of one wheel by its speed, and its angles on this way.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct AngleFit {
    last: Option<(Instant, Rpm)>,
    /// The angle from which the way is counted.
    from: Option<f32>,
    /// The last angle of a drive reply, and the way up to it.
    fine: Option<(f32, f32)>,
    way_deg: f32,
    misfits: bool,
}

impl AngleFit {
    pub(crate) fn replied(&mut self, at: Instant, speed: Rpm, detail: Detail) {
        let dps = |speed: Rpm| speed.degrees_per_second();
        match self.last.replace((at, speed)) {
            Some((before, last)) if at.since(before) <= GAP_MAX => {
                self.way_deg +=
                    f32::midpoint(dps(last), dps(speed)) * at.since(before).as_secs_f32();
            }
            _ => (self.from, self.fine) = (None, None),
        }
        match (detail, self.fine) {
            (Detail::Drive { position }, _) => self.read_fine(position.degrees()),
            (Detail::Query { position, .. }, Some((fine, way_then))) => {
                let off = off_deg(fine, position.degrees(), self.way_deg - way_then);
                self.misfits |= off > COARSE_OFF_MAX_DEG;
            }
            _ => {}
        }
    }

    fn read_fine(&mut self, degrees: f32) {
        match self.from {
            Some(_) if self.way_deg.abs() < JUDGED_DEG => {}
            Some(from) => {
                self.misfits = off_deg(from, degrees, self.way_deg) > OFF_MAX_DEG;
                (self.from, self.way_deg) = (Some(degrees), 0.0);
            }
            None => (self.from, self.way_deg) = (Some(degrees), 0.0),
        }
        self.fine = Some((degrees, self.way_deg));
    }

    /// Whether the angle has been found not to follow the speed, or to differ from that of the queries.
    pub(crate) const fn misfits(self) -> bool {
        self.misfits
    }
}

/// How far an angle is from where this way leads, in either direction.
fn off_deg(from: f32, to: f32, way: f32) -> f32 {
    let apart = |led: f32| ((to - led + 180.0).rem_euclid(360.0) - 180.0).abs();
    apart(from + way).min(apart(from - way))
}
