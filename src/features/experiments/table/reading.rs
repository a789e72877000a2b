//! From rows as they are typed to the steps of a sequence, and to the place of an error.

use motorlink_messages::{
    experiments::sequence::{
        Action, Condition, End, Move, Problem, Quantity, Repeat, RunLimits, Selection,
        SequenceError, Shape, Step, Wave,
    },
    protocol::{Acceleration, MotorId},
};

use super::{Column, Kind, Row};

impl Row {
    fn number(&self, column: Column, place: &str, field: &str) -> Result<f64, SequenceError> {
        let text = self.cell(column).replace(['\u{2212}', '–'], "-");
        let number: Option<f64> = text.replace(',', ".").parse().ok();
        number
            .filter(|number| number.is_finite())
            .ok_or_else(|| no_number(format!("{place}.{field}")))
    }

    fn condition(&self, place: &str) -> Result<Option<Condition>, SequenceError> {
        let name = self.cell(Column::Until);
        if name == "time" || name.is_empty() {
            return Ok(None);
        }
        let bound = self.number(Column::Bound, place, &format!("until.{name}"))?;
        Ok(Some(match name {
            "rpm_above" => Condition::RpmAbove(bound),
            "rpm_below" => Condition::RpmBelow(bound),
            "celsius_above" => Condition::CelsiusAbove(bound),
            "celsius_below" => Condition::CelsiusBelow(bound),
            _ => Condition::DegreesNear {
                degrees: bound,
                tolerance: self.number(Column::Tolerance, place, "until.tolerance")?,
            },
        }))
    }

    fn selection(&self) -> Selection {
        let text = self.cell(Column::Motors);
        if let Some(group) = text.strip_prefix("group ") {
            return Selection::Group(group.to_owned());
        }
        let id = text.parse::<u8>().ok().and_then(|id| MotorId::new(id).ok());
        id.map_or(Selection::All, Selection::Motor)
    }

    fn step(&self, place: &str) -> Result<Step, SequenceError> {
        let quantity = self.cell(Column::Quantity);
        let action = if quantity == "brake" {
            Action::Brake
        } else {
            let mut all = Quantity::ALL.into_iter();
            let known = all.find(|known| known.field() == quantity);
            let quantity = known.unwrap_or(Quantity::Rpm);
            Action::Follow {
                quantity,
                shape: self.shape(place, quantity.field())?,
                acceleration: self.acceleration(place)?,
            }
        };
        let end = match self.condition(place)? {
            None => End::After(self.number(Column::Seconds, place, "for_s")?),
            Some(condition) => End::Until {
                condition,
                within_s: self.number(Column::Seconds, place, "within_s")?,
            },
        };
        Ok(Step::Move(Move {
            selection: self.selection(),
            action,
            end,
        }))
    }

    fn shape(&self, place: &str, field: &str) -> Result<Shape, SequenceError> {
        let value = self.number(Column::Value, place, field)?;
        let wave = || {
            Ok(Wave {
                centre: value,
                amplitude: self.number(Column::Amplitude, place, "amplitude")?,
                hz: self.number(Column::Hz, place, "hz")?,
            })
        };
        Ok(match self.cell(Column::Shape) {
            "ramp" => Shape::Ramp { to: value },
            "sine" => Shape::Sine(wave()?),
            "triangle" => Shape::Triangle(wave()?),
            "chirp" => Shape::Chirp {
                wave: wave()?,
                to_hz: self.number(Column::ToHz, place, "to_hz")?,
            },
            _ => Shape::Step { to: value },
        })
    }

    fn acceleration(&self, place: &str) -> Result<Acceleration, SequenceError> {
        if !self.has(Column::Acceleration) || self.cell(Column::Acceleration).is_empty() {
            return Ok(Acceleration::DEFAULT);
        }
        let byte = self.cell(Column::Acceleration).parse::<u8>();
        byte.map(Acceleration::new).map_err(|_| SequenceError {
            place: format!("{place}.acceleration"),
            problem: Problem::Expected("a whole number from 0 to 255"),
        })
    }

