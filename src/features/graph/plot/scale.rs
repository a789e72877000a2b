//! The range of the value axis of each pane: from the least to the greatest value with a margin, at round ends, with
//! hysteresis.

use motorlink_i18n::terms::in_language;

use crate::{
    features::graph::plot::{columns::Range, ticks::thousandths, trace::Trace},
    ui::mathematics::limited,
};

/// Margin on either side, as a part of what is shown.
const MARGIN: i32 = 16;
/// The scale grows when a value comes nearer to its end than this part of it, so that a line does not run along the edge.
const NEAR: i32 = 50;
/// Maximal number of steps to which the ends are rounded.
const PARTS: i32 = 8;
/// The scale shrinks when the values need less than so many per cent of it. The hysteresis prevents changes by values
/// that come and go.
const SHRINK_PERCENT: i64 = 60;
/// Beyond every value: a reply holds up to 32,768 rpm.
const GREATEST: i32 = 100_000_000;

/// The values at the lower and the upper end of a pane.
pub(crate) type Ends = (f64, f64);

/// A range in thousandths of the unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Scale {
    lower: i32,
    upper: i32,
}

impl Scale {
    /// The scale of these values, without hysteresis.
    fn of(trace: Trace, (least, greatest): (i32, i32)) -> Self {
        let margin = (greatest - least) / MARGIN;
        let short = (least_span(trace) - (greatest - least + 2 * margin)).max(0);
        let (lower, upper) = (least - margin - short / 2, greatest + margin + short / 2);
        let step = step(upper - lower, PARTS);
        let scale = Self {
            lower: lower.div_euclid(step) * step,
            upper: (upper + step - 1).div_euclid(step) * step,
        };
        scale.within(limits(trace))
    }

    fn within(self, (lower, upper): (i32, i32)) -> Self {
        Self {
            lower: self.lower.max(lower),
            upper: self.upper.min(upper),
        }
    }

    const fn span(self) -> i32 {
        self.upper - self.lower
    }

    /// The part between two places, of which 0 is the upper end and 1 the lower one; beyond them too. It is no shorter
    /// than a tenth of what is at standstill.
    #[must_use]
    pub(crate) fn part(self, trace: Trace, (from, to): (f64, f64)) -> Self {
        let (lower, upper) = self.ends();
        let value = |place: f64| in_thousandths(upper - place * (upper - lower));
        let (least, greatest) = (value(from.max(to)), value(from.min(to)));
        let short = (least_span(trace) / 10 - (greatest - least)).max(0);
        Self {
            lower: least - short / 2,
            upper: greatest + (short - short / 2),
        }
    }

    /// The scale for these values: it grows at once and shrinks with hysteresis.
    fn fitted(self, trace: Trace, (least, greatest): (i32, i32)) -> Self {
        let wanted = Self::of(trace, (least, greatest));
        let near = self.span() / NEAR;
        let needed = Self {
            lower: least - near,
            upper: greatest + near,
        };
        let needed = needed.within(limits(trace));
        let holds = self.lower <= needed.lower && needed.upper <= self.upper;
        let is_roomy = i64::from(wanted.span()) * 100 < i64::from(self.span()) * SHRINK_PERCENT;
        if holds && !is_roomy { self } else { wanted }
    }

    pub(crate) fn ends(self) -> Ends {
        let value = |thousandths| f64::from(thousandths) / 1_000.0;
        (value(self.lower), value(self.upper))
    }

