//! The charts of findings.

use super::{AxisName, Chart, Line, Look, RUNS_MAX};
use crate::{
    analysis::{BodePoint, Point, Trace},
    sequence::Quantity,
    study::{Findings, FrequencyFindings, MotorFindings, StepFindings, StepGroup},
};

/// Points of a median curve.
const MEDIAN_POINTS: u32 = 300;

/// The charts of one run. `name` gives the name of an acceleration.
#[must_use]
pub fn charts(findings: &Findings, acceleration: &dyn Fn(u8) -> String) -> Vec<Chart> {
    if let Findings::Step(found) = findings {
        return one(
            AxisName::Time,
            AxisName::Speed,
            step_lines(found, acceleration),
        );
    }
    let lines = |kind: usize| lines_of(findings, kind, 0, "", acceleration);
    kinds(findings)
        .iter()
        .enumerate()
        .flat_map(|(kind, (x, y))| one(*x, *y, lines(kind)))
        .collect()
}

/// Every repeat, the median of each acceleration over them, and the step itself.
fn step_lines(found: &StepFindings, acceleration: &dyn Fn(u8) -> String) -> Vec<Line> {
    let mut lines = Vec::new();
    for (colour, group) in found.groups.iter().enumerate() {
        lines.extend(group.repeats.iter().map(|repeat| Line {
            colour,
            look: Look::Faint,
            name: String::new(),
            points: pairs(&repeat.rpm),
        }));
    }
    let longest_s = lines
        .iter()
        .filter_map(|line| Some(line.points.last()?.0))
        .fold(0.0, f64::max);
    let medians = found.groups.iter().enumerate();
    lines.extend(medians.map(|(colour, group)| Line {
        colour,
        look: Look::Plain,
        name: acceleration(group.acceleration.byte()),
        points: median(group),
    }));
    for (colour, group) in found.groups.iter().enumerate() {
        if let Some(model) = group.model {
            let way = found.to_rpm - found.from_rpm;
            let at = |place: u32| {
                let t_s = longest_s * f64::from(place) / f64::from(MEDIAN_POINTS);
                (t_s, found.from_rpm + way * model.step(t_s))
            };
            lines.push(Line {
                colour,
                look: Look::Dotted,
                name: String::new(),
                points: (0..=MEDIAN_POINTS).map(at).collect(),
            });
        }
    }
    if longest_s > 0.0 {
        lines.push(Line {
            colour: RUNS_MAX,
            look: Look::Dashed,
            name: String::new(),
            points: vec![
                (0.0, found.from_rpm),
                (0.0, found.to_rpm),
                (longest_s, found.to_rpm),
            ],
        });
    }
    lines
}

/// The charts of up to eight runs over each other, each with its name. `acceleration` gives the name of one. Runs of another study than the first one are
/// left out.
#[must_use]
pub fn compared_charts(
    runs: &[(String, Findings)],
    acceleration: &dyn Fn(u8) -> String,
) -> Vec<Chart> {
    let Some((_, first)) = runs.first() else {
        return Vec::new();
    };
    let same =
        |findings: &Findings| std::mem::discriminant(findings) == std::mem::discriminant(first);
    let kinds = kinds(first);
    kinds
        .iter()
        .enumerate()
        .flat_map(|(kind, (x, y))| {
            let runs = runs.iter().take(RUNS_MAX).enumerate();
            let runs = runs.filter(|(_, (_, findings))| same(findings));
            let lines = runs.flat_map(|(colour, (name, findings))| {
                lines_of(findings, kind, colour, name, acceleration)
            });
            one(*x, *y, lines.collect())
        })
        .collect()
}

/// The axes of each chart of such findings.
const fn kinds(findings: &Findings) -> &'static [(AxisName, AxisName)] {
    match findings {
        Findings::Sequence(_) => &[
            (AxisName::Time, AxisName::Speed),
            (AxisName::Time, AxisName::Current),
        ],
        Findings::Step(_) | Findings::CoastDown(_) | Findings::Silence(_) => {
            &[(AxisName::Time, AxisName::Speed)]
        }
        Findings::Frequency(_) => &[
            (AxisName::Frequency, AxisName::Gain),
            (AxisName::Frequency, AxisName::Phase),
            (AxisName::Frequency, AxisName::RSquared),
        ],
        Findings::Friction(_) => &[(AxisName::Speed, AxisName::Current)],
        Findings::Heating(_) => &[(AxisName::Time, AxisName::Temperature)],
        Findings::TorqueSpeed(_) => &[(AxisName::Current, AxisName::Speed)],
    }
}

fn one(x: AxisName, y: AxisName, lines: Vec<Line>) -> Vec<Chart> {
    Chart::of(x, y, lines).into_iter().collect()
}

