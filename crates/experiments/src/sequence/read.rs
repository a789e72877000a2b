//! Reads a sequence from JSON and checks its types. The plan checks its ranges.

use motorlink_protocol::{Acceleration, MotorId};
use nojson::{JsonValueKind, RawJson};

use super::{
    Action, Condition, DEPTH_MAX, End, Move, NAME_MAX, Problem, Quantity, Repeat, RunLimits,
    STEPS_MAX, Selection, Sequence, SequenceError, Shape, Step, VERSION, Wave,
    fields::{Node, Object, Result},
};

/// Maximal bytes of a file: ten times the size of a full table.
const BYTES_MAX: usize = 1000 * STEPS_MAX;
impl Sequence {
    /// Reads a whole file, or refuses it.
    ///
    /// # Errors
    /// [`SequenceError`] names the place that does not fit.
    pub fn from_json(text: &str) -> Result<Self> {
        if text.len() > BYTES_MAX {
            return Err(SequenceError::at("", Problem::TooLarge));
        }
        let json = RawJson::parse(text).map_err(|error| not_json(text, &error))?;
        let mut file = Object::of(&Node::root(json.value()), "an object in braces")?;
        // Checked first, because another version can have other fields.
        match file.take("motorlink_sequence").map(|node| node.number()) {
            Some(Ok(found)) if (found - VERSION).abs() < f64::EPSILON => {}
            Some(Ok(found)) if found > VERSION => {
                return Err(SequenceError::at(
                    "motorlink_sequence",
                    Problem::NewerVersion,
                ));
            }
            _ => {
                return Err(SequenceError::at("motorlink_sequence", Problem::NoVersion));
            }
        }
        let name = file.take("name").map(|node| node.text(NAME_MAX));
        let limits = file.take("limits").as_ref().map(limits);
        let list = file.need("steps")?;
        file.end()?;
        let mut count = 0;
        Ok(Self {
            name: name.transpose()?.unwrap_or_default(),
            limits: limits.transpose()?.unwrap_or_default(),
            steps: steps(&list, 0, &mut count)?,
        })
    }
}

fn limits(node: &Node) -> Result<RunLimits> {
    let mut fields = Object::of(node, "limits in braces")?;
    let mut limit = |name| fields.take(name).map(|node| node.number()).transpose();
    let limits = RunLimits {
        rpm: limit("rpm")?,
        amps: limit("amps")?,
        celsius: limit("celsius")?,
    };
    fields.end()?;
    Ok(limits)
}

fn steps(list: &Node, depth: usize, count: &mut usize) -> Result<Vec<Step>> {
    let items = list.value.to_array();
    let items = items.map_err(|_| list.wrong(Problem::Expected("a list of steps")))?;
    let mut read = Vec::new();
    for (place, value) in items.enumerate() {
        *count += 1;
        if *count > STEPS_MAX {
            return Err(list.wrong(Problem::TooManySteps { max: STEPS_MAX }));
        }
        let node = Node {
            place: format!("{}[{place}]", list.place),
            value,
        };
        read.push(step(&node, depth, count)?);
    }
    Ok(read)
}

fn step(node: &Node, depth: usize, count: &mut usize) -> Result<Step> {
    let mut fields = Object::of(node, "a step in braces")?;
    if fields.has("repeat") || fields.has("steps") {
        return repeat(fields, depth, count).map(Step::Repeat);
    }
    let selection = selection(&mut fields)?;
    let action = action(&mut fields)?;
    let end = end(&mut fields)?;
    fields.end()?;
    Ok(Step::Move(Move {
        selection,
        action,
        end,
    }))
}

fn repeat(mut fields: Object, depth: usize, count: &mut usize) -> Result<Repeat> {
    let endless = fields.wrong("repeat", Problem::EndlessLoop);
    let passes = fields.take("repeat").ok_or_else(|| endless.clone())?;
    if matches!(passes.value.kind(), JsonValueKind::Null) {
        return Err(endless);
    }
    // The plan checks the maximum.
    let passes = passes.whole(f64::from(u32::MAX))?;
    let until = fields.take("until").as_ref().map(condition).transpose()?;
    let list = fields.need("steps")?;
    fields.end()?;
    if depth >= DEPTH_MAX {
        return Err(list.wrong(Problem::TooDeep { max: DEPTH_MAX }));
    }
    let steps = steps(&list, depth + 1, count)?;
    Ok(Repeat {
        passes,
        until,
        steps,
    })
}

