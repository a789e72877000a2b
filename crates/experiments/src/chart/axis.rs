//! A scale with its ticks.

use super::AxisName;

/// Ticks that are aimed at.
const TICKS: f64 = 5.0;

/// An axis from one value to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it shows.
    pub name: AxisName,
    /// The value at its beginning.
    pub from: f64,
    /// The value at its end.
    pub to: f64,
    /// The labelled values.
    pub ticks: Vec<f64>,
    /// Decimals of the labels.
    pub decimals: usize,
}

impl Axis {
    /// An axis that holds these values; `None` without a finite one.
    pub(super) fn holding(name: AxisName, values: impl Iterator<Item = f64>) -> Option<Self> {
        let finite = values.filter(|value| value.is_finite());
        let range = finite.fold(None, |range: Option<(f64, f64)>, value| {
            let (least, greatest) = range.unwrap_or((value, value));
            Some((least.min(value), greatest.max(value)))
        });
        let (least, greatest) = range?;
        if name == AxisName::Frequency && least > 0.0 {
            return Some(Self::logarithmic(name, least, greatest));
        }
        // These are read against zero.
        let (least, greatest) = match name {
            AxisName::Time => (least.min(0.0), greatest),
            AxisName::RSquared => (0.0, 1.0),
            _ => (least, greatest),
        };
        // What hardly changes is a straight line.
        let span_min = match name {
            AxisName::Speed | AxisName::Position => 1.0,
            AxisName::Current => 0.1,
            _ => 1e-6,
        };
        let span = (greatest - least).max(1e-3 * greatest.abs()).max(span_min);
        let step = even_step(span / TICKS);
        let first = (least / step).floor();
        let end = (greatest / step).ceil().max(first + 1.0);
        let count = crate::number::whole(end - first);
        let at = |tick: u32| (first + f64::from(tick)) * step;
        let (from, to) = if name == AxisName::Time {
            (least, greatest.max(least + span))
        } else {
            (at(0), at(count))
        };
        let inside = |tick: &f64| *tick >= from - step * 1e-6 && *tick <= to + step * 1e-6;
        Some(Self {
            name,
            from,
            to,
            ticks: (0..=count).map(at).filter(inside).collect(),
            decimals: decimals(step),
        })
    }

    fn logarithmic(name: AxisName, least: f64, greatest: f64) -> Self {
        let greatest = greatest.max(least * 2.0);
        let mut ticks = Vec::new();
        let mut decade = 10_f64.powf(least.log10().floor());
        while decade <= greatest {
            let steps = [1.0, 2.0, 5.0].map(|step| step * decade);
            let inside = |tick: &f64| *tick >= least * 0.999 && *tick <= greatest * 1.001;
            ticks.extend(steps.into_iter().filter(inside));
            decade *= 10.0;
        }
        Self {
            name,
            from: least,
            to: greatest,
            ticks,
            decimals: 2,
        }
    }

    /// The place of a value, from 0 to 1.
    #[must_use]
    pub fn place(&self, value: f64) -> f64 {
        if self.name == AxisName::Frequency && self.from > 0.0 {
            return (value / self.from).ln() / (self.to / self.from).ln();
        }
        (value - self.from) / (self.to - self.from)
    }

    /// The label of a tick, with a real minus.
    #[must_use]
    pub fn label(&self, tick: f64) -> String {
        let decimals = self.decimals;
        let digits = if self.name == AxisName::Frequency {
            format!("{tick}")
        } else {
            format!("{:.decimals$}", tick.abs())
        };
        let is_zero = digits.bytes().all(|byte| matches!(byte, b'0' | b'.'));
        if tick < 0.0 && !is_zero {
            format!("\u{2212}{digits}")
        } else {
            digits
        }
    }
}

/// The step of 1, 2 or 5 times a power of ten that is not below this.
fn even_step(least: f64) -> f64 {
    let decade = 10_f64.powf(least.log10().floor());
    let fits = [1.0, 2.0, 5.0].map(|step| step * decade);
    let fits = fits.into_iter().find(|step| *step >= least * 0.999);
    fits.unwrap_or(10.0 * decade)
}

fn decimals(step: f64) -> usize {
    let places = -step.log10().floor();
    usize::try_from(crate::number::whole(places.clamp(0.0, 6.0))).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_holds_its_values_between_round_ticks() {
        let axis = Axis::holding(AxisName::Speed, [-3.0, 101.0].into_iter()).unwrap();
        assert_eq!((axis.from, axis.to), (-50.0, 150.0));
        assert_eq!(axis.ticks, [-50.0, 0.0, 50.0, 100.0, 150.0]);
        assert_eq!(axis.label(-50.0), "\u{2212}50");
        assert!((axis.place(50.0) - 0.5).abs() < 1e-9);
        let axis = Axis::holding(AxisName::Frequency, [0.2, 20.0].into_iter()).unwrap();
        assert_eq!(axis.ticks, [0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0]);
        assert!((axis.place(2.0) - 0.5).abs() < 1e-9);
    }

    #[test]
    fn one_value_or_none_makes_no_empty_axis() {
        let axis = Axis::holding(AxisName::Speed, [7.0].into_iter()).unwrap();
        assert!(axis.to > axis.from && axis.place(7.0).is_finite());
        let axis = Axis::holding(AxisName::Time, [0.0].into_iter()).unwrap();
        assert!(axis.to > axis.from);
        assert_eq!(Axis::holding(AxisName::Speed, [f64::NAN].into_iter()), None);
    }
}
