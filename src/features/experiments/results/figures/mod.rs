//! The findings of a run as rows of text, for the page and for the report.

use motorlink_i18n::tr;
use motorlink_messages::experiments::{
    analysis::{Estimate, FittedModel, Lag, Spread, StepSummary, Tracking},
    study::{
        CoastDownFindings, Findings, FrequencyFindings, FrictionFindings, HeatingFindings,
        MotorFindings, SilenceFindings, StepFindings, StepGroup, TorqueSpeedFindings,
    },
};

use motorlink_messages::protocol::family::Model;

use super::texts::{self, number};
use crate::{
    features::experiments::texts as study_texts,
    model::terms,
    ui::format::{UNKNOWN, rpm},
};

/// A figure, with a value for each column.
pub(super) struct Figure {
    pub(super) name: &'static str,
    pub(super) values: Vec<String>,
}

/// What the page says about a run.
#[derive(Default)]
pub(super) struct Figures {
    /// The heads of the columns, if there are several.
    pub(super) columns: Vec<String>,
    pub(super) rows: Vec<Figure>,
    /// What the figures mean.
    pub(super) meaning: Vec<String>,
    /// The figures of the maker, or why there are none.
    pub(super) maker: Vec<String>,
}

impl Figures {
    /// The figures of a run of this model. Only the DDSM115 has figures of its maker, and a known torque constant.
    pub(super) fn of(findings: &Findings, model: &str) -> Self {
        let mut figures = Self::of_ddsm115(findings);
        if model == Model::Ddsm115.spec().name {
            if has_torque(findings) {
                figures.maker_says(tr!(
                    "The intervals do not include the torque constant, 0.75 N·m/A. The maker's own points give 0.74 to 0.77, so a figure with a torque can be off by 3 % more."
                ));
            }
            return figures;
        }
        figures.maker.clear();
        if has_torque(findings) {
            figures.maker_says(tr!(
                "Torque and inertia are computed with 0.75 N·m/A, the figure of the DDSM115. That of the {model} is not known, so they are not those of this motor.",
                model
            ));
        }
        figures
    }

    fn of_ddsm115(findings: &Findings) -> Self {
        match findings {
            Findings::Sequence(found) => sequence(found),
            Findings::Step(found) => step(found),
            Findings::Frequency(found) => frequency(found),
            Findings::Friction(found) => friction(found),
            Findings::CoastDown(found) => coast_down(found),
            Findings::Heating(found) => heating(found),
            Findings::TorqueSpeed(found) => torque_speed(found),
            Findings::Silence(found) => silence(found),
        }
    }

    /// The figures of several runs of one study as one table, a column or more for each.
    pub(super) fn beside_each_other(runs: impl IntoIterator<Item = (String, Self)>) -> Self {
        let mut all = Self::default();
        for (name, run) in runs {
            // A run without figures has none in any row.
            let width = run.rows.first().map_or(1, |row| row.values.len());
            let before = all.columns.len();
            all.columns.extend((0..width).map(|place| {
                let of = run.columns.get(place).filter(|of| !of.is_empty());
                of.map_or_else(|| name.clone(), |of| format!("{name}, {of}"))
            }));
            for Figure { name, values } in run.rows {
                let known = all.rows.iter().position(|row| row.name == name);
                let place = known.unwrap_or_else(|| {
                    let values = vec![UNKNOWN.to_owned(); before];
                    all.rows.push(Figure { name, values });
                    all.rows.len() - 1
                });
                if let Some(row) = all.rows.get_mut(place) {
                    row.values.extend(values);
                }
            }
            for row in &mut all.rows {
                row.values.resize(before + width, UNKNOWN.to_owned());
            }
            for (list, texts) in [(&mut all.meaning, run.meaning), (&mut all.maker, run.maker)] {
                for text in texts {
                    if !list.contains(&text) {
                        list.push(text);
                    }
                }
            }
        }
        all
    }

    fn row(&mut self, name: &'static str, value: Option<String>) {
        let value = value.unwrap_or_else(|| UNKNOWN.to_owned());
        self.rows.push(Figure {
            name,
            values: vec![value],
        });
    }

    /// A figure with its interval, if that tells more than the order of magnitude.
    fn estimate(&mut self, name: &'static str, found: Option<Estimate>, factor: f64, unit: &str) {
        let found = found.filter(|found| found.is_measurable());
        let value = found.map_or_else(
            || tr!("not measurable").to_owned(),
            |found| estimate(found, factor, unit),
        );
        self.row(name, Some(value));
    }

