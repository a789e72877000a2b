//! The figures of step responses: a column for each acceleration.

use motorlink_i18n::tr;
use motorlink_messages::experiments::{
    analysis::{Spread, StepSummary},
    study::{StepFindings, StepGroup},
};

use super::{Figures, model, number, texts};
use crate::ui::format::rpm;

/// What a figure of a step follows from.
#[derive(Clone, Copy)]
enum Needs {
    /// The replies alone.
    Replies,
    /// A steady value.
    Settled,
}
use Needs::{Replies, Settled};

/// A factor, decimals, and a unit.
type Unit = (f64, usize, &'static str);
const MS: Unit = (1e3, 0, "ms");
const PERCENT: Unit = (100.0, 1, "%");
const AMPS: Unit = (1.0, 2, "A");

pub(super) fn add(figures: &mut Figures, found: &StepFindings) {
    let groups = || found.groups.iter();
    let names = groups().map(|group| texts::acceleration(group.acceleration.byte()));
    figures.columns = names.collect();
    let settled = |it: &StepGroup| Some(format!("{} / {}", it.summary.settled, it.repeats.len()));
    figures.row(tr!("Settled"), groups().map(settled).collect());
    let mut row = |name, needs, value: fn(&StepSummary) -> _, unit| {
        let text = |group: &StepGroup| {
            let (summary, repeats) = (&group.summary, group.repeats.len());
            match needs {
                Settled if summary.settled == 0 => Some(tr!("not settled").to_owned()),
                _ => Some(spread(value(summary)?, repeats, unit)),
            }
        };
        figures.row(name, groups().map(text).collect());
    };
    let rpm = (1.0, 1, rpm());
    row(tr!("Latency"), Replies, |it| it.latency_s, MS);
    row(tr!("Rise time"), Settled, |it| it.rise_s, MS);
    row(tr!("Overshoot"), Settled, |it| it.overshoot, PERCENT);
    row(tr!("Undershoot"), Settled, |it| it.wrong_way, PERCENT);
    row(tr!("Settling time"), Settled, |it| it.settling_s, MS);
    row(
        tr!("Steady-state error"),
        Settled,
        |it| it.steady_error,
        rpm,
    );
    row(tr!("Peak speed"), Replies, |it| it.peak, rpm);
    row(tr!("Peak current"), Replies, |it| it.peak_amps, AMPS);
    let step = (found.to_rpm - found.from_rpm).abs();
    let models: Vec<_> = groups().map(|group| group.model).collect();
    model::add(figures, &models, Some(step));
    let total: usize = groups().map(|group| group.repeats.len()).sum();
    let settled: usize = groups().map(|group| group.summary.settled).sum();
    if settled < total {
        figures.says(tr!(
            "Not settled within the hold: {count} of {total}. They have only latency and peaks. Choose a longer hold.",
            count = total - settled,
            total
        ));
    }
    figures.left_out(found.left_out);
    figures.says(tr!(
        "How fast the motor follows a step of {step} rpm. The median of the repeats, with the quartiles in brackets.",
        step = number(step, 0)
    ));
    figures.maker_says(tr!(
        "Maker: from rest to 90 % of 120 rpm in 446 ms at acceleration 1, with at most 0.40 A."
    ));
}

/// `22 ms (21…23)`: the median with the quartiles. `n` says that it is a median of fewer than all repeats.
fn spread(found: Spread, repeats: usize, (factor, decimals, unit): Unit) -> String {
    let number = |value: f64| number(value * factor, decimals);
    let mut text = format!("{} {unit}", number(found.median));
    if found.count > 1 {
        let (low, high) = (number(found.low), number(found.high));
        text = format!("{text} ({low}…{high})");
    }
    if found.count < repeats {
        text = format!("{text}, n = {}", found.count);
    }
    text
}

#[cfg(test)]
mod tests {
    use motorlink_messages::{
        experiments::{
            analysis::{StepFigures, step_summary},
            runner::Record,
            study::{Findings, Measured, StepRepeat, StepStudy, Study},
        },
        protocol::{Acceleration, MotorId},
    };

    use super::*;
    use crate::ui::format::UNKNOWN;

    #[test]
    fn a_median_has_its_quartiles_and_says_if_repeats_are_missing() {
        let repeats = Spread {
            median: 0.022,
            low: 0.021,
            high: 0.023,
            count: 5,
        };
        assert_eq!(spread(repeats, 5, MS), "22 ms (21…23)");
        let one = Spread {
            count: 1,
            ..repeats
        };
        assert_eq!(spread(one, 1, MS), "22 ms");
        assert_eq!(spread(one, 5, MS), "22 ms, n = 1");
    }

    #[test]
    fn a_step_without_replies_has_unknown_figures() {
        let study = Study::Step(StepStudy::of(MotorId::FIRST));
        let found = study.evaluate(&Record::default(), &Measured::default());
        let figures = Figures::of(&found, "DDSM115");
        assert_eq!(figures.rows.len(), 9);
        assert!(figures.rows.iter().all(|row| row.values == [UNKNOWN]));
    }

    #[test]
    fn a_step_that_has_not_settled_says_so_beside_its_figures() {
        let figures = StepFigures {
            latency_s: Some(0.02),
            peak: Some(41.0),
            ..StepFigures::default()
        };
        let repeat = StepRepeat {
            at_s: 1.2,
            to_s: 2.7,
            figures,
            rpm: Vec::new(),
        };
        let found = Findings::Step(StepFindings {
            from_rpm: 0.0,
            to_rpm: 100.0,
            groups: vec![StepGroup {
                acceleration: Acceleration::new(10),
                repeats: vec![repeat],
                summary: step_summary(&[figures]),
                model: None,
            }],
            left_out: 0,
        });
        let figures = Figures::of(&found, "DDSM115");
        let value = |name: &str| {
            let mut rows = figures.rows.iter();
            rows.find(|row| row.name == name)
                .map(|row| row.values.concat())
        };
        assert_eq!(value("Latency").as_deref(), Some("20 ms"));
        assert_eq!(value("Peak speed").as_deref(), Some("41.0 rpm"));
        let rows = figures.rows.iter();
        let unsettled = rows.filter(|row| row.values == ["not settled"]);
        assert_eq!(unsettled.count(), 5);
        assert!(figures.meaning[0].starts_with("Not settled within the hold: 1 of 1."));
    }
}