/// The lines of one chart of one run. The first has the name; of a sequence and of steps each has, with its motor or its
/// acceleration.
fn lines_of(
    findings: &Findings,
    kind: usize,
    colour: usize,
    name: &str,
    acceleration: &dyn Fn(u8) -> String,
) -> Vec<Line> {
    let line = |look, points| Line {
        colour,
        look,
        name: String::new(),
        points,
    };
    let mut lines: Vec<Line> = match findings {
        Findings::Sequence(motors) => return sequence_lines(motors, kind, colour, name),
        Findings::Step(found) => {
            let groups = found.groups.iter();
            groups
                .map(|group| Line {
                    name: format!("{name}, {}", acceleration(group.acceleration.byte())),
                    ..line(Look::Plain, median(group))
                })
                .collect()
        }
        Findings::Frequency(found) => {
            let measured = bode(&found.points, kind).map(|(look, points)| line(look, points));
            // Over each other, models would hide the points.
            let model = modelled(found, kind).filter(|_| name.is_empty());
            let model = model.map(|points| line(Look::Dotted, points));
            measured.chain(model).collect()
        }
        Findings::Friction(found) => {
            let levels = found.levels.iter().map(|level| (level.rpm, level.amps));
            let mut lines = vec![line(Look::Dots, levels.collect())];
            if let Some(fit) = found.friction {
                let fastest = found.levels.iter().map(|level| level.rpm.abs());
                let fastest = fastest.fold(0.0, f64::max);
                let (coulomb, viscous) = (fit.coulomb_a.value, fit.viscous_a_per_rpm.value);
                for side in [1.0, -1.0] {
                    let end = side * (coulomb + viscous * fastest);
                    let points = vec![(0.0, side * coulomb), (side * fastest, end)];
                    lines.push(line(Look::Plain, points));
                }
            }
            lines
        }
        Findings::CoastDown(found) => {
            let coasts = found.coasts.iter();
            coasts
                .map(|coast| line(Look::Plain, pairs(coast)))
                .collect()
        }
        Findings::Silence(found) => {
            let [asked, unasked] = &found.curves;
            vec![
                line(Look::Plain, pairs(asked)),
                line(Look::Dots, pairs(asked)),
                line(Look::Dots, pairs(unasked)),
            ]
        }
        Findings::Heating(found) => {
            let mut lines = vec![line(Look::Dots, pairs(&found.celsius))];
            if let (Some(fit), Some(first), Some(last)) =
                (found.heating, found.celsius.first(), found.celsius.last())
            {
                let model = |place: u32| {
                    let part = f64::from(place) / f64::from(MEDIAN_POINTS);
                    let t_s = first.t_s + (last.t_s - first.t_s) * part;
                    let decay = (-(t_s - first.t_s) / fit.time_constant_s.value).exp();
                    (t_s, fit.final_c.value - fit.rise_k.value * decay)
                };
                lines.push(line(Look::Plain, (0..=MEDIAN_POINTS).map(model).collect()));
            }
            lines
        }
        Findings::TorqueSpeed(found) => {
            let mut lines = vec![line(Look::Dots, found.points.clone())];
            if let Some(droop) = found.line.and_then(|line| line.droop) {
                let speeds = || found.points.iter().map(|point| point.1);
                let fastest = speeds().fold(0.0, f64::max);
                let slowest = speeds().fold(fastest, f64::min);
                let at = |place: u32| {
                    let part = f64::from(place) / f64::from(MEDIAN_POINTS);
                    let rpm = fastest - (fastest - slowest) * part;
                    (droop.current.amps_at(rpm), rpm)
                };
                lines.push(line(Look::Plain, (0..=MEDIAN_POINTS).map(at).collect()));
            }
            lines
        }
    };
    if let Some(first) = lines.first_mut().filter(|line| line.name.is_empty()) {
        name.clone_into(&mut first.name);
    }
    lines
}

/// The model over the measured frequencies. The last chart has none.
fn modelled(found: &FrequencyFindings, kind: usize) -> Option<Vec<(f64, f64)>> {
    let model = found.model.filter(|_| kind < 2)?;
    let (first, last) = (found.points.first()?.hz, found.points.last()?.hz);
    let at = |place: u32| {
        let part = f64::from(place) / f64::from(MEDIAN_POINTS);
        let hz = first * (last / first).powf(part);
        let (gain_db, phase_deg) = model.response(hz);
        (hz, if kind == 0 { gain_db } else { phase_deg })
    };
    Some((0..=MEDIAN_POINTS).map(at).collect())
}