    /// The fitted models, if there is one. `step_rpm` gives the unit of their residuals.
    fn model(&mut self, models: &[Option<FittedModel>], step_rpm: Option<f64>) {
        if models.iter().all(Option::is_none) {
            return;
        }
        let mut row = |name: &'static str, value: &dyn Fn(&FittedModel) -> Option<String>| {
            let values: Vec<Option<String>> = models.iter().map(|it| value(it.as_ref()?)).collect();
            if values.iter().any(Option::is_some) {
                let text = |it: Option<String>| it.unwrap_or_else(|| UNKNOWN.to_owned());
                let values = values.into_iter().map(text).collect();
                self.rows.push(Figure { name, values });
            }
        };
        let known = |found: Estimate, factor: f64, unit: &str| {
            if found.is_measurable() {
                estimate(found, factor, unit).trim_end().to_owned()
            } else {
                tr!("not measurable").to_owned()
            }
        };
        row(tr!("Fitted model"), &|model| {
            Some(match model.lag {
                Lag::First { .. } => tr!("dead time, first order").to_owned(),
                Lag::Second { .. } => tr!("dead time, second order").to_owned(),
            })
        });
        row(tr!("Gain"), &|model| Some(known(model.gain, 1.0, "")));
        row(tr!("Dead time"), &|model| {
            Some(known(model.dead_time_s, 1e3, "ms"))
        });
        row(tr!("Time constant"), &|model| match model.lag {
            Lag::First { time_constant_s } => Some(known(time_constant_s, 1e3, "ms")),
            Lag::Second { .. } => None,
        });
        row(tr!("Natural frequency"), &|model| match model.lag {
            Lag::First { .. } => None,
            Lag::Second { natural_hz, .. } => Some(known(natural_hz, 1.0, "Hz")),
        });
        row(tr!("Damping ratio"), &|model| match model.lag {
            Lag::First { .. } => None,
            Lag::Second { damping, .. } => Some(known(damping, 1.0, "")),
        });
        row(tr!("Model error, RMS"), &|model| {
            let error = number(model.rms * step_rpm?, 1);
            Some(format!("{error} {}", rpm()))
        });
        self.says(tr!(
            "The dotted line is the model. Its order is the one with the lower AICc, and an interval (±) of 99 % needs three repeats."
        ));
    }

    fn intervals(&mut self) {
        self.says(tr!(
            "An interval (±) holds the true value in 99 of 100 runs. A figure whose interval is too wide is not measurable."
        ));
    }

    fn says(&mut self, text: impl Into<String>) {
        self.meaning.push(text.into());
    }

    fn maker_says(&mut self, text: impl Into<String>) {
        self.maker.push(text.into());
    }

    fn left_out(&mut self, count: usize) {
        if count > 0 {
            self.says(tr!(
                "Left out, because they were paused or aborted: {count}",
                count
            ));
        }
    }
}

