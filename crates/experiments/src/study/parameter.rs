//! A parameter of a study: its name, its value and its range.

use crate::sequence::{Problem, SequenceError};

/// A parameter that the user sets.
#[derive(Debug)]
pub struct Parameter<'a> {
    /// Its name in a file, with its unit at the end, such as `from_rpm`.
    pub name: &'static str,
    /// Least and greatest value. The fleet bounds a speed in addition.
    pub range: (f64, f64),
    value: Value<'a>,
}

#[derive(Debug)]
enum Value<'a> {
    Real(&'a mut f64),
    Whole(&'a mut u32),
}

impl<'a> Parameter<'a> {
    pub(super) const fn real(name: &'static str, value: &'a mut f64, min: f64, max: f64) -> Self {
        Self {
            name,
            range: (min, max),
            value: Value::Real(value),
        }
    }

    pub(super) fn whole(name: &'static str, value: &'a mut u32, min: u32, max: u32) -> Self {
        Self {
            name,
            range: (min.into(), max.into()),
            value: Value::Whole(value),
        }
    }

    /// Its value.
    #[must_use]
    pub fn value(&self) -> f64 {
        match &self.value {
            Value::Real(value) => **value,
            Value::Whole(value) => f64::from(**value),
        }
    }

    /// Whether it has no fraction.
    #[must_use]
    pub const fn is_whole(&self) -> bool {
        matches!(self.value, Value::Whole(_))
    }

    /// Another value. A fraction of a whole parameter is rounded.
    pub fn set(&mut self, to: f64) {
        match &mut self.value {
            Value::Real(value) => **value = to,
            Value::Whole(value) => **value = crate::number::whole(to),
        }
    }

    pub(super) fn check(&self, rpm_max: f64) -> Result<(), SequenceError> {
        let (mut min, mut max) = self.range;
        if self.name.ends_with("_rpm") {
            min = min.max(-rpm_max);
            max = max.min(rpm_max);
        }
        let value = self.value();
        if value >= min && value <= max {
            return Ok(());
        }
        let problem = if value > max {
            Problem::Above { value, max }
        } else {
            Problem::Below { value, min }
        };
        Err(SequenceError::at(self.name, problem))
    }
}