    /// The round values on this scale, from the top: their place between the upper end, 0, and the lower one, 1, and
    /// their label. The first one has the unit: `+100 rpm`, `0`, `−100`. They are a row apart, or nearer, up to half a
    /// row, if there were only one.
    pub(crate) fn ticks(self, trace: Trace, unit: &str, half_rows: i32) -> Vec<Tick> {
        let steps_of = |steps_max: i32| {
            let step = step(self.span(), steps_max.max(1));
            let (first, last) = (self.upper.div_euclid(step), -(-self.lower).div_euclid(step));
            (step, first, last)
        };
        // A single value is no scale.
        let mut nearer = (half_rows / 2..half_rows).map(steps_of);
        let several = nearer.find(|(_, first, last)| first != last);
        let (step, first, last) = several.unwrap_or_else(|| steps_of(half_rows));
        let tick = |number: i32| {
            let value = number * step;
            let sign = match value.signum() {
                -1 => "\u{2212}",
                1 if trace.is_signed() => "+",
                _ => "",
            };
            let digits = thousandths(value.unsigned_abs().into(), step.unsigned_abs().into());
            let mut label = in_language(format!("{sign}{digits}"));
            if number == first {
                label = label + if trace == Trace::Position { "" } else { " " } + unit;
            }
            Tick {
                place: f64::from(self.upper - value) / f64::from(self.span().max(1)),
                is_zero: value == 0,
                label,
            }
        };
        (last..=first).rev().map(tick).collect()
    }
}

/// A round value of a scale.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    /// Between the upper end, 0, and the lower one, 1.
    pub(crate) place: f64,
    pub(crate) is_zero: bool,
    pub(crate) label: String,
}

/// The smallest round step of which at most so many are in a span: 1, 2 or 5 with zeros.
fn step(span: i32, steps_max: i32) -> i32 {
    let least = (span + steps_max - 1) / steps_max;
    let mut step = 1;
    while step * 10 < least {
        step *= 10;
    }
    let mut steps = [1, 2, 5].into_iter().map(|factor| factor * step);
    steps.find(|step| *step >= least).unwrap_or(step * 10)
}

/// The shortest span of the values: what a motor at standstill measures fills no pane.
const fn least_span(trace: Trace) -> i32 {
    match trace {
        Trace::Speed | Trace::Goal | Trace::Position => 20_000,
        Trace::Current => 200,
        Trace::Temperature => 10_000,
    }
}

/// What a scale does not exceed.
const fn limits(trace: Trace) -> (i32, i32) {
    match trace {
        Trace::Position => (0, 360_000),
        Trace::Temperature => (0, 260_000),
        _ => (-GREATEST, GREATEST),
    }
}

/// How the scales are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(crate) struct Fitting {
    /// Whether zero is in the middle of the signed traces.
    pub(crate) symmetric: bool,
    /// The scales that the user has chosen, by the place of their trace.
    zoomed: [Option<Scale>; Trace::ALL.len()],
}

impl Fitting {
    /// With this scale of a trace.
    #[must_use]
    pub(crate) fn with(mut self, trace: Trace, scale: Scale) -> Self {
        if let Some(zoomed) = self.zoomed.get_mut(trace.place()) {
            *zoomed = Some(scale);
        }
        self
    }

    /// Whether the user has chosen a scale.
    pub(crate) fn is_zoomed(self) -> bool {
        self.zoomed.iter().any(Option::is_some)
    }

    /// With every scale fitted to its values.
    #[must_use]
    pub(crate) fn fitted(self) -> Self {
        Self {
            symmetric: self.symmetric,
            ..Self::default()
        }
    }

    /// The scale of a trace that the user has chosen.
    pub(crate) fn zoomed(self, trace: Trace) -> Option<Scale> {
        self.zoomed.get(trace.place()).copied().flatten()
    }
}

/// The scales of all traces, by their place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(crate) struct Scales {
    scales: [Option<Scale>; Trace::ALL.len()],
    fitting: Fitting,
}

impl Scales {
    /// Chooses the scales in this way from now on.
    pub(crate) fn choose(&mut self, fitting: Fitting) {
        if self.fitting.symmetric != fitting.symmetric {
            *self = Self::default();
        }
        self.fitting = fitting;
    }

    /// The scale of a trace as it is.
    pub(crate) fn of(self, trace: Trace) -> Scale {
        let scale = self.scales.get(trace.place()).copied().flatten();
        let scale = self.fitting.zoomed(trace).or(scale);
        scale.unwrap_or_else(|| Scale::of(trace, (0, 0)))
    }