/// `22 ms (21…23)`: the median with the quartiles. `n` says that it is a median of fewer than all repeats.
fn spread(
    found: Option<Spread>,
    repeats: usize,
    factor: f64,
    decimals: usize,
    unit: &str,
) -> String {
    let Some(found) = found else {
        return UNKNOWN.to_owned();
    };
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

/// Whether a figure is computed with the torque constant.
const fn has_torque(findings: &Findings) -> bool {
    matches!(findings, Findings::CoastDown(_) | Findings::TorqueSpeed(_))
}

/// `1.0020 ± 0.0040 g·m²`: the interval has two digits, as the GUM advises (7.2.6).
fn estimate(found: Estimate, factor: f64, unit: &str) -> String {
    let plus_minus = found.plus_minus * factor;
    let (mut decimals, mut digits) = (0, plus_minus);
    while digits < 9.95 && decimals < 6 {
        digits *= 10.0;
        decimals += 1;
    }
    let value = number(found.value * factor, decimals);
    format!("{value} ± {} {unit}", number(plus_minus, decimals))
}

fn sequence(found: &[MotorFindings]) -> Figures {
    let mut figures = Figures {
        columns: found.iter().map(|it| it.motor.get().to_string()).collect(),
        ..Figures::default()
    };
    let of = |value: &dyn Fn(&Tracking, &str) -> String| {
        let text = |motor: &MotorFindings| {
            let tracking = motor.tracking.as_ref();
            tracking.map_or_else(
                || UNKNOWN.to_owned(),
                |it| value(it, study_texts::unit(it.quantity)),
            )
        };
        found.iter().map(text).collect::<Vec<_>>()
    };
    let rms = of(&|it, unit| format!("{} {unit}", number(it.rms, 2)));
    let worst = of(&|it, unit| {
        let at_s = number(it.worst_s, 2);
        let worst = number(it.worst, 2);
        tr!("{worst} {unit} at {at_s} s", worst, unit, at_s)
    });
    figures.rows = vec![
        Figure {
            name: tr!("Tracking error, RMS"),
            values: rms,
        },
        Figure {
            name: tr!("Tracking error, worst"),
            values: worst,
        },
    ];
    figures.says(tr!(
        "Setpoint less reported value at the same time, over all replies with a setpoint. A step counts in full until the motor has followed."
    ));
    figures
}

/// What a figure of a step follows from.
#[derive(Clone, Copy)]
enum Needs {
    /// The replies alone.
    Replies,
    /// A steady value.
    Settled,
}

fn step(found: &StepFindings) -> Figures {
    let mut figures = Figures {
        columns: found
            .groups
            .iter()
            .map(|group| texts::acceleration(group.acceleration.byte()))
            .collect(),
        ..Figures::default()
    };
    let step = (found.to_rpm - found.from_rpm).abs();
    let of =
        |needs: Needs, value: fn(&StepSummary) -> Option<Spread>, factor, decimals, unit: &str| {
            let text = |group: &StepGroup| {
                let (repeats, settled) = (group.repeats.len(), group.summary.settled);
                match needs {
                    Needs::Settled if settled == 0 => tr!("not settled").to_owned(),
                    _ => spread(value(&group.summary), repeats, factor, decimals, unit),
                }
            };
            found.groups.iter().map(text).collect::<Vec<String>>()
        };
    let settled =
        |group: &StepGroup| format!("{} / {}", group.summary.settled, group.repeats.len());
    let rows = [
        (tr!("Settled"), found.groups.iter().map(settled).collect()),
        (
            tr!("Latency"),
            of(Needs::Replies, |it| it.latency_s, 1e3, 0, "ms"),
        ),
        (
            tr!("Rise time"),
            of(Needs::Settled, |it| it.rise_s, 1e3, 0, "ms"),
        ),
        (
            tr!("Overshoot"),
            of(Needs::Settled, |it| it.overshoot, 100.0, 1, "%"),
        ),
        (
            tr!("Undershoot"),
            of(Needs::Settled, |it| it.wrong_way, 100.0, 1, "%"),
        ),
        (
            tr!("Settling time"),
            of(Needs::Settled, |it| it.settling_s, 1e3, 0, "ms"),
        ),
        (
            tr!("Steady-state error"),
            of(Needs::Settled, |it| it.steady_error, 1.0, 1, rpm()),
        ),
        (
            tr!("Peak speed"),
            of(Needs::Replies, |it| it.peak, 1.0, 1, rpm()),
        ),
        (
            tr!("Peak current"),
            of(Needs::Replies, |it| it.peak_amps, 1.0, 2, "A"),
        ),
    ];
    figures.rows = rows
        .into_iter()
        .map(|(name, mut values)| {
            if values.is_empty() {
                values.push(UNKNOWN.to_owned());
            }
            Figure { name, values }
        })
        .collect();
    let models: Vec<_> = found.groups.iter().map(|group| group.model).collect();
    figures.model(&models, Some(step));
    let total: usize = found.groups.iter().map(|group| group.repeats.len()).sum();
    let settled: usize = found.groups.iter().map(|group| group.summary.settled).sum();
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
    figures
}

fn frequency(found: &FrequencyFindings) -> Figures {
    let mut figures = Figures::default();
    let valid = || found.points.iter().filter(|point| point.invalid.is_none());
    let bandwidth = found.bandwidth_hz.map(|hz| format!("{} Hz", number(hz, 2)));
    figures.row(
        tr!("Bandwidth (\u{2212}3 dB)"),
        bandwidth.or_else(|| Some(tr!("not measurable").to_owned())),
    );
    figures.row(
        tr!("Valid points"),
        Some(format!("{} / {}", valid().count(), found.points.len())),
    );
    figures.model(&[found.model], None);
    for point in &found.points {
        if let Some(why) = point.invalid {
            figures.says(tr!(
                "{hz} Hz is not valid: {why}",
                hz = number(point.hz, 2),
                why = texts::invalid(why)
            ));
        }
    }
    if let Some(first) = valid().find(|point| !point.turn_is_known) {
        figures.says(tr!(
            "From {hz} Hz on the turn of the phase is unknown: it may lag by 360° more, or a multiple of that. Choose more points, or a lower first frequency.",
            hz = number(first.hz, 2)
        ));
    }
    figures.left_out(found.left_out);
    figures.says(tr!(
        "How well the velocity loop follows a sine: 0 dB is the full amplitude, and a phase below 0° is a delay. Crosses mark points that are not valid."
    ));
    figures
}

fn friction(found: &FrictionFindings) -> Figures {
    let mut figures = Figures::default();
    let fit = found.friction;
    figures.estimate(tr!("Coulomb part"), fit.map(|it| it.coulomb_a), 1.0, "A");
    let unit = format!("mA/{}", rpm());
    let viscous = fit.map(|it| it.viscous_a_per_rpm);
    figures.estimate(tr!("Viscous part"), viscous, 1e3, &unit);
    figures.left_out(found.left_out);
    figures.says(tr!(
        "The current that the motor reports at an even speed: a part that does not depend on the speed, and one that grows with it. It is more than friction; the coast-down measures that."
    ));
    figures.intervals();
    figures.maker_says(tr!("Maker: at most 0.25 A without load."));
    figures
}

fn coast_down(found: &CoastDownFindings) -> Figures {
    let mut figures = Figures::default();
    let fit = found.inertia;
    let inertia = fit.map(|it| it.inertia_kg_m2);
    figures.estimate(tr!("Inertia"), inertia, 1e3, "g·m²");
    let dry = fit.map(|it| it.dry_nm);
    figures.estimate(tr!("Dry friction"), dry, 1e3, "mN·m");
    let viscous = fit.map(|it| it.viscous_nm_s);
    figures.estimate(tr!("Viscous friction"), viscous, 1e3, "mN·m·s");
    let dry = found.coast.map(|it| it.dry_rad_s2);
    figures.estimate(tr!("Friction over inertia"), dry, 1.0, "rad/s²");
    figures.says(tr!(
        "Inertia from pushes by a known current, friction from how the wheel slows down at 0 A."
    ));
    figures.intervals();
    figures.maker_says(tr!(
        "Maker: 0.75 N·m/A, which gives the torque of a push; a wheel of 102 mm and 485 g."
    ));
    figures
}

fn heating(found: &HeatingFindings) -> Figures {
    let mut figures = Figures::default();
    let fit = found.heating;
    let constant = fit.map(|it| it.time_constant_s);
    figures.estimate(tr!("Time constant"), constant, 1.0, "s");
    let ends = fit.map(|it| it.final_c);
    figures.estimate(tr!("Final temperature"), ends, 1.0, "°C");
    figures.row(
        tr!("Mean current"),
        found.amps.map(|amps| format!("{} A", number(amps, 2))),
    );
    figures.says(tr!(
        "After one time constant the winding has 63 % of its rise. The final temperature is where it ends at this current."
    ));
    figures.intervals();
    figures.maker_says(tr!(
        "Maker: the motor protects itself at 80 °C, until it has cooled to 75 °C."
    ));
    figures
}

fn torque_speed(found: &TorqueSpeedFindings) -> Figures {
    let mut figures = Figures::default();
    let line = found.line;
    let no_load = line.map(|it| it.no_load_rpm);
    figures.estimate(tr!("No-load speed"), no_load, 1.0, rpm());
    let unit = format!("{}/N·m", rpm());
    let droop = line.and_then(|it| it.droop).map(|it| it.rpm_per_nm);
    figures.estimate(tr!("Speed lost to torque"), droop, 1.0, &unit);
    figures.says(tr!(
        "How much slower the wheel turns under load at the voltage limit: the set speed must be above the one that it reaches. The reported current includes a part without torque, so the figures follow from how its square grows as the speed falls."
    ));
    figures.intervals();
    figures.maker_says(tr!(
        "Maker: 200 ± 10 rpm without load at 18 V, 0.96 N·m at 115 rpm, 2.0 N·m at a stall."
    ));
    figures
}

fn silence(found: &SilenceFindings) -> Figures {
    let mut figures = Figures::default();
    let result = found
        .result
        .map_or(tr!("not measurable"), terms::when_silent);
    figures.row(terms::when_frames_cease(), Some(result.to_owned()));
    let speeds = |(before, after): (Option<f64>, Option<f64>)| {
        let (before, after) = (number(before?, 0), number(after?, 0));
        Some(format!("{before} → {after} {}", rpm()))
    };
    figures.row(tr!("Speed with queries"), speeds(found.asked_rpm));
    figures.row(tr!("Speed without queries"), speeds(found.unasked_rpm));
    figures.says(match found.result {
        Some(_) => tr!(
            "What the motor did within 0.6 s. Its firmware may do something else later, so frames that cease are never a stop."
        ),
        None => tr!(
            "Replies are missing, the run was cut short, or the wheel did not turn freely at 30 rpm. Check the link and the wheel, then run it again."
        ),
    });
    figures
}

#[cfg(test)]
mod tests {
    use motorlink_messages::{
        experiments::{
            analysis::{BodePoint, Invalid, StepFigures, WhenSilent, step_summary},
            runner::Record,
            study::{Measured, StepRepeat, StepStudy, Study},
        },
        protocol::{Acceleration, MotorId},
    };

    use super::*;

    #[test]
    fn a_figure_has_its_interval_and_no_sign_at_zero() {
        let found = Estimate {
            value: 1.002e-3,
            plus_minus: 4e-6,
        };
        assert_eq!(estimate(found, 1e3, "g·m²"), "1.0020 ± 0.0040 g·m²");
        assert_eq!(estimate(found, 1e6, "mg·m²"), "1002.0 ± 4.0 mg·m²");
        assert_eq!(number(-0.001, 1), "0.0");
        assert_eq!(number(-1.25, 1), "\u{2212}1.2");
        let repeats = Spread {
            median: 0.022,
            low: 0.021,
            high: 0.023,
            count: 5,
        };
        assert_eq!(spread(Some(repeats), 5, 1e3, 0, "ms"), "22 ms (21…23)");
        let one = Spread {
            count: 1,
            ..repeats
        };
        assert_eq!(spread(Some(one), 1, 1e3, 0, "ms"), "22 ms");
        assert_eq!(spread(Some(one), 5, 1e3, 0, "ms"), "22 ms, n = 1");
        assert_eq!(spread(None, 1, 1e3, 0, "ms"), UNKNOWN);
    }

    #[test]
    fn an_interval_that_contains_zero_is_not_measurable() {
        let mut figures = Figures::default();
        let (value, plus_minus) = (0.006e-3, 0.103e-3);
        let viscous = Estimate { value, plus_minus };
        figures.estimate("Viscous part", Some(viscous), 1e3, "mA/rpm");
        figures.estimate("Viscous part", None, 1e3, "mA/rpm");
        for row in figures.rows {
            assert_eq!(row.values, ["not measurable"]);
        }
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
        for name in [
            "Rise time",
            "Overshoot",
            "Undershoot",
            "Settling time",
            "Steady-state error",
        ] {
            assert_eq!(value(name).as_deref(), Some("not settled"));
        }
        assert!(figures.meaning[0].starts_with("Not settled within the hold: 1 of 1."));
    }

    #[test]
    fn runs_beside_each_other_share_their_rows() {
        let of = |hz: Option<f64>| {
            let found = FrequencyFindings {
                points: Vec::new(),
                bandwidth_hz: hz,
                model: None,
                left_out: 0,
            };
            Figures::of(&Findings::Frequency(found), "DDSM115")
        };
        let runs = [("a", of(Some(3.0))), ("b", of(None))];
        let runs = runs.map(|(name, figures)| (name.to_owned(), figures));
        let table = Figures::beside_each_other(runs);
        assert_eq!(table.columns, ["a", "b"]);
        assert_eq!(table.rows[0].values, ["3.00 Hz", "not measurable"]);
        assert_eq!(table.rows[1].values, ["0 / 0", "0 / 0"]);
        assert_eq!(table.meaning.len(), 1);
    }

    #[test]
    fn a_silence_says_its_result_or_that_it_was_not_measurable() {
        let mut found = SilenceFindings {
            result: Some(WhenSilent::Keeps),
            asked_rpm: (Some(30.0), Some(29.7)),
            unasked_rpm: (Some(30.0), None),
            curves: [Vec::new(), Vec::new()],
        };
        let values = |found: &SilenceFindings| {
            let figures = Figures::of(&Findings::Silence(found.clone()), "DDSM115");
            let rows = figures.rows.into_iter();
            rows.map(|row| row.values.concat()).collect::<Vec<_>>()
        };
        let expected = ["keeps its last command", "30 → 30 rpm", UNKNOWN];
        assert_eq!(values(&found), expected);
        found.result = None;
        assert_eq!(values(&found)[0], "not measurable");
    }

    #[test]
    fn an_invalid_point_is_named_with_its_reason() {
        let found = Findings::Frequency(FrequencyFindings {
            points: vec![BodePoint {
                hz: 12.6,
                gain_db: 0.0,
                phase_deg: 0.0,
                turn_is_known: true,
                r_squared: 0.1,
                from_s: 0.0,
                to_s: 6.0,
                invalid: Some(Invalid::TooSmall),
            }],
            bandwidth_hz: None,
            model: None,
            left_out: 0,
        });
        let figures = Figures::of(&found, "DDSM115");
        assert!(figures.meaning[0].starts_with("12.60 Hz is not valid"));
        assert_eq!(figures.rows[1].values, ["0 / 1"]);
    }
}
