//! The figures of a run as a table: one row per motor, step, or point of a Bode plot, with all parameters.

use nojson::{DisplayJson, JsonFormatter, array, object};

use super::RunHeader;
use crate::{
    analysis::{Estimate, FittedModel, Lag, WhenSilent},
    sequence::Quantity,
    study::{
        CoastDownFindings, Findings, FrequencyFindings, FrictionFindings, HeatingFindings,
        MotorFindings, SilenceFindings, StepFindings, Study, TorqueSpeedFindings,
    },
};

/// Figures are rounded to this part of their unit.
const DIGITS: f64 = 1e6;

/// A cell of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// A number; `None` if it is unknown.
    Number(Option<f64>),
    /// Yes or no.
    Flag(bool),
    /// A word; empty if it is unknown.
    Text(&'static str),
}

/// A row: cells with the names of their columns, which have the unit last.
pub type Row = Vec<(&'static str, Cell)>;

/// The table as CSV. Every row repeats the parameters, so that tables of several runs can be joined.
#[must_use]
pub fn figures_to_csv(header: &RunHeader, study: &Study, findings: &Findings) -> String {
    let parameters = parameters(header, study);
    let rows: Vec<Row> = figures(findings)
        .into_iter()
        .map(|row| parameters.iter().copied().chain(row).collect())
        .collect();
    let Some(first) = rows.first() else {
        return String::new();
    };
    let head: Vec<&str> = first.iter().map(|(name, _)| *name).collect();
    let mut lines = vec![format!("model,{}", head.join(","))];
    lines.extend(rows.iter().map(|row| {
        let cells: Vec<String> = row.iter().map(|(_, cell)| cell.text()).collect();
        format!("{},{}", header.model, cells.join(","))
    }));
    lines.join("\n") + "\n"
}

/// The table as JSON, with the study as [`Study::to_json`] writes it.
#[must_use]
pub fn figures_to_json(header: &RunHeader, study: &Study, findings: &Findings) -> String {
    let text = object(|f| {
        f.member("motorlink_figures", 1)?;
        f.member("model", &header.model)?;
        f.members(parameters(header, study))?;
        f.member("study", study)?;
        let rows = figures(findings).into_iter();
        let rows = rows.map(|row| object(move |f| f.members(row.iter().copied())));
        f.member("figures", array(|f| f.elements(rows.clone())))
    });
    format!("{text}\n")
}

fn parameters(header: &RunHeader, study: &Study) -> Row {
    let whole = |value: f64| Cell::Number(Some(value));
    let mut row = vec![
        ("run", whole(header.number.into())),
        ("began_unix_ms", whole(header.began_unix_ms)),
        ("request_hz", whole(header.request_hz)),
    ];
    // A sequence has a row for each of its motors.
    row.extend(study.motor().map(|id| ("motor", whole(id.get().into()))));
    let mut study = study.clone();
    let parameters = study.parameters();
    row.extend(parameters.iter().map(|one| (one.name, whole(one.value()))));
    row
}

/// The table: a row for each motor, step or frequency; one row for each other study.
#[must_use]
pub fn figures(findings: &Findings) -> Vec<Row> {
    match findings {
        Findings::Sequence(found) => found.iter().map(followed).collect(),
        Findings::Step(found) => steps(found),
        Findings::Frequency(found) => points(found),
        Findings::Friction(found) => vec![friction(found)],
        Findings::CoastDown(found) => vec![coast_down(found)],
        Findings::Heating(found) => vec![heating(found)],
        Findings::TorqueSpeed(found) => vec![torque_speed(found)],
        Findings::Silence(found) => vec![silence(found)],
    }
}

/// Estimates, each with half of its interval: the names of both, and the factor to their unit.
fn estimates<const N: usize>(all: [(&'static str, &'static str, Option<Estimate>, f64); N]) -> Row {
    let cells = all.into_iter().flat_map(|(name, interval, of, factor)| {
        let value = of.map(|of| of.value * factor);
        let half = of.map(|of| of.plus_minus * factor);
        [(name, Cell::Number(value)), (interval, Cell::Number(half))]
    });
    cells.collect()
}

fn friction(found: &FrictionFindings) -> Row {
    let fit = found.friction;
    let coulomb = fit.map(|it| it.coulomb_a);
    let viscous = fit.map(|it| it.viscous_a_per_rpm);
    estimates([
        ("coulomb_a", "coulomb_a_interval", coulomb, 1.0),
        (
            "viscous_ma_per_rpm",
            "viscous_ma_per_rpm_interval",
            viscous,
            1e3,
        ),
    ])
}

fn coast_down(found: &CoastDownFindings) -> Row {
    let (fit, coast) = (found.inertia, found.coast);
    let inertia = fit.map(|it| it.inertia_kg_m2);
    let dry = fit.map(|it| it.dry_nm);
    let viscous = fit.map(|it| it.viscous_nm_s);
    let slows = coast.map(|it| it.dry_rad_s2);
    estimates([
        ("inertia_g_m2", "inertia_g_m2_interval", inertia, 1e3),
        ("dry_friction_mn_m", "dry_friction_mn_m_interval", dry, 1e3),
        (
            "viscous_friction_mn_m_s",
            "viscous_friction_mn_m_s_interval",
            viscous,
            1e3,
        ),
        (
            "friction_over_inertia_rad_s2",
            "friction_over_inertia_rad_s2_interval",
            slows,
            1.0,
        ),
    ])
}

fn heating(found: &HeatingFindings) -> Row {
    let fit = found.heating;
    let constant = fit.map(|it| it.time_constant_s);
    let last = fit.map(|it| it.final_c);
    let mut row = estimates([
        ("time_constant_s", "time_constant_s_interval", constant, 1.0),
        ("final_c", "final_c_interval", last, 1.0),
    ]);
    row.push(("mean_a", Cell::Number(found.amps)));
    row
}

fn torque_speed(found: &TorqueSpeedFindings) -> Row {
    let no_load = found.line.map(|it| it.no_load_rpm);
    let droop = found.line.and_then(|it| it.droop);
    let droop = droop.map(|it| it.rpm_per_nm);
    estimates([
        ("no_load_rpm", "no_load_rpm_interval", no_load, 1.0),
        ("lost_rpm_per_n_m", "lost_rpm_per_n_m_interval", droop, 1.0),
    ])
}

fn silence(found: &SilenceFindings) -> Row {
    let result = found.result.map_or("", WhenSilent::key);
    let ((asked, asked_end), (unasked, unasked_end)) = (found.asked_rpm, found.unasked_rpm);
    vec![
        ("when_frames_cease", Cell::Text(result)),
        ("before_with_queries_rpm", Cell::Number(asked)),
        ("after_with_queries_rpm", Cell::Number(asked_end)),
        ("before_without_queries_rpm", Cell::Number(unasked)),
        ("after_without_queries_rpm", Cell::Number(unasked_end)),
    ]
}

fn followed(found: &MotorFindings) -> Row {
    let of = found.tracking;
    let unit = of.map_or("", |it| match it.quantity {
        Quantity::Rpm => "rpm",
        Quantity::Amps => "A",
        Quantity::Degrees => "deg",
    });
    vec![
        ("motor", Cell::Number(Some(found.motor.get().into()))),
        ("setpoint_unit", Cell::Text(unit)),
        ("replies", Cell::Number(of.map(|it| it.replies.into()))),
        ("rms_error", Cell::Number(of.map(|it| it.rms))),
        ("worst_error", Cell::Number(of.map(|it| it.worst))),
        ("worst_s", Cell::Number(of.map(|it| it.worst_s))),
    ]
}

fn steps(found: &StepFindings) -> Vec<Row> {
    let groups = found.groups.iter();
    let repeats = groups.flat_map(|group| {
        let repeats = group.repeats.iter().enumerate();
        repeats.map(|(place, repeat)| {
            let figures = repeat.figures;
            let place = u32::try_from(place).map_or(f64::NAN, f64::from);
            let acceleration = f64::from(group.acceleration.byte());
            let mut row = vec![
                ("acceleration", Cell::Number(Some(acceleration))),
                ("repeat", Cell::Number(Some(place + 1.0))),
                ("at_s", Cell::Number(Some(repeat.at_s))),
                ("to_s", Cell::Number(Some(repeat.to_s))),
                ("settled", Cell::Flag(figures.settled)),
                ("latency_s", Cell::Number(figures.latency_s)),
                ("rise_s", Cell::Number(figures.rise_s)),
                ("overshoot", Cell::Number(figures.overshoot)),
                ("undershoot", Cell::Number(figures.wrong_way)),
                ("settling_s", Cell::Number(figures.settling_s)),
                ("steady_error_rpm", Cell::Number(figures.steady_error)),
                ("peak_rpm", Cell::Number(figures.peak)),
                ("peak_s", Cell::Number(figures.peak_s)),
                ("peak_a", Cell::Number(figures.peak_amps)),
            ];
            row.extend(fitted(group.model));
            row
        })
    });
    repeats.collect()
}

fn points(found: &FrequencyFindings) -> Vec<Row> {
    let points = found.points.iter().map(|point| {
        let mut row = vec![
            ("bandwidth_hz", Cell::Number(found.bandwidth_hz)),
            ("hz", Cell::Number(Some(point.hz))),
            ("from_s", Cell::Number(Some(point.from_s))),
            ("to_s", Cell::Number(Some(point.to_s))),
            ("valid", Cell::Flag(point.invalid.is_none())),
            ("why", Cell::Text(point.invalid.map_or("", Into::into))),
            ("gain_db", Cell::Number(Some(point.gain_db))),
            ("phase_deg", Cell::Number(Some(point.phase_deg))),
            ("turn_is_known", Cell::Flag(point.turn_is_known)),
            ("r_squared", Cell::Number(Some(point.r_squared))),
        ];
        row.extend(fitted(found.model));
        row
    });
    points.collect()
}

/// The model, each value with half of its interval.
fn fitted(model: Option<FittedModel>) -> Row {
    let lag = model.map(|model| model.lag);
    let order = lag.map_or("", |lag| match lag {
        Lag::First { .. } => "first",
        Lag::Second { .. } => "second",
    });
    let (time_s, natural_hz, damping) = lag.map(Lag::parts).unwrap_or_default();
    let value = |of: Option<Estimate>| Cell::Number(of.map(|of| of.value));
    let interval = |of: Option<Estimate>| Cell::Number(of.map(|of| of.plus_minus));
    let gain = model.map(|model| model.gain);
    let dead_s = model.map(|model| model.dead_time_s);
    vec![
        ("fit_order", Cell::Text(order)),
        ("fit_gain", value(gain)),
        ("fit_gain_interval", interval(gain)),
        ("fit_dead_s", value(dead_s)),
        ("fit_dead_s_interval", interval(dead_s)),
        ("fit_time_s", value(time_s)),
        ("fit_time_s_interval", interval(time_s)),
        ("fit_natural_hz", value(natural_hz)),
        ("fit_natural_hz_interval", interval(natural_hz)),
        ("fit_damping", value(damping)),
        ("fit_damping_interval", interval(damping)),
        ("fit_rms", Cell::Number(model.map(|model| model.rms))),
    ]
}

impl Cell {
    /// A number that a file can hold.
    fn number(value: Option<f64>) -> Option<f64> {
        let value = value.filter(|value| value.is_finite())?;
        // No negative zero.
        Some((value * DIGITS).round() / DIGITS + 0.0)
    }

    /// Empty for what is unknown.
    #[must_use]
    pub fn text(self) -> String {
        match self {
            Self::Number(value) => {
                Self::number(value).map_or_else(String::new, |it| it.to_string())
            }
            Self::Flag(flag) => flag.to_string(),
            Self::Text(text) => text.to_owned(),
        }
    }
}

impl DisplayJson for Cell {
    fn fmt(&self, f: &mut JsonFormatter<'_, '_>) -> std::fmt::Result {
        match self {
            Self::Number(value) => f.value(Self::number(*value)),
            Self::Flag(flag) => f.value(flag),
            Self::Text(text) => f.value(text),
        }
    }
}
