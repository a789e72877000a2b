//! Whether a wheel stands, by its speed and its angle.
//!
//! A DDSM210 that turned was seen to report -0.1 rpm for ever (`waveshareteam/ddsm_example#2`), and a DDSM115 one and
//! the same angle (`DDTRobot/motor-driver-examples#1`). So neither of the two confirms a standstill alone.

use std::time::Duration;

use motorlink_protocol::{Detail, Instant, Reply};

use crate::timing::FRESH_FOR;

/// A wheel that turns slower than 1 rpm stands.
const STANDS_DPS: f32 = 6.0;
/// The fine angle jitters by two steps of the encoder, of 0.088 degrees.
const FINE_STEP_DEG: f32 = 0.18;
/// One step of the coarse angle, 360/255 degrees.
const COARSE_STEP_DEG: f32 = 1.42;
/// Between two angles further apart the wheel may have turned and come back. The angles of idle motors are 100 or 200 ms
/// apart, and slow brake frames 300 ms.
const APART_MAX: Duration = Duration::from_millis(350);
/// An angle is compared with one of half this age up to this age. A coarse one needs 471 ms to tell 1 rpm.
const COMPARED_MAX: Duration = Duration::from_secs(1);
/// A wheel makes no whole turn between two angles this close: the fastest has 330 rpm, one turn in 182 ms.
const CLOSE: Duration = Duration::from_millis(150);
/// The turns of an odometry reply are compared to this many.
const TURNS: i32 = 8;

/// The angles of one kind that a motor reports.
#[derive(Clone, Copy, Debug, Default)]
struct Angles {
    /// The angle with which the newest is compared, and the one that takes its place later.
    compared: Option<[(Instant, f32); 2]>,
    newest: Option<Instant>,
    /// When two angles last arrived so close together that no whole turn fits between them.
    close: Option<Instant>,
    stands: bool,
}

impl Angles {
    /// Records an angle, which repeats after `full` degrees. Returns whether the wheel has moved.
    fn record(&mut self, at: Instant, degrees: f32, step: f32, full: f32) -> bool {
        let gap = self.newest.replace(at).map(|newest| at.since(newest));
        let follows = gap.is_some_and(|gap| gap <= APART_MAX);
        if gap.is_some_and(|gap| gap <= CLOSE) || full > 360.0 {
            self.close = Some(at);
        }
        let Some([first, second]) = self.compared.filter(|_| follows) else {
            self.begin(at, degrees);
            return false;
        };
        let (first, second) = if at.since(second.0) >= COMPARED_MAX / 2 {
            (second, (at, degrees))
        } else {
            (first, second)
        };
        self.compared = Some([first, second]);
        let (since, before) = first;
        let moved = ((degrees - before + full / 2.0).rem_euclid(full) - full / 2.0).abs();
        let standing = STANDS_DPS * at.since(since).as_secs_f32();
        self.stands = moved + step <= standing;
        let has_moved = moved - step > standing;
        if has_moved {
            self.begin(at, degrees);
        }
        has_moved
    }

    fn begin(&mut self, at: Instant, degrees: f32) {
        self.compared = Some([(at, degrees); 2]);
        self.close = None;
        self.stands = false;
    }

    fn stands(&self, now: Instant) -> bool {
        let is_fresh = |newest| now.since(newest) <= FRESH_FOR;
        self.stands && self.newest.is_some_and(is_fresh)
    }

    /// Like `stands`, but rules out whole turns between two angles.
    fn stands_for_certain(&self, now: Instant) -> bool {
        let is_recent = |close| now.since(close) <= COMPARED_MAX;
        self.stands(now) && self.close.is_some_and(is_recent)
    }
}

/// What the replies of one motor tell of its standstill.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Standstill {
    fine: Angles,
    coarse: Angles,
}

impl Standstill {
    /// Records a reply. Returns whether the wheel stands by its angle; `None` if the reply has no angle.
    pub(crate) fn record(&mut self, at: Instant, reply: &Reply) -> Option<bool> {
        if reply.speed.is_some_and(|speed| speed.magnitude() >= 1) {
            *self = Self::default();
        }
        let has_moved = match reply.detail {
            Detail::Drive { position } => {
                self.fine
                    .record(at, position.degrees(), FINE_STEP_DEG, 360.0)
            }
            Detail::Query { position, .. } => {
                self.coarse
                    .record(at, position.degrees(), COARSE_STEP_DEG, 360.0)
            }
            Detail::Odometry { turns, position } => {
                let [_, _, _, turns] = turns.rem_euclid(TURNS).to_be_bytes();
                let degrees = f32::from(turns) * 360.0 + position.degrees();
                let full = 360.0 * 8.0;
                self.fine.record(at, degrees, FINE_STEP_DEG, full)
            }
            Detail::Undetermined(_) | Detail::Temperature(_) => return None,
        };
        if has_moved {
            self.fine.stands = false;
            self.coarse.stands = false;
        }
        Some(self.by_angle(at))
    }

    /// Whether the wheel stands by angles that are fresh.
    fn by_angle(&self, now: Instant) -> bool {
        self.fine.stands(now) || self.coarse.stands(now)
    }