fn selection(fields: &mut Object) -> Result<Selection> {
    match (fields.take("motor"), fields.take("group")) {
        (None, None) => Ok(Selection::All),
        (Some(node), None) => {
            let address = node.whole(255.0)?;
            let id = u8::try_from(address)
                .ok()
                .and_then(|id| MotorId::new(id).ok());
            let id = id.ok_or_else(|| node.wrong(Problem::Expected("an ID from 1 to 254")))?;
            Ok(Selection::Motor(id))
        }
        (None, Some(node)) => node.text(NAME_MAX).map(Selection::Group),
        (Some(_), Some(group)) => Err(group.wrong(Problem::NotWith("motor"))),
    }
}

fn action(fields: &mut Object) -> Result<Action> {
    if let Some(brake) = fields.take("brake") {
        return match brake.value.as_raw_str() {
            "true" => Ok(Action::Brake),
            _ => Err(brake.wrong(Problem::Expected("true, or no such field"))),
        };
    }
    let mut found = None;
    for quantity in Quantity::ALL {
        let Some(node) = fields.take(quantity.field()) else {
            continue;
        };
        if found.is_some() {
            return Err(node.wrong(Problem::NotWith("another setpoint")));
        }
        found = Some((quantity, node.number()?));
    }
    let Some((quantity, value)) = found else {
        return Err(fields.wrong("", Problem::Expected("one of rpm, amps, degrees, brake")));
    };
    let shape = shape(fields, value)?;
    let acceleration = match fields.take("acceleration") {
        None => Acceleration::DEFAULT,
        Some(node) if quantity != Quantity::Rpm => {
            return Err(node.wrong(Problem::NotWith("a setpoint other than rpm")));
        }
        Some(node) => {
            let byte = u8::try_from(node.whole(255.0)?).unwrap_or(u8::MAX);
            Acceleration::new(byte)
        }
    };
    Ok(Action::Follow {
        quantity,
        shape,
        acceleration,
    })
}

fn shape(fields: &mut Object, value: f64) -> Result<Shape> {
    let Some(node) = fields.take("shape") else {
        return Ok(Shape::Step { to: value });
    };
    let name = node.text(NAME_MAX)?;
    let mut wave = || -> Result<Wave> {
        Ok(Wave {
            centre: value,
            amplitude: fields.need("amplitude")?.number()?,
            hz: fields.need("hz")?.number()?,
        })
    };
    match name.as_str() {
        "step" => Ok(Shape::Step { to: value }),
        "ramp" => Ok(Shape::Ramp { to: value }),
        "sine" => wave().map(Shape::Sine),
        "triangle" => wave().map(Shape::Triangle),
        "chirp" => Ok(Shape::Chirp {
            wave: wave()?,
            to_hz: fields.need("to_hz")?.number()?,
        }),
        _ => Err(node.wrong(Problem::Expected("step, ramp, sine, triangle or chirp"))),
    }
}

fn end(fields: &mut Object) -> Result<End> {
    let time = fields.take("for_s");
    match (time, fields.take("until")) {
        (Some(time), None) => time.number().map(End::After),
        (None, Some(node)) => Ok(End::Until {
            condition: condition(&node)?,
            within_s: fields.need("within_s")?.number()?,
        }),
        (Some(time), Some(_)) => Err(time.wrong(Problem::NotWith("until"))),
        (None, None) => Err(fields.wrong("for_s", Problem::Missing)),
    }
}

fn condition(node: &Node) -> Result<Condition> {
    let one = node.wrong(Problem::Expected(
        "one of rpm_above, rpm_below, degrees, celsius_above, celsius_below",
    ));
    let mut fields = Object::of(node, "a condition in braces")?;
    let mut found = None;
    for (name, of) in CONDITIONS {
        if let Some(node) = fields.take(name) {
            let condition = of(node.number()?);
            if found.replace(condition).is_some() {
                return Err(node.wrong(Problem::NotWith("another condition")));
            }
        }
    }
    if let Some(node) = fields.take("degrees") {
        let near = Condition::DegreesNear {
            degrees: node.number()?,
            tolerance: fields.need("tolerance")?.number()?,
        };
        if found.replace(near).is_some() {
            return Err(node.wrong(Problem::NotWith("another condition")));
        }
    }
    fields.end()?;
    found.ok_or(one)
}

type OfNumber = fn(f64) -> Condition;
const CONDITIONS: [(&str, OfNumber); 4] = [
    ("rpm_above", Condition::RpmAbove),
    ("rpm_below", Condition::RpmBelow),
    ("celsius_above", Condition::CelsiusAbove),
    ("celsius_below", Condition::CelsiusBelow),
];

fn not_json(text: &str, error: &nojson::JsonParseError) -> SequenceError {
    let found = error.get_line_and_column_numbers(text);
    let (line, column) = found.map_or((1, 1), |(line, column)| (line.get(), column.get()));
    SequenceError::at("", Problem::NotJson { line, column })
}
