//! Writes a sequence as JSON that a user can edit: one field per line.

use nojson::{DisplayJson, JsonFormatter, JsonObjectFormatter, json};

use super::{Action, Condition, End, Move, Repeat, RunLimits, Selection, Sequence, Shape, Step};

type Fields<'a, 'b, 'c> = JsonObjectFormatter<'a, 'b, 'c>;

impl Sequence {
    /// The sequence as a file. [`Sequence::from_json`] reads the same sequence from it.
    #[must_use]
    pub fn to_json(&self) -> String {
        let text = json(|f| {
            f.set_indent_size(2);
            f.set_spacing(true);
            f.value(self)
        });
        format!("{text}\n")
    }
}

impl DisplayJson for Sequence {
    fn fmt(&self, f: &mut JsonFormatter<'_, '_>) -> std::fmt::Result {
        f.object(|f| {
            f.member("motorlink_sequence", super::VERSION)?;
            f.member("name", &self.name)?;
            f.member("limits", self.limits)?;
            f.member("steps", &self.steps)
        })
    }
}

impl DisplayJson for RunLimits {
    fn fmt(&self, f: &mut JsonFormatter<'_, '_>) -> std::fmt::Result {
        let limits = [
            ("rpm", self.rpm),
            ("amps", self.amps),
            ("celsius", self.celsius),
        ];
        f.object(|f| {
            let set = limits
                .into_iter()
                .filter_map(|(name, it)| Some((name, it?)));
            for (name, limit) in set {
                f.member(name, limit)?;
            }
            Ok(())
        })
    }
}

impl DisplayJson for Step {
    fn fmt(&self, f: &mut JsonFormatter<'_, '_>) -> std::fmt::Result {
        match self {
            Self::Move(step) => f.object(|f| step.write(f)),
            Self::Repeat(repeat) => f.object(|f| repeat.write(f)),
        }
    }
}

impl Move {
    fn write(&self, f: &mut Fields<'_, '_, '_>) -> std::fmt::Result {
        match &self.selection {
            Selection::All => {}
            Selection::Motor(id) => f.member("motor", id.get())?,
            Selection::Group(name) => f.member("group", name)?,
        }
        match self.action {
            Action::Brake => f.member("brake", true)?,
            Action::Follow {
                quantity,
                shape,
                acceleration,
            } => {
                shape.write(quantity.field(), f)?;
                if acceleration.byte() != 0 {
                    f.member("acceleration", acceleration.byte())?;
                }
            }
        }
        match self.end {
            End::After(seconds) => f.member("for_s", seconds),
            End::Until {
                condition,
                within_s,
            } => {
                f.member("until", condition)?;
                f.member("within_s", within_s)
            }
        }
    }
}

impl Shape {
    fn write(self, field: &str, f: &mut Fields<'_, '_, '_>) -> std::fmt::Result {
        let (value, wave, to_hz) = match self {
            Self::Step { to } => return f.member(field, to),
            Self::Ramp { to } => (to, None, None),
            Self::Sine(wave) | Self::Triangle(wave) => (wave.centre, Some(wave), None),
            Self::Chirp { wave, to_hz } => (wave.centre, Some(wave), Some(to_hz)),
        };
        f.member("shape", self.name())?;
        f.member(field, value)?;
        if let Some(wave) = wave {
            f.member("amplitude", wave.amplitude)?;
            f.member("hz", wave.hz)?;
        }
        match to_hz {
            Some(to_hz) => f.member("to_hz", to_hz),
            None => Ok(()),
        }
    }
}

impl Repeat {
    fn write(&self, f: &mut Fields<'_, '_, '_>) -> std::fmt::Result {
        f.member("repeat", self.passes)?;
        if let Some(until) = self.until {
            f.member("until", until)?;
        }
        f.member("steps", &self.steps)
    }
}

impl DisplayJson for Condition {
    fn fmt(&self, f: &mut JsonFormatter<'_, '_>) -> std::fmt::Result {
        f.object(|f| match *self {
            Self::RpmAbove(value) => f.member("rpm_above", value),
            Self::RpmBelow(value) => f.member("rpm_below", value),
            Self::CelsiusAbove(value) => f.member("celsius_above", value),
            Self::CelsiusBelow(value) => f.member("celsius_below", value),
            Self::DegreesNear { degrees, tolerance } => {
                f.member("degrees", degrees)?;
                f.member("tolerance", tolerance)
            }
        })
    }
}