    fn passes(&self, place: &str) -> Result<u32, SequenceError> {
        let passes = self.cell(Column::Passes).parse::<u32>();
        passes.map_err(|_| SequenceError {
            place: format!("{place}.repeat"),
            problem: Problem::EndlessLoop,
        })
    }
}

fn no_number(place: String) -> SequenceError {
    SequenceError {
        place,
        problem: Problem::Expected("a number"),
    }
}

/// The place of each row in the file, such as `steps[3].steps[1]`. The end of a repeat has that of its repeat.
pub(in crate::features::experiments) fn places(rows: &[Row]) -> Vec<String> {
    let mut open: Vec<(String, usize)> = vec![(String::new(), 0)];
    let mut places = Vec::with_capacity(rows.len());
    for row in rows {
        if row.kind == Kind::EndRepeat && open.len() > 1 {
            let closed = open.pop().map(|(place, _)| place);
            let place = closed.unwrap_or_default();
            places.push(place.trim_end_matches('.').to_owned());
            continue;
        }
        let Some((list, number)) = open.last_mut() else {
            break;
        };
        let place = format!("{list}steps[{number}]");
        *number += 1;
        if row.kind == Kind::Repeat {
            open.push((format!("{place}."), 0));
        }
        places.push(place);
    }
    places
}

/// The row and the column of an error.
pub(in crate::features::experiments) fn find(rows: &[Row], place: &str) -> Option<(usize, Column)> {
    let places = places(rows);
    let matches = |own: &str| {
        place
            .strip_prefix(own)
            .filter(|rest| rest.is_empty() || rest.starts_with('.'))
            .map(|rest| rest.trim_start_matches('.').to_owned())
    };
    let own = places.iter().enumerate();
    let found = own
        .filter_map(|(row, own)| Some((row, own.len(), matches(own)?)))
        // The first row with this place is the repeat, the other one its end.
        .rev()
        .max_by_key(|(_, length, _)| *length);
    let (row, _, field) = found?;
    let column = if rows.get(row)?.kind == Kind::Repeat && !field.starts_with("until") {
        Column::Passes
    } else {
        Column::of_field(&field)
    };
    Some((row, column))
}

/// The steps of the rows. A repeat without its end goes on to the last row.
pub(in crate::features::experiments) fn steps(rows: &[Row]) -> Result<Vec<Step>, SequenceError> {
    let places = places(rows);
    let mut open: Vec<(Vec<Step>, u32, Option<Condition>)> = Vec::new();
    let mut steps = Vec::new();
    let close = |steps: Vec<Step>, (before, passes, until)| {
        let mut list: Vec<Step> = before;
        list.push(Step::Repeat(Repeat {
            passes,
            until,
            steps,
        }));
        list
    };
    for (row, place) in rows.iter().zip(&places) {
        match row.kind {
            Kind::Move => steps.push(row.step(place)?),
            Kind::Repeat => {
                let (passes, until) = (row.passes(place)?, row.condition(place)?);
                open.push((std::mem::take(&mut steps), passes, until));
            }
            Kind::EndRepeat => {
                if let Some(repeat) = open.pop() {
                    steps = close(steps, repeat);
                }
            }
        }
    }
    while let Some(repeat) = open.pop() {
        steps = close(steps, repeat);
    }
    Ok(steps)
}

/// The limits of a run as they are typed: empty is none.
pub(in crate::features::experiments) fn limits(
    texts: &[String; 3],
) -> Result<RunLimits, SequenceError> {
    let limit = |text: &str, field: &str| {
        let text = text.trim().replace(',', ".");
        if text.is_empty() {
            return Ok(None);
        }
        let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
        number
            .map(Some)
            .ok_or_else(|| no_number(format!("limits.{field}")))
    };
    let [rpm, amps, celsius] = texts;
    Ok(RunLimits {
        rpm: limit(rpm, "rpm")?,
        amps: limit(amps, "amps")?,
        celsius: limit(celsius, "celsius")?,
    })
}
