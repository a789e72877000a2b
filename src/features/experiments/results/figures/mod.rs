//! The findings of a run as rows of text, for the page and for the report. Each study has a file.

mod coast_down;
mod frequency;
mod friction;
mod heating;
mod model;
mod sequence;
mod silence;
mod step;
mod torque_speed;

use motorlink_i18n::tr;
use motorlink_messages::{
    experiments::{
        analysis::{Estimate, SetpointRate},
        study::Findings,
    },
    protocol::family::Model,
};

use super::texts::{self, number};
use crate::ui::format::UNKNOWN;

/// More missing replies than this share are said beside the figures.
const LOST_MAX: f64 = 0.01;

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
        let mut figures = Self::default();
        match findings {
            Findings::Sequence(found) => sequence::add(&mut figures, found),
            Findings::Step(found) => step::add(&mut figures, found),
            Findings::Frequency(found) => frequency::add(&mut figures, found),
            Findings::Friction(found) => friction::add(&mut figures, found),
            Findings::CoastDown(found) => coast_down::add(&mut figures, found),
            Findings::Heating(found) => heating::add(&mut figures, found),
            Findings::TorqueSpeed(found) => torque_speed::add(&mut figures, found),
            Findings::Silence(found) => silence::add(&mut figures, found),
        }
        let is_ddsm115 = model == Model::Ddsm115.spec().name;
        if !is_ddsm115 {
            figures.maker.clear();
        }
        match findings {
            Findings::CoastDown(_) | Findings::TorqueSpeed(_) if is_ddsm115 => figures.maker_says(tr!(
                "The intervals do not include the torque constant, 0.75 N·m/A. The maker's own points give 0.74 to 0.77, so a figure with a torque can be off by 3 % more."
            )),
            Findings::CoastDown(_) | Findings::TorqueSpeed(_) => figures.maker_says(tr!(
                "Torque and inertia are computed with 0.75 N·m/A, the figure of the DDSM115. That of the {model} is not known.",
                model
            )),
            _ => {}
        }
        figures
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

    /// A figure with a value for each column.
    fn row(&mut self, name: &'static str, mut values: Vec<Option<String>>) {
        if values.is_empty() {
            values.push(None);
        }
        let values = values.into_iter();
        let values = values.map(|value| value.unwrap_or_else(|| UNKNOWN.to_owned()));
        self.rows.push(Figure {
            name,
            values: values.collect(),
        });
    }

    /// The periods without a reply, in each column: of its motor, or of the motor of the study. First, because it says how far
    /// the others hold.
    pub(super) fn add_missing(&mut self, rates: &[Option<SetpointRate>]) {
        let width = self.rows.first().map_or(1, |row| row.values.len());
        let has_column_each = rates.len() == width;
        let lost = (0..width).map(|place| {
            let place = if has_column_each { place } else { 0 };
            let lost = rates.get(place).copied().flatten()?.lost;
            Some(format!("{} %", number(100.0 * lost, 1)))
        });
        self.row(tr!("Missing replies"), lost.collect());
        self.rows.rotate_right(1);
        let is_notable = |rate: &Option<SetpointRate>| rate.is_none_or(|rate| rate.lost > LOST_MAX);
        if rates.iter().any(is_notable) {
            self.says(tr!(
                "Replies are missing: lost on the line, or asked for too late. The figures follow from those that came."
            ));
            self.meaning.rotate_right(1);
        }
    }

    fn estimate(&mut self, name: &'static str, found: Option<Estimate>, factor: f64, unit: &str) {
        self.row(name, vec![Some(estimate(found, factor, unit))]);
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

/// `1.0020 ± 0.0040 g·m²`: the interval has two digits, as the GUM advises (7.2.6). A figure whose interval tells no more
/// than the order of magnitude is not measurable.
fn estimate(found: Option<Estimate>, factor: f64, unit: &str) -> String {
    let Some(found) = found.filter(|it| it.is_measurable()) else {
        return tr!("not measurable").to_owned();
    };
    let plus_minus = found.plus_minus * factor;
    let (mut decimals, mut digits) = (0, plus_minus);
    while digits < 9.95 && decimals < 6 {
        digits *= 10.0;
        decimals += 1;
    }
    let value = number(found.value * factor, decimals);
    let text = format!("{value} ± {} {unit}", number(plus_minus, decimals));
    text.trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use motorlink_messages::experiments::study::FrequencyFindings;

    use super::*;

    #[test]
    fn a_figure_has_its_interval_and_no_sign_at_zero() {
        let text = |value, plus_minus, factor, unit| {
            estimate(Some(Estimate { value, plus_minus }), factor, unit)
        };
        let found = text(1.002e-3, 4e-6, 1e3, "g·m²");
        assert_eq!(found, "1.0020 ± 0.0040 g·m²");
        let found = text(1.002e-3, 4e-6, 1e6, "mg·m²");
        assert_eq!(found, "1002.0 ± 4.0 mg·m²");
        // An interval that contains zero.
        let found = text(0.006e-3, 0.103e-3, 1e3, "mA/rpm");
        assert_eq!(found, "not measurable");
        assert_eq!(estimate(None, 1e3, "mA/rpm"), "not measurable");
        assert_eq!(number(-0.001, 1), "0.0");
        assert_eq!(number(-1.25, 1), "\u{2212}1.2");
    }

    #[test]
    fn a_run_with_missing_replies_does_not_look_like_a_good_one() {
        let rate = |lost| {
            let achieved_hz = 50.0;
            Some(SetpointRate { achieved_hz, lost })
        };
        let mut good = Figures::default();
        good.add_missing(&[rate(0.0)]);
        assert_eq!(
            (good.rows[0].values[0].as_str(), good.meaning.len()),
            ("0.0 %", 0)
        );
        let mut figures = Figures::default();
        figures.row("of two motors", vec![None, None]);
        figures.add_missing(&[rate(0.0), rate(0.125)]);
        assert_eq!(figures.rows[0].values, ["0.0 %", "12.5 %"]);
        assert_eq!(figures.meaning.len(), 1);
        // A motor that hardly answered does not get the figure of the next one.
        let mut silent = Figures::default();
        silent.row("of two motors", vec![None, None]);
        silent.add_missing(&[None, rate(0.0)]);
        assert_eq!(silent.rows[0].values, [UNKNOWN, "0.0 %"]);
        assert_eq!(silent.meaning.len(), 1);
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
}