    /// Whether it does for certain: at 200 rpm, an angle every 300 ms is always the same.
    pub(crate) fn for_certain(&self, now: Instant) -> bool {
        self.fine.stands_for_certain(now) || self.coarse.stands_for_certain(now)
    }
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::{
        Celsius, CoarsePosition, Current, Faults, Mode, MotorId, Position, Rpm,
    };

    use super::*;

    fn reply(rpm: i16, detail: Detail) -> Reply {
        Reply {
            id: MotorId::FIRST,
            mode: Mode::Velocity,
            current: Some(Current::from_raw(0)),
            speed: Some(Rpm::new(rpm)),
            detail,
            faults: Faults::NONE,
        }
    }

    fn fine(degrees: f32) -> Detail {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0-360 degrees"
        )]
        let raw = (degrees.rem_euclid(360.0) * 32_767.0 / 360.0) as u16;
        Detail::Drive {
            position: Position::from_raw(raw),
        }
    }

    /// When a wheel stands whose motor replies every `period_ms` for two seconds, at `rpm` by its angle.
    fn stands_after_ms(period_ms: u64, rpm: f32, detail: impl Fn(f32) -> Detail) -> Option<u64> {
        let mut standstill = Standstill::default();
        (0..2_000 / period_ms).map(|n| n * period_ms).find(|ms| {
            #[allow(clippy::cast_precision_loss, reason = "up to 2,000")]
            let degrees = 10.0 + rpm * 6.0 * *ms as f32 / 1_000.0;
            let at = Instant::from_millis(*ms);
            standstill.record(at, &reply(0, detail(degrees))) == Some(true)
        })
    }

    fn coarse(degrees: f32) -> Detail {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0-255"
        )]
        let raw = (degrees.rem_euclid(360.0) * 255.0 / 360.0).round() as u8;
        Detail::Query {
            temperature: Celsius::new(30),
            position: CoarsePosition::from_raw(raw),
        }
    }

    #[test]
    fn an_angle_that_stays_shows_a_standstill_as_soon_as_it_can() {
        assert_eq!(stands_after_ms(5, 0.0, fine), Some(35));
        assert_eq!(stands_after_ms(18, 0.0, fine), Some(36));
        assert_eq!(stands_after_ms(100, 0.0, coarse), Some(300));
    }

    #[test]
    fn an_angle_that_moves_faster_than_1_rpm_shows_none_at_any_reported_speed() {
        for rpm in [1.5, 5.0, 60.0, 330.0, -210.0] {
            assert_eq!(stands_after_ms(5, rpm, fine), None, "{rpm}");
            assert_eq!(stands_after_ms(18, rpm, fine), None, "{rpm}");
        }
        for rpm in [5.0, 60.0, 330.0] {
            assert_eq!(stands_after_ms(100, rpm, coarse), None, "{rpm}");
        }
    }

    #[test]
    fn a_jitter_of_two_steps_stands() {
        let mut standstill = Standstill::default();
        let stands = (0..40).map(|n| {
            let at = Instant::from_millis(n * 5);
            let degrees = 10.0 + if n % 2 == 0 { 0.0 } else { 0.17 };
            standstill.record(at, &reply(0, fine(degrees))) == Some(true)
        });
        assert!(stands.skip(20).all(|stands| stands));
    }

    #[test]
    fn a_reported_speed_ends_a_standstill_whatever_the_angle() {
        let mut standstill = Standstill::default();
        for ms in (0..100).step_by(5) {
            standstill.record(Instant::from_millis(ms), &reply(0, fine(51.2)));
        }
        assert!(standstill.by_angle(Instant::from_millis(100)));
        standstill.record(Instant::from_millis(100), &reply(5, fine(51.2)));
        assert!(!standstill.by_angle(Instant::from_millis(100)));
    }

    /// 200 rpm are one turn in 300 ms.
    #[test]
    fn angles_that_are_a_whole_turn_apart_leave_no_motor_out_of_a_stop() {
        for (period_ms, certain) in [(300, false), (100, true)] {
            let mut standstill = Standstill::default();
            for ms in (0..=1_200).step_by(period_ms) {
                standstill.record(Instant::from_millis(ms), &reply(0, coarse(51.2)));
            }
            let now = Instant::from_millis(1_200);
            assert!(standstill.by_angle(now), "{period_ms}");
            assert_eq!(standstill.for_certain(now), certain, "{period_ms}");
        }
    }

    /// Two replies are lost, so that the only close pair is one that shows motion.
    #[test]
    fn angles_that_show_motion_make_no_later_one_certain() {
        let mut standstill = Standstill::default();
        for ms in [0_u16, 100, 400] {
            let degrees = 200.0 * 6.0 * f32::from(ms) / 1_000.0;
            standstill.record(Instant::from_millis(ms.into()), &reply(0, coarse(degrees)));
        }
        assert!(!standstill.for_certain(Instant::from_millis(400)));
    }

    /// 300 rpm are one turn in 200 ms.
    #[test]
    fn whole_turns_between_two_odometry_replies_are_motion() {
        let odometry = |turns| Detail::Odometry {
            turns,
            position: Position::from_raw(0),
        };
        let mut standstill = Standstill::default();
        for turn in 0..20_u8 {
            let at = Instant::from_millis(u64::from(turn) * 200);
            let stands = standstill.record(at, &reply(0, odometry(turn.into())));
            assert_eq!(stands, Some(false), "{turn}");
        }
    }
}
