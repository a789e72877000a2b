//! How sharp a turning pattern looks: a function of speed and frame rate.
//!
//! A screen shows still pictures, sixty a second or fewer. A pattern that repeats every few degrees and moves
//! more than half its pitch from one picture to the next seems to turn backwards. So each pattern
//! fades into the band that the eye would see, before it gets that far.

use crate::ui::{frame_rate::FrameRate, mathematics::limited};

/// The slowest screen that counts. On a faster one the pattern fades a little early, which is
/// harmless.
const FRAMES_PER_SECOND: u32 = 60;
/// A pattern begins to fade when a frame moves it by this part of its pitch.
const SHARP_BELOW: f64 = 0.16;
/// The pattern has faded when a frame moves it by this part, less than the half at which direction is lost.
const GONE_ABOVE: f64 = 0.46;
/// Longest trail behind a single mark, in degrees. At the highest speed the mark moves by 33 degrees in a sixtieth of
/// a second, and by 198 in a tenth.
const TRAIL_MAX_DEG: f64 = 200.0;

/// Degrees that the wheel turns from one frame to the next.
#[must_use]
pub fn step_deg(rpm: f64, rate: FrameRate) -> f64 {
    rpm.abs() * 6.0 / f64::from(rate.hertz().unwrap_or(FRAMES_PER_SECOND))
}

/// The visibility of a pattern of `count` equal pieces around the turn: 1 is sharp, 0 is a uniform band.
#[must_use]
pub fn sharpness(rpm: f64, count: u16, rate: FrameRate) -> f64 {
    let pitches = step_deg(rpm, rate) * f64::from(count) / 360.0;
    let gone = limited(
        (pitches - SHARP_BELOW) / (GONE_ABOVE - SHARP_BELOW),
        0.0,
        1.0,
    );
    // Smooth at both ends, so that a slow spin-up shows no edge.
    1.0 - gone * gone * (3.0 - 2.0 * gone)
}

/// Length of the trail behind the mark, in degrees. It reaches back to the mark's position in the last frame, so that
/// the mark seems to move instead of jump.
#[must_use]
pub fn trail_deg(rpm: f64, rate: FrameRate) -> f64 {
    step_deg(rpm, rate).min(TRAIL_MAX_DEG)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_standing_wheel_is_sharp() {
        assert!((sharpness(0.0, 36, FrameRate::Hz10) - 1.0).abs() < f64::EPSILON);
        assert!(trail_deg(0.0, FrameRate::Hz10).abs() < f64::EPSILON);
    }

    #[test]
    fn faster_is_never_sharper() {
        for count in [3, 18, 30, 48] {
            let mut last = 1.0;
            for tenth_rpm in 0..3400 {
                let now = sharpness(f64::from(tenth_rpm) / 10.0, count, FrameRate::Full);
                assert!((0.0..=1.0).contains(&now));
                assert!(
                    now <= last,
                    "{count} pieces at {tenth_rpm} tenths of an rpm"
                );
                last = now;
            }
        }
    }

    /// A pattern has faded at the speed at which it would seem to turn backwards.
    #[test]
    fn no_pattern_is_seen_turning_backwards() {
        let rates = [
            FrameRate::Full,
            FrameRate::Hz30,
            FrameRate::Hz20,
            FrameRate::Hz10,
        ];
        let cases = rates
            .into_iter()
            .flat_map(|rate| (1..=90_u16).map(move |count| (rate, count)));
        for (rate, count) in cases {
            let pitch_deg = 360.0 / f64::from(count);
            for rpm in (0..=330_i16).map(f64::from) {
                if step_deg(rpm, rate) >= pitch_deg / 2.0 {
                    let sharp = sharpness(rpm, count, rate);
                    assert!(sharp <= 0.0, "{count} pieces at {rpm} rpm, {rate:?}");
                }
            }
        }
    }

    #[test]
    fn both_directions_look_alike() {
        let sharp = |rpm| sharpness(rpm, 30, FrameRate::Full);
        assert!((sharp(-40.0) - sharp(40.0)).abs() < f64::EPSILON);
        assert!((trail_deg(-330.0, FrameRate::Full) - 33.0).abs() < 1e-9);
        assert!((trail_deg(-330.0, FrameRate::Hz10) - 198.0).abs() < 1e-9);
    }
}
