//! The range of the axes: round steps, symmetric about zero, with hysteresis.

use crate::{features::graph::plot::trace::Trace, ui::format};
use motorlink_i18n::terms::in_language;

/// In rpm. A motor runs up to 330, but a wheel pushed by hand or a garbled reply can give any value.
const SPEED_LIMITS: [u16; 10] = [
    50, 100, 200, 400, 1_000, 2_000, 5_000, 10_000, 20_000, 40_000,
];

/// In hundredths of an amp, up to full scale of a reply. The smallest is ten times the noise of a motor at
/// standstill.
const CURRENT_LIMITS: [u16; 5] = [50, 100, 200, 400, 800];

/// The scale grows when the values exceed this part of it, so that a line does not run along the edge.
const GROW: f64 = 0.95;
/// The scale shrinks when the values fit into this part of the smaller one. The hysteresis prevents changes by values
/// near its end.
const SHRINK: f64 = 0.75;

/// A symmetric axis with zero in its middle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Scale {
    limits: &'static [u16],
    /// Hundredths of the unit per unit of the limits.
    hundredths: u16,
    chosen: usize,
}

impl Scale {
    pub(crate) const fn of_speed() -> Self {
        Self {
            limits: &SPEED_LIMITS,
            hundredths: 100,
            chosen: 2,
        }
    }

    pub(crate) const fn of_current() -> Self {
        Self {
            limits: &CURRENT_LIMITS,
            hundredths: 1,
            chosen: 1,
        }
    }

    /// The value at the upper end, in hundredths of the unit.
    fn limit_hundredths(self) -> u32 {
        let limit = self.limits.get(self.chosen).copied().unwrap_or(u16::MAX);
        u32::from(limit) * u32::from(self.hundredths)
    }

    /// The value at the upper end. The lower end is its negative.
    pub(crate) fn limit(self) -> f64 {
        f64::from(self.limit_hundredths()) / 100.0
    }

    /// The scale for values up to this distance from zero. It grows at once and shrinks with hysteresis.
    #[must_use]
    pub(crate) fn fitted(self, extent: f64) -> Self {
        let at = |chosen| Self { chosen, ..self };
        let last = self.limits.len().saturating_sub(1);
        let mut scale = self;
        while scale.chosen < last && extent > scale.limit() * GROW {
            scale = at(scale.chosen + 1);
        }
        while scale.chosen > 0 && extent <= at(scale.chosen - 1).limit() * SHRINK {
            scale = at(scale.chosen - 1);
        }
        scale
    }

    /// The labels of the five lines, from the top: `+200`, `+100`, `0`, `−100`, `−200`.
    pub(crate) fn labels(self) -> [String; 5] {
        let limit = i32::try_from(self.limit_hundredths()).unwrap_or(i32::MAX);
        [limit, limit / 2, 0, -limit / 2, -limit].map(|value| {
            let size = value.unsigned_abs();
            let (whole, part) = (size / 100, size % 100);
            let digits = match self.hundredths {
                100 => return format::signed(value / 100),
                _ if limit < 100 => format!("{whole}.{part:02}"),
                _ => format!("{whole}.{}", part / 10),
            };
            match value {
                0 => "0".to_owned(),
                1.. => in_language(format!("+{digits}")),
                _ => in_language(format!("\u{2212}{digits}")),
            }
        })
    }
}

/// The values at the lower and the upper end of the plot.
pub(crate) type Ends = (f64, f64);

/// The scales of all traces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Scales {
    pub(crate) speed: Scale,
    pub(crate) current: Scale,
    /// The upper end of the temperature's scale, in degrees.
    pub(crate) temperature_end: u16,
}

impl Scales {
    /// The scales before the first drawing.
    pub(crate) const fn new() -> Self {
        Self {
            speed: Scale::of_speed(),
            current: Scale::of_current(),
            temperature_end: 100,
        }
    }

    /// Fits the scale of a trace to values up to this distance from zero.
    pub(crate) fn fit(&mut self, trace: Trace, extent: f64) -> Ends {
        let scale = match trace {
            Trace::Speed | Trace::Goal => &mut self.speed,
            Trace::Current => &mut self.current,
            Trace::Temperature | Trace::Position => {
                let (lower, upper) = ends(trace, extent);
                if trace == Trace::Temperature {
                    self.temperature_end = upper;
                }
                return (f64::from(lower), f64::from(upper));
            }
        };
        *scale = scale.fitted(extent);
        (-scale.limit(), scale.limit())
    }
}

/// The lower and upper end of the scale of a trace without an axis.
fn ends(trace: Trace, extent: f64) -> (u16, u16) {
    match trace {
        // A motor switches off at 80; a byte holds up to 255.
        Trace::Temperature if extent > 100.0 => (0, 260),
        Trace::Temperature => (0, 100),
        _ => (0, 360),
    }
}

/// The labels of the five lines of a scale from zero to `end`, from the top.
pub(crate) fn labels_from_zero(end: u16) -> [String; 5] {
    [4, 3, 2, 1, 0].map(|quarters| (u32::from(end) * quarters / 4).to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_holds_what_is_shown() {
        for (extent, limit) in [
            (0.0, 50.0),
            (37.0, 50.0),
            (100.0, 200.0),
            (150.0, 200.0),
            (330.0, 400.0),
            (401.0, 1_000.0),
            (32_768.0, 40_000.0),
        ] {
            let fitted = Scale::of_speed().fitted(extent).limit();
            assert!((fitted - limit).abs() < 1e-9, "{extent}: {fitted}");
        }
        // Slightly above full scale of a reply: there is no larger scale.
        assert!((Scale::of_current().fitted(8.0003).limit() - 8.0).abs() < 1e-9);
    }

    #[test]
    fn values_about_the_end_of_a_scale_do_not_make_it_jump() {
        let mut scale = Scale::of_speed().fitted(99.0);
        assert!((scale.limit() - 200.0).abs() < 1e-9, "as it was");
        scale = scale.fitted(74.0);
        assert!((scale.limit() - 100.0).abs() < 1e-9);
        scale = scale.fitted(96.0);
        let mut changes = 0;
        for extent in [94.0, 101.0, 96.0, 93.0, 76.0, 102.0] {
            let next = scale.fitted(extent);
            changes += u32::from(next != scale);
            scale = next;
        }
        assert_eq!(changes, 0);
        assert!((scale.fitted(10.0).limit() - 50.0).abs() < 1e-9);
    }

    #[test]
    fn the_labels_are_round_numbers_with_their_sign() {
        let speed = Scale::of_speed().fitted(150.0).labels();
        assert_eq!(speed, ["+200", "+100", "0", "\u{2212}100", "\u{2212}200"]);
        let current = |extent| Scale::of_current().fitted(extent).labels();
        assert_eq!(
            current(0.1),
            ["+0.50", "+0.25", "0", "\u{2212}0.25", "\u{2212}0.50"]
        );
        assert_eq!(
            current(0.7),
            ["+1.0", "+0.5", "0", "\u{2212}0.5", "\u{2212}1.0"]
        );
        assert_eq!(current(8.0)[0], "+8.0");
    }

    #[test]
    fn an_overheated_motor_is_not_drawn_above_its_scale() {
        assert_eq!(ends(Trace::Temperature, 85.0), (0, 100));
        assert_eq!(ends(Trace::Temperature, 255.0), (0, 260));
        assert_eq!(ends(Trace::Position, 360.0), (0, 360));
        assert_eq!(labels_from_zero(260), ["260", "195", "130", "65", "0"]);
    }
}
