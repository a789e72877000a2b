//! The dial of the position card: the wheel's angle, straight up 0 degrees, growing clockwise.

use crate::ui::mathematics::modulo;

/// After a longer pause the page was hidden, and no sweep is drawn.
const UNSEEN_MS: f64 = 300.0;

/// The face of the dial, in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Face {
    /// The position of the hand, 0 to 360, clockwise from straight up.
    pub(crate) hand: f64,
    /// The start of the angles that the hand has swept since the last drawing, clockwise.
    pub(crate) swept_from: f64,
    /// The size of the sweep, 0 to 360.
    pub(crate) swept: f64,
}

/// The hand is drawn ten times a second. A fast wheel makes more than half a turn in that time, so that a hand alone
/// would seem to turn backwards. So the dial also shows the swept angles.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sweep {
    /// The time and the unwrapped angle of the last drawing.
    drawn: Option<(f64, f64)>,
}

impl Sweep {
    /// The face for an unwrapped angle in degrees.
    pub(crate) fn to(&mut self, now_ms: f64, angle_deg: f64) -> Face {
        let before = self
            .drawn
            .filter(|(drawn_ms, _)| now_ms - drawn_ms <= UNSEEN_MS)
            .map_or(angle_deg, |(_, before_deg)| before_deg);
        self.drawn = Some((now_ms, angle_deg));
        Face {
            hand: modulo(angle_deg, 360.0),
            swept_from: modulo(before.min(angle_deg), 360.0),
            swept: (angle_deg - before).abs().min(360.0),
        }
    }

    /// The angle is unknown.
    pub(crate) const fn forget(&mut self) {
        self.drawn = None;
    }
}

/// A dial about the origin.
pub(crate) const MARKUP: &str = concat!(
    r#"<svg class="angle-dial" viewBox="-44 -44 88 88" data-known="no">"#,
    r#"<circle class="angle-track" r="36"/>"#,
    r#"<path class="angle-tick" d="M0 -29V-24M29 0H24M0 29V24M-29 0H-24"/>"#,
    r#"<path class="angle-swept" pathLength="360" stroke-dasharray="0 999" d="M0 -36A36 36 0 0 1 0 36A36 36 0 0 1 0 -36"/>"#,
    r#"<g class="angle-hand"><path class="angle-line" d="M0 -6V-30"/><circle class="angle-knob" cy="-36" r="5"/></g>"#,
    r#"<circle class="angle-hub" r="4"/>"#,
    "</svg>",
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hand_mirrors_the_angle_and_sweeps_the_way_it_came() {
        let mut sweep = Sweep::default();
        let face = sweep.to(0.0, 30.0);
        assert_eq!(
            face,
            Face {
                hand: 30.0,
                swept_from: 30.0,
                swept: 0.0
            }
        );
        // At a positive speed the angle decreases, through 0.
        let face = sweep.to(100.0, -30.0);
        assert_eq!(
            face,
            Face {
                hand: 330.0,
                swept_from: 330.0,
                swept: 60.0
            }
        );
        let face = sweep.to(200.0, 30.0);
        assert_eq!(
            face,
            Face {
                hand: 30.0,
                swept_from: 330.0,
                swept: 60.0
            }
        );
    }

    #[test]
    fn a_wheel_that_turns_more_than_once_between_two_drawings_sweeps_the_whole_dial() {
        let mut sweep = Sweep::default();
        sweep.to(0.0, 0.0);
        let swept = sweep.to(100.0, -500.0).swept;
        assert!((swept - 360.0).abs() < f64::EPSILON, "{swept}");
    }

    #[test]
    fn what_was_not_seen_is_not_swept() {
        let mut sweep = Sweep::default();
        sweep.to(0.0, 0.0);
        let long_hidden = sweep.to(5_000.0, -90.0);
        sweep.forget();
        let another_motor = sweep.to(5_050.0, -180.0);
        for face in [long_hidden, another_motor] {
            assert!(face.swept < f64::EPSILON, "{face:?}");
        }
    }
}
