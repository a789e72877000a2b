//! The values of a JSON file, each with its place for errors.

use nojson::RawJsonValue;

use super::{Problem, SequenceError};

/// Maximal characters of an unknown field that an error quotes.
const FIELD_SHOWN_MAX: usize = 32;

pub(crate) type Result<T> = std::result::Result<T, SequenceError>;

/// A value of the file, and its place.
pub(crate) struct Node<'a> {
    pub(crate) place: String,
    pub(crate) value: RawJsonValue<'a, 'a>,
}

impl<'a> Node<'a> {
    pub(crate) const fn root(value: RawJsonValue<'a, 'a>) -> Self {
        Self {
            place: String::new(),
            value,
        }
    }

    pub(crate) fn wrong(&self, problem: Problem) -> SequenceError {
        SequenceError::at(self.place.clone(), problem)
    }

    pub(crate) fn number(&self) -> Result<f64> {
        let number = self.value.as_number_str().ok();
        let number = number.and_then(|digits| digits.parse::<f64>().ok());
        // A number with too many digits is infinite, which is out of every range.
        let finite = number.filter(|value| value.is_finite());
        finite.ok_or_else(|| self.wrong(Problem::Expected("a number")))
    }

    pub(crate) fn whole(&self, max: f64) -> Result<u32> {
        let value = self.number()?;
        if value < 0.0 {
            return Err(self.wrong(Problem::Below { value, min: 0.0 }));
        }
        if value > max {
            return Err(self.wrong(Problem::Above { value, max }));
        }
        let is_whole = value.fract() == 0.0;
        let whole = is_whole.then(|| crate::number::whole(value));
        whole.ok_or_else(|| self.wrong(Problem::Expected("a whole number")))
    }

    pub(crate) fn text(&self, max: usize) -> Result<String> {
        let text = self.value.to_unquoted_string_str().ok();
        let fits = |text: &str| text.chars().count() <= max && !text.contains(char::is_control);
        let text = text.filter(|text| fits(text));
        text.map(std::borrow::Cow::into_owned)
            .ok_or_else(|| self.wrong(Problem::Expected("a text of at most 64 characters")))
    }
}

/// The fields of an object. All of them must be taken.
pub(crate) struct Object<'a> {
    place: String,
    fields: Vec<(String, RawJsonValue<'a, 'a>)>,
}

impl<'a> Object<'a> {
    pub(crate) fn of(node: &Node<'a>, expected: &'static str) -> Result<Self> {
        let members = node.value.to_object();
        let members = members.map_err(|_| node.wrong(Problem::Expected(expected)))?;
        let mut fields: Vec<(String, RawJsonValue)> = Vec::new();
        let object = |fields| Self {
            place: node.place.clone(),
            fields,
        };
        for (key, value) in members {
            let key = key.to_unquoted_string_str().unwrap_or_default();
            if fields.iter().any(|(name, _)| *name == key) {
                return Err(object(Vec::new()).wrong(&key, Problem::Twice));
            }
            fields.push((key.into_owned(), value));
        }
        Ok(object(fields))
    }

    pub(crate) fn wrong(&self, name: &str, problem: Problem) -> SequenceError {
        let shown = name.chars().filter(|character| !character.is_control());
        let shown: String = shown.take(FIELD_SHOWN_MAX).collect();
        let dot = if self.place.is_empty() || shown.is_empty() {
            ""
        } else {
            "."
        };
        SequenceError::at(format!("{}{dot}{shown}", self.place), problem)
    }

    pub(crate) fn has(&self, name: &str) -> bool {
        self.fields.iter().any(|(field, _)| field == name)
    }

    pub(crate) fn take(&mut self, name: &str) -> Option<Node<'a>> {
        let at = self.fields.iter().position(|(field, _)| field == name)?;
        let (_, value) = self.fields.swap_remove(at);
        let place = self.wrong(name, Problem::Missing).place;
        Some(Node { place, value })
    }

    pub(crate) fn need(&mut self, name: &str) -> Result<Node<'a>> {
        let missing = self.wrong(name, Problem::Missing);
        self.take(name).ok_or(missing)
    }

    /// Refuses remaining fields.
    pub(crate) fn end(self) -> Result<()> {
        match self.fields.first() {
            None => Ok(()),
            Some((name, _)) => Err(self.wrong(name, Problem::UnknownField)),
        }
    }
}
