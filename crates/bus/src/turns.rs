//! How far a wheel has turned.

use std::time::Duration;

use motorlink_protocol::{Detail, Instant, Reply};

/// How often the wheel turned in a longer time without an angle is unknown: such a gap counts for nothing.
const GAP: Duration = Duration::from_secs(1);

/// A count of turns, positive in the direction of positive speed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Turns {
    thousandths: i32,
}

impl Turns {
    /// So many turns, rounded to a thousandth.
    #[must_use]
    #[allow(
        clippy::cast_possible_truncation,
        reason = "a float cast saturates, after days at full speed"
    )]
    pub fn new(turns: f64) -> Self {
        let thousandths = (turns * 1_000.0).round() as i32;
        Self { thousandths }
    }

    /// Tenths of a turn, rounded.
    #[must_use]
    pub const fn tenths(self) -> i32 {
        let half = if self.thousandths < 0 { -50 } else { 50 };
        self.thousandths.saturating_add(half) / 100
    }

    /// The number of turns.
    #[must_use]
    pub fn number(self) -> f64 {
        f64::from(self.thousandths) / 1_000.0
    }
}

/// Counts the turns of a motor by its replies, since the first angle. A motor with odometry counts them itself, since
/// power-up: it has that number.
#[derive(Clone, Copy, Debug, Default)]
pub struct TurnCounter {
    track: Option<Track>,
    own: Option<f64>,
    rpm: f64,
}

#[derive(Clone, Copy, Debug)]
struct Track {
    at: Instant,
    /// Unwrapped; it falls at positive speed.
    degrees: f64,
    rpm: f64,
    /// The angle from which turns are counted.
    origin: f64,
}

impl TurnCounter {
    /// Counts a reply. Times must not decrease.
    pub fn record(&mut self, at: Instant, reply: &Reply) {
        if let Some(speed) = reply.speed {
            self.rpm = speed.rpm().into();
        }
        match reply.detail {
            Detail::Odometry { turns, position } => {
                let part = f64::from(position.raw()) / 32_768.0;
                self.own = Some(f64::from(turns) + part);
            }
            Detail::Drive { position } => self.angle(at, position.degrees().into()),
            Detail::Query { position, .. } => self.angle(at, position.degrees().into()),
            Detail::Temperature(_) | Detail::Undetermined(_) => {}
        }
    }

    /// The turns so far; `None` before the first angle.
    #[must_use]
    pub fn turns(&self) -> Option<Turns> {
        self.unrounded().map(Turns::new)
    }

    /// The same at the resolution of the motor's angle, which is 0.011 degrees in a drive reply.
    #[must_use]
    pub fn unrounded(&self) -> Option<f64> {
        let counted = |track: Track| (track.origin - track.degrees) / 360.0;
        self.own.or(self.track.map(counted))
    }

    fn angle(&mut self, at: Instant, reported: f64) {
        let rpm = self.rpm;
        let Some(before) = self.track else {
            let (degrees, origin) = (reported, reported);
            self.track = Some(Track {
                at,
                degrees,
                rpm,
                origin,
            });
            return;
        };
        let passed = at.since(before.at);
        // The speed tells how many whole turns lie between two angles.
        let expected = before.degrees - 6.0 * f64::midpoint(before.rpm, rpm) * passed.as_secs_f64();
        let degrees = reported + 360.0 * ((expected - reported) / 360.0).round();
        let skipped = if passed > GAP {
            degrees - before.degrees
        } else {
            0.0
        };
        self.track = Some(Track {
            at,
            degrees,
            rpm,
            origin: before.origin + skipped,
        });
    }
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::{
        Celsius, CoarsePosition, Current, Faults, Mode, MotorId, Position, Rpm,
    };

    use super::*;

    fn reply(rpm: Option<i16>, detail: Detail) -> Reply {
        Reply {
            id: MotorId::FIRST,
            mode: Mode::Velocity,
            current: Some(Current::from_raw(0)),
            speed: rpm.map(Rpm::new),
            detail,
            faults: Faults::NONE,
        }
    }

    fn fine(degrees: f64) -> Detail {
        let raw = degrees.rem_euclid(360.0) / 360.0 * 32_767.0;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 to 32,767"
        )]
        let position = Position::from_raw(raw as u16);
        Detail::Drive { position }
    }

    /// A wheel that turns at this speed, with a reply every `every_ms`.
    fn turned(rpm: i16, every_ms: u64, replies: u64) -> f64 {
        let mut counter = TurnCounter::default();
        for n in 0..=replies {
            let ms = n * every_ms;
            let at = Instant::from_millis(ms);
            let degrees = 200.0 - f64::from(rpm) * 6.0 * at.since(Instant::ZERO).as_secs_f64();
            counter.record(at, &reply(Some(rpm), fine(degrees)));
        }
        counter.turns().unwrap().number()
    }

    #[test]
    fn turns_are_counted_in_the_direction_of_positive_speed() {
        assert!((turned(300, 150, 400) - 300.0).abs() < 0.01);
        assert!((turned(-100, 20, 3_000) + 100.0).abs() < 0.01);
        assert!(turned(0, 100, 10).abs() < 0.001);
    }

    #[test]
    fn a_query_between_drive_replies_changes_nothing() {
        let mut counter = TurnCounter::default();
        let mut record = |ms, detail| {
            counter.record(Instant::from_millis(ms), &reply(Some(0), detail));
            counter.turns().unwrap().number()
        };
        let coarse = Detail::Query {
            temperature: Celsius::new(30),
            position: CoarsePosition::from_raw(127),
        };
        record(0, fine(180.0));
        assert!(record(100, coarse).abs() < 0.003);
        assert!(record(200, fine(180.0)).abs() < 0.001);
    }

    /// What the wheel did in a silent minute is unknown.
    #[test]
    fn a_gap_counts_for_nothing() {
        let mut counter = TurnCounter::default();
        let mut record = |ms, degrees| {
            counter.record(Instant::from_millis(ms), &reply(Some(100), fine(degrees)));
            counter.turns().unwrap().number()
        };
        record(0, 100.0);
        assert!((record(100, 40.0) - 0.167).abs() < 0.002);
        assert!((record(60_100, 300.0) - 0.167).abs() < 0.002);
        assert!((record(60_200, 240.0) - 0.333).abs() < 0.002);
    }

    #[test]
    fn a_motor_with_odometry_has_the_turns_that_it_reports() {
        let mut counter = TurnCounter::default();
        let position = Position::from_raw(24_576);
        let odometry = Detail::Odometry {
            turns: -33,
            position,
        };
        assert_eq!(counter.turns(), None);
        counter.record(Instant::ZERO, &reply(None, odometry));
        assert_eq!(counter.turns().map(Turns::number), Some(-32.25));
        let temperature = Detail::Temperature(Celsius::new(30));
        counter.record(Instant::from_millis(90_000), &reply(Some(50), temperature));
        assert_eq!(counter.turns().map(Turns::number), Some(-32.25));
    }
}