    /// Fits the scale of a trace to values in this range. Without a value it stays.
    pub(crate) fn fit(&mut self, trace: Trace, range: Option<Range>) -> Scale {
        let before = self.scales.get(trace.place()).copied().flatten();
        let scale = match (range, before) {
            (None, Some(before)) => before,
            (range, before) => {
                let (least, greatest) = range.unwrap_or_default();
                let (mut least, mut greatest) = (in_thousandths(least), in_thousandths(greatest));
                if self.fitting.symmetric && trace.is_signed() {
                    greatest = greatest.max(-least);
                    least = -greatest;
                }
                let values = (least, greatest);
                before.map_or_else(
                    || Scale::of(trace, values),
                    |before| before.fitted(trace, values),
                )
            }
        };
        if let Some(place) = self.scales.get_mut(trace.place()) {
            *place = Some(scale);
        }
        self.fitting.zoomed(trace).unwrap_or(scale)
    }
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "limited to what a scale can have"
)]
fn in_thousandths(value: f64) -> i32 {
    let greatest = f64::from(GREATEST) / 2.0;
    limited(value * 1_000.0, -greatest, greatest).round() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fitted(trace: Trace, range: Range) -> Ends {
        Scales::default().fit(trace, Some(range)).ends()
    }

    #[test]
    fn a_scale_is_from_the_least_to_the_greatest_with_a_margin_at_round_ends() {
        for (trace, range, ends) in [
            (Trace::Speed, (0.0, 0.0), (-10.0, 10.0)),
            (Trace::Speed, (0.0, 100.0), (-20.0, 120.0)),
            (Trace::Speed, (99.0, 101.0), (90.0, 110.0)),
            (Trace::Speed, (-330.0, -300.0), (-335.0, -295.0)),
            (Trace::Speed, (-32_768.0, 32_767.0), (-40_000.0, 40_000.0)),
            (Trace::Current, (0.0, 0.0), (-0.1, 0.1)),
            (Trace::Current, (-0.02, 0.41), (-0.1, 0.5)),
            (Trace::Temperature, (27.0, 28.0), (22.0, 34.0)),
            (Trace::Temperature, (2.0, 3.0), (0.0, 8.0)),
            (Trace::Position, (1.0, 359.0), (0.0, 360.0)),
        ] {
            let (lower, upper) = fitted(trace, range);
            let is_near = (lower - ends.0).abs() < 1e-9 && (upper - ends.1).abs() < 1e-9;
            assert!(is_near, "{trace:?} {range:?}: {lower} to {upper}");
        }
    }

    /// No value is ever outside of the scale, or on its edge.
    #[test]
    fn a_scale_that_follows_values_holds_them_and_seldom_changes() {
        let mut scales = Scales::default();
        let mut changes = 0;
        let mut before = scales.fit(Trace::Speed, Some((0.0, 0.0)));
        for step in 0..1_000 {
            // It rises to 100 rpm, and then the noise comes and goes.
            let greatest = f64::from(step.min(100)) + f64::from(step * 7 % 3);
            let scale = scales.fit(Trace::Speed, Some((-1.0, greatest)));
            let (lower, upper) = scale.ends();
            assert!(lower < -1.0 && upper > greatest, "{step}: {scale:?}");
            changes += u32::from(scale != before);
            before = scale;
        }
        assert!(changes <= 12, "{changes}");
        let narrow = scales.fit(Trace::Speed, Some((99.0, 101.0)));
        assert_eq!(narrow.ends(), (90.0, 110.0));
        assert_eq!(scales.fit(Trace::Speed, None), narrow, "without a value");
    }

    #[test]
    fn a_symmetric_scale_has_zero_in_its_middle() {
        let mut scales = Scales::default();
        let one_sided = scales.fit(Trace::Speed, Some((0.0, 100.0)));
        scales.choose(Fitting {
            symmetric: true,
            ..Fitting::default()
        });
        for (trace, range) in [
            (Trace::Speed, (0.0, 100.0)),
            (Trace::Speed, (-30.0, 100.0)),
            (Trace::Current, (-0.5, -0.2)),
        ] {
            let (lower, upper) = scales.fit(trace, Some(range)).ends();
            assert!(
                (lower + upper).abs() < 1e-9,
                "{trace:?}: {lower} to {upper}"
            );
        }
        let warm = scales.fit(Trace::Temperature, Some((27.0, 28.0)));
        assert_eq!(warm.ends(), (22.0, 34.0), "it has no sign");
        scales.choose(Fitting::default());
        assert_eq!(scales.fit(Trace::Speed, Some((0.0, 100.0))), one_sided);
    }

    #[test]
    fn a_zoomed_scale_is_as_chosen_until_it_is_fitted_again() {
        let mut scales = Scales::default();
        let fitted = scales.fit(Trace::Speed, Some((0.0, 100.0)));
        let upper_half = fitted.part(Trace::Speed, (0.0, 0.5));
        assert_eq!(upper_half.ends(), (50.0, 120.0));
        assert_eq!(fitted.part(Trace::Speed, (0.5, 0.0)), upper_half);
        assert_eq!(
            fitted.part(Trace::Speed, (-0.5, 1.5)).ends(),
            (-90.0, 190.0)
        );
        let narrow = fitted.part(Trace::Speed, (0.5, 0.5)).ends();
        assert_eq!(narrow, (49.0, 51.0));
        let fitting = Fitting::default().with(Trace::Speed, upper_half);
        scales.choose(fitting);
        assert_eq!(scales.fit(Trace::Speed, Some((0.0, 300.0))), upper_half);
        assert_eq!(scales.of(Trace::Speed), upper_half);
        scales.choose(fitting.fitted());
        let all = scales.fit(Trace::Speed, Some((0.0, 100.0)));
        assert_eq!(all.ends(), fitted.ends(), "without hysteresis of the zoom");
    }

    #[test]
    fn labels_are_round_and_the_top_one_has_the_unit() {
        let labels = |trace, range, rows: i32| {
            let scale = Scales::default().fit(trace, Some(range));
            let ticks = scale.ticks(trace, "U", 2 * rows);
            let labels: Vec<String> = ticks.iter().map(|tick| tick.label.clone()).collect();
            labels.join(" | ")
        };
        let speed = (0.0, 100.0);
        assert_eq!(labels(Trace::Speed, speed, 4), "+100 U | +50 | 0");
        assert_eq!(labels(Trace::Speed, speed, 2), "+100 U | 0");
        assert_eq!(
            labels(Trace::Speed, (-100.0, 100.0), 4),
            "+100 U | 0 | \u{2212}100"
        );
        // After a reversal, in a low pane.
        let ends = "+100 U | 0 | \u{2212}100";
        assert_eq!(labels(Trace::Speed, (-105.0, 105.0), 2), ends);
        let around_zero = "+0.1 U | 0.0 | \u{2212}0.1";
        assert_eq!(labels(Trace::Current, (-0.08, 0.13), 2), around_zero);
        assert_eq!(
            labels(Trace::Current, (0.0, 0.0), 4),
            "+0.10 U | +0.05 | 0.00 | \u{2212}0.05 | \u{2212}0.10"
        );
        assert_eq!(labels(Trace::Temperature, (27.0, 28.0), 3), "30 U | 25");
        assert_eq!(
            labels(Trace::Position, (0.0, 359.0), 4),
            "300U | 200 | 100 | 0"
        );
    }

    #[test]
    fn there_are_no_more_steps_than_fit_and_never_none() {
        for span in [1, 7, 999, 20_000, 123_456, GREATEST] {
            for steps_max in 1..12 {
                let step = step(span, steps_max);
                assert!(
                    step >= 1 && span.div_euclid(step) <= steps_max,
                    "{span}: {step}"
                );
            }
        }
    }
}
