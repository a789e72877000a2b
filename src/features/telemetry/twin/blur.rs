//! How sharply something that turns can be seen: a function of speed alone.
//!
//! A screen shows sixty still pictures a second. A pattern that repeats every few degrees and moves
//! more than half its pitch from one picture to the next seems to turn backwards. So each pattern
//! fades into the band that the eye would see, before it gets that far.

/// The slowest screen that counts. On a faster one the pattern fades a little early, which is
/// harmless.
const FRAMES_PER_SECOND: f64 = 60.0;
/// A pattern begins to fade when a frame moves it by this part of its pitch.
const SHARP_BELOW: f64 = 0.16;
/// It is gone when a frame moves it by this part, short of the half at which direction is lost.
const GONE_ABOVE: f64 = 0.46;
/// Longest trail behind a single mark, in degrees: at the limit of speed a frame moves it by 33.
const TRAIL_MAX_DEG: f64 = 40.0;

/// Degrees that the wheel turns from one frame to the next.
#[must_use]
pub fn step_deg(rpm: f64) -> f64 {
    rpm.abs() * 6.0 / FRAMES_PER_SECOND
}

/// How much of a pattern of `count` equal pieces round the turn is seen as pieces: 1 sharp, 0 only
/// as a band.
#[must_use]
pub fn sharpness(rpm: f64, count: u16) -> f64 {
    let pitches = step_deg(rpm) * f64::from(count) / 360.0;
    let gone = ((pitches - SHARP_BELOW) / (GONE_ABOVE - SHARP_BELOW)).clamp(0.0, 1.0);
    // Smooth at both ends, so that a slow spin-up shows no edge.
    1.0 - gone * gone * (3.0 - 2.0 * gone)
}

/// Length of the trail behind the mark, in degrees: it reaches back to where the mark was a frame
/// ago, so that even one mark is seen to move, not to jump.
#[must_use]
pub fn trail_deg(rpm: f64) -> f64 {
    step_deg(rpm).min(TRAIL_MAX_DEG)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_standing_wheel_is_sharp() {
        assert!((sharpness(0.0, 36) - 1.0).abs() < f64::EPSILON);
        assert!(trail_deg(0.0).abs() < f64::EPSILON);
    }

    #[test]
    fn faster_is_never_sharper() {
        for count in [3, 18, 30, 48] {
            let mut last = 1.0;
            for tenth_rpm in 0..3400 {
                let now = sharpness(f64::from(tenth_rpm) / 10.0, count);
                assert!((0.0..=1.0).contains(&now));
                assert!(
                    now <= last,
                    "{count} pieces at {tenth_rpm} tenths of an rpm"
                );
                last = now;
            }
        }
    }

    /// Nothing of a pattern is left at the speed from which it would seem to turn backwards.
    #[test]
    fn no_pattern_is_seen_turning_backwards() {
        for count in 1..=90_u16 {
            for rpm in 0..=330_i16 {
                let rpm = f64::from(rpm);
                let pitch_deg = 360.0 / f64::from(count);
                if step_deg(rpm) >= pitch_deg / 2.0 {
                    assert!(sharpness(rpm, count) <= 0.0, "{count} pieces at {rpm} rpm");
                }
            }
        }
    }

    #[test]
    fn both_directions_look_alike() {
        assert!((sharpness(-40.0, 30) - sharpness(40.0, 30)).abs() < f64::EPSILON);
        assert!((trail_deg(-330.0) - 33.0).abs() < 1e-9);
    }
}
