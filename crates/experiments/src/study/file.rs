//! A study as JSON, so that a kept run can be evaluated again.

use motorlink_protocol::{Acceleration, MotorId};
use nojson::{DisplayJson, JsonFormatter, RawJson, json};

use super::{Study, StudyKind};
use crate::sequence::{
    Problem, Sequence, SequenceError,
    fields::{Node, Object, Result},
};

/// The version of the file format that this program reads and writes.
const VERSION: f64 = 1.0;
/// Maximal number of accelerations that are read.
const ACCELERATIONS_MAX: usize = 16;

impl DisplayJson for Study {
    fn fmt(&self, f: &mut JsonFormatter<'_, '_>) -> std::fmt::Result {
        f.object(|f| {
            f.member("motorlink_study", VERSION)?;
            f.member("kind", self.kind().field())?;
            if let Some(motor) = self.motor() {
                f.member("motor", motor.get())?;
            }
            for parameter in self.clone().parameters() {
                f.member(parameter.name, parameter.value())?;
            }
            match self {
                Self::Sequence(sequence) => f.member("sequence", sequence),
                Self::Step(study) => {
                    let bytes = study.accelerations.iter().map(|it| it.byte());
                    f.member("accelerations", bytes.collect::<Vec<u8>>())
                }
                _ => Ok(()),
            }
        })
    }
}

impl Study {
    /// The study as a file. [`Study::from_json`] reads the same study from it.
    #[must_use]
    pub fn to_json(&self) -> String {
        json(|f| f.value(self)).to_string()
    }

    /// Reads a whole file, or refuses it. [`Study::check`] checks the ranges.
    ///
    /// # Errors
    /// [`SequenceError`] names the place that does not fit.
    pub fn from_json(text: &str) -> Result<Self> {
        let raw = RawJson::parse(text)
            .map_err(|_| SequenceError::at("", Problem::NotJson { line: 1, column: 1 }))?;
        let mut file = Object::of(&Node::root(raw.value()), "an object in braces")?;
        match file.take("motorlink_study").map(|node| node.number()) {
            Some(Ok(found)) if (found - VERSION).abs() < f64::EPSILON => {}
            Some(Ok(found)) if found > VERSION => {
                return Err(file.wrong("motorlink_study", Problem::NewerVersion));
            }
            _ => {
                let problem = Problem::Expected("the number 1");
                return Err(file.wrong("motorlink_study", problem));
            }
        }
        let kind = file.need("kind")?;
        let name = kind.text(64)?;
        let Some(of) = StudyKind::ALL.iter().find(|it| it.field() == name) else {
            return Err(kind.wrong(Problem::Expected("the name of a study")));
        };
        if *of == StudyKind::Sequence {
            let sequence = file.need("sequence")?;
            file.end()?;
            return Sequence::from_json(sequence.value.as_raw_str()).map(Self::Sequence);
        }
        let node = file.need("motor")?;
        let motor = u8::try_from(node.whole(254.0)?).unwrap_or_default();
        let motor = MotorId::new(motor)
            .map_err(|_| node.wrong(Problem::Expected("a motor from 1 to 254")))?;
        let mut study = Self::of(*of, motor);
        for mut parameter in study.parameters() {
            let value = file.need(parameter.name)?.number()?;
            parameter.set(value);
        }
        if let Self::Step(step) = &mut study {
            step.accelerations = accelerations(&file.need("accelerations")?)?;
        }
        file.end()?;
        Ok(study)
    }
}

fn accelerations(node: &Node<'_>) -> Result<Vec<Acceleration>> {
    let list = || node.wrong(Problem::Expected("a list of accelerations"));
    let items = node.value.to_array().map_err(|_| list())?;
    let mut read = Vec::new();
    for value in items.take(ACCELERATIONS_MAX) {
        let item = Node {
            place: node.place.clone(),
            value,
        };
        let byte = u8::try_from(item.whole(255.0)?).unwrap_or_default();
        read.push(Acceleration::new(byte));
    }
    Ok(read)
}
