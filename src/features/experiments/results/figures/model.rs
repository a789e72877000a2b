//! The figures of fitted models.

use motorlink_i18n::tr;
use motorlink_messages::experiments::analysis::{Estimate, FittedModel, Lag};

use super::{Figures, estimate, number};
use crate::ui::format::rpm;

/// The fitted models, if there is one. `step_rpm` gives the unit of their residuals.
pub(super) fn add(figures: &mut Figures, models: &[Option<FittedModel>], step_rpm: Option<f64>) {
    if models.iter().all(Option::is_none) {
        return;
    }
    let mut row = |name: &'static str, value: &dyn Fn(&FittedModel) -> Option<String>| {
        let values: Vec<_> = models.iter().map(|it| value(it.as_ref()?)).collect();
        if values.iter().any(Option::is_some) {
            figures.row(name, values);
        }
    };
    row(tr!("Fitted model"), &|model| {
        Some(match model.lag {
            Lag::First { .. } => tr!("dead time, first order").to_owned(),
            Lag::Second { .. } => tr!("dead time, second order").to_owned(),
        })
    });
    let mut part = |name, value: fn(&FittedModel) -> Option<Estimate>, factor, unit| {
        row(name, &|it| Some(part_of_model(value(it)?, factor, unit)));
    };
    part(tr!("Gain"), |it| Some(it.gain), 1.0, "");
    part(tr!("Dead time"), |it| Some(it.dead_time_s), 1e3, "ms");
    part(tr!("Time constant"), |it| it.lag.parts().0, 1e3, "ms");
    part(tr!("Natural frequency"), |it| it.lag.parts().1, 1.0, "Hz");
    part(tr!("Damping ratio"), |it| it.lag.parts().2, 1.0, "");
    row(tr!("Model error, RMS"), &|model| {
        let error = number(model.rms * step_rpm?, 1);
        Some(format!("{error} {}", rpm()))
    });
    figures.says(tr!(
        "In the chart of one run, the dotted line is the model. Its order is the one with the lower AICc, and an interval (±) of 99 % needs three repeats."
    ));
}

/// A parameter of a model. With fewer than three repeats it has no interval.
fn part_of_model(found: Estimate, factor: f64, unit: &str) -> String {
    if found.plus_minus == f64::INFINITY {
        let value = number(found.value * factor, if unit == "ms" { 1 } else { 2 });
        return format!("{value} {unit}").trim_end().to_owned();
    }
    estimate(Some(found), factor, unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_of_two_repeats_has_its_values_without_an_interval() {
        let of_two = |value| Estimate {
            value,
            plus_minus: f64::INFINITY,
        };
        assert_eq!(part_of_model(of_two(0.031_24), 1e3, "ms"), "31.2 ms");
        assert_eq!(part_of_model(of_two(0.987), 1.0, ""), "0.99");
        let of_five = Estimate {
            value: 0.031_24,
            plus_minus: 0.000_4,
        };
        assert_eq!(part_of_model(of_five, 1e3, "ms"), "31.24 ± 0.40 ms");
    }
}