/// Lines between neighbouring valid points, and crosses at the others: an invalid point is not bridged, nor is a phase
/// whose turn is unknown.
fn bode(points: &[BodePoint], kind: usize) -> impl Iterator<Item = (Look, Vec<(f64, f64)>)> {
    let value = move |point: &BodePoint| match kind {
        0 => point.gain_db,
        1 => point.phase_deg,
        _ => point.r_squared,
    };
    let is_off =
        move |point: &BodePoint| point.invalid.is_some() || kind == 1 && !point.turn_is_known;
    let stretches: Vec<Vec<(f64, f64)>> = points
        .split(is_off)
        .map(|stretch| {
            stretch
                .iter()
                .map(|point| (point.hz, value(point)))
                .collect()
        })
        .filter(|stretch: &Vec<_>| !stretch.is_empty())
        .collect();
    let dots: Vec<(f64, f64)> = stretches.iter().flatten().copied().collect();
    let invalid = points.iter().filter(|point| is_off(point));
    let crosses: Vec<(f64, f64)> = invalid
        .map(|point| (point.hz, value(point)))
        .filter(|(_, value)| value.is_finite())
        .collect();
    let lines = stretches.into_iter().map(|line| (Look::Plain, line));
    lines.chain([(Look::Dots, dots), (Look::Crosses, crosses)])
}

/// The setpoint and the signal of each motor.
fn sequence_lines(motors: &[MotorFindings], kind: usize, colour: usize, name: &str) -> Vec<Line> {
    let (signal, quantity): (fn(&Trace) -> &[Point], _) = match kind {
        0 => (|trace| &trace.rpm, Quantity::Rpm),
        _ => (|trace| &trace.amps, Quantity::Amps),
    };
    let mut lines = Vec::new();
    for (place, found) in motors.iter().enumerate() {
        let (id, trace) = (found.motor, &found.trace);
        if found.tracking.is_some_and(|it| it.quantity == quantity) {
            lines.push(Line {
                colour: (colour + place) % RUNS_MAX,
                look: Look::Dashed,
                name: String::new(),
                points: held(&trace.command, signal(trace)),
            });
        }
        lines.push(Line {
            colour: (colour + place) % RUNS_MAX,
            look: Look::Plain,
            name: if name.is_empty() {
                id.to_string()
            } else {
                format!("{name} ({id})")
            },
            points: pairs(signal(trace)),
        });
    }
    lines
}

/// Setpoints, each kept until the next one, up to the last reply.
fn held(command: &[Point], replies: &[Point]) -> Vec<(f64, f64)> {
    let starts = command.iter().skip(1).map(|next| next.t_s);
    let ends = starts.chain(replies.last().map(|last| last.t_s));
    let stretches = command.iter().zip(ends);
    stretches
        .flat_map(|(point, end_s)| [(point.t_s, point.value), (end_s, point.value)])
        .collect()
}

fn pairs(points: &[Point]) -> Vec<(f64, f64)> {
    points
        .iter()
        .map(|point| (point.t_s, point.value))
        .collect()
}

/// The median of the repeats at even times, up to the end of the shortest one.
fn median(group: &StepGroup) -> Vec<(f64, f64)> {
    let ends = group.repeats.iter();
    let ends = ends.filter_map(|repeat| Some(repeat.rpm.last()?.t_s));
    let shortest_s = ends.fold(f64::INFINITY, f64::min);
    if !shortest_s.is_finite() {
        return Vec::new();
    }
    let at = |place: u32| {
        let t_s = shortest_s * f64::from(place) / f64::from(MEDIAN_POINTS);
        let values = group.repeats.iter().filter_map(|repeat| {
            let behind = repeat.rpm.partition_point(|point| point.t_s <= t_s);
            let point = repeat.rpm.get(behind.saturating_sub(1))?;
            Some(point.value)
        });
        Some((t_s, crate::analysis::spread(values)?.median))
    };
    (0..=MEDIAN_POINTS).filter_map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::Invalid;

    #[test]
    fn an_invalid_point_is_a_cross_and_no_line_bridges_it() {
        let point = |hz: f64, invalid| BodePoint {
            hz,
            gain_db: -hz,
            phase_deg: 0.0,
            turn_is_known: true,
            r_squared: 1.0,
            from_s: 0.0,
            to_s: 1.0,
            invalid,
        };
        let points = [
            point(1.0, None),
            point(2.0, None),
            point(3.0, Some(Invalid::Saturated)),
            point(4.0, None),
        ];
        let lines: Vec<_> = bode(&points, 0).collect();
        assert_eq!(
            lines,
            [
                (Look::Plain, vec![(1.0, -1.0), (2.0, -2.0)]),
                (Look::Plain, vec![(4.0, -4.0)]),
                (Look::Dots, vec![(1.0, -1.0), (2.0, -2.0), (4.0, -4.0)]),
                (Look::Crosses, vec![(3.0, -3.0)]),
            ]
        );
    }
}
