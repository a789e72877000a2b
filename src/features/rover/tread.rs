//! The tread of a wheel, seen from above: blocks that come up at the rear and go down at the front, and one mark.

use std::fmt::Write;

use crate::ui::{
    frame_rate::FrameRate,
    mathematics::{limited, modulo, sin_cos},
};

/// Blocks around the wheel.
const BLOCKS: u32 = 12;
/// The middle of a block is so far ahead of its ends.
const LEAN_DEG: f64 = 12.0;
/// Beyond this angle from the top, a block is at the edge of the tyre.
const SEEN_DEG: f64 = 76.0;
/// A pattern begins to fade when a frame moves it by this part of its pitch, and is gone at the other, before it seems
/// to turn backwards.
const SHARP_BELOW: f64 = 0.16;
const GONE_ABOVE: f64 = 0.46;

/// Where a point at this angle ahead of the top is seen, in mm behind the axle; `None` below the edge.
fn seen(angle_deg: f64, radius: f64) -> Option<f64> {
    let angle = modulo(angle_deg + 180.0, 360.0) - 180.0;
    (angle.abs() <= SEEN_DEG).then(|| 0.0 - radius * sin_cos(angle).0)
}

/// The blocks as path data. `rolled_deg` grows as the wheel rolls forward.
pub(crate) fn blocks(rolled_deg: f64, radius: f64, half_width: f64) -> String {
    let mut path = String::new();
    for block in 0..BLOCKS {
        let angle = rolled_deg + f64::from(block) * 360.0 / f64::from(BLOCKS);
        if let (Some(ends), Some(middle)) = (seen(angle, radius), seen(angle + LEAN_DEG, radius)) {
            // Writing to a string cannot fail.
            let _ = write!(
                path,
                "M{:.1} {ends:.1}L0 {middle:.1}L{half_width:.1} {ends:.1}",
                -half_width
            );
        }
    }
    path
}

/// The mark at angle zero as path data; empty while it is below.
pub(crate) fn mark(rolled_deg: f64, radius: f64, half_width: f64) -> String {
    let line = |y| format!("M{:.1} {y:.1}H{half_width:.1}", -half_width);
    seen(rolled_deg, radius).map_or_else(String::new, line)
}

/// How sharp a pattern of `count` pieces looks where everything is drawn once in a step: 1 is sharp, 0 is gone.
fn sharpness(rpm: f64, count: u32, rate: FrameRate) -> f64 {
    let pitches = rpm.abs() / 60.0 * rate.step_ms() / 1_000.0 * f64::from(count);
    let gone = (pitches - SHARP_BELOW) / (GONE_ABOVE - SHARP_BELOW);
    1.0 - limited(gone, 0.0, 1.0)
}

/// The opacity of the blocks and of the mark, in steps of a twentieth.
pub(crate) fn opacities(rpm: f64, rate: FrameRate) -> [String; 2] {
    [BLOCKS, 1].map(|count| format!("{:.2}", (sharpness(rpm, count, rate) * 20.0).round() / 20.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The middle of the first block.
    fn first(path: &str) -> f64 {
        let y = path.split("L0 ").nth(1).unwrap().split('L').next().unwrap();
        y.parse().unwrap()
    }

    #[test]
    fn forward_is_upwards() {
        let standing = first(&blocks(0.0, 51.0, 20.0));
        let rolled = first(&blocks(5.0, 51.0, 20.0));
        assert!(rolled < standing, "{rolled} {standing}");
        assert_eq!(mark(0.0, 51.0, 20.0), "M-20.0 0.0H20.0");
        assert_eq!(mark(30.0, 50.0, 20.0), "M-20.0 -25.0H20.0");
        assert_eq!(mark(180.0, 51.0, 20.0), "", "below");
    }

    #[test]
    fn a_turn_later_the_wheel_looks_the_same() {
        for angle in [0.0, 17.0, 200.0] {
            assert_eq!(
                blocks(angle, 51.0, 20.0),
                blocks(angle + 3_600.0, 51.0, 20.0)
            );
        }
    }

    #[test]
    fn a_pattern_is_gone_before_it_seems_to_turn_backwards() {
        for rate in [
            FrameRate::Full,
            FrameRate::Hz30,
            FrameRate::Hz20,
            FrameRate::Hz10,
        ] {
            assert_eq!(opacities(0.0, rate), ["1.00", "1.00"]);
            for rpm in 0..=330_u16 {
                let rpm = f64::from(rpm);
                for count in [BLOCKS, 1] {
                    let pitches = rpm / 60.0 * rate.step_ms() / 1_000.0 * f64::from(count);
                    let gone = sharpness(rpm, count, rate) <= 0.0;
                    assert!(gone || pitches < 0.5, "{count} at {rpm} rpm, {rate:?}");
                }
            }
        }
        // The mark is seen up to the highest speed where the page draws as often as it can.
        assert_ne!(opacities(330.0, FrameRate::Full)[1], "0.00");
    }
}
