//! What is asked, from a file or from parameters.

use std::{fs, path::Path};

use motorlink_experiments::{
    sequence::{Sequence, SequenceError, from_csv},
    study::{Study, StudyKind},
};
use motorlink_protocol::{Acceleration, MotorId};

use crate::{failure::Failure, parsers::Assignment};

/// What the command line asks.
#[derive(Clone, Copy, Debug)]
pub enum Asked<'a> {
    /// A file with a sequence or a study.
    File(&'a Path),
    /// A study with these parameters.
    Study(StudyKind, &'a [Assignment]),
}

/// What is asked, before its motor is known.
#[derive(Debug)]
pub enum StudyOf<'a> {
    /// A sequence, or a study of a file, which names its motors.
    Whole(Study),
    /// A study of the motor of the line.
    Parameters(StudyKind, &'a [Assignment]),
}

impl<'a> Asked<'a> {
    /// Reads the file, if there is one.
    ///
    /// # Errors
    /// The file cannot be read, or a parameter does not exist.
    pub fn read(self) -> Result<StudyOf<'a>, Failure> {
        match self {
            Self::Study(kind, set) => {
                let asked = StudyOf::Parameters(kind, set);
                // Wrong names are known before a port is opened.
                asked.on(MotorId::FIRST)?;
                Ok(asked)
            }
            Self::File(path) => {
                let text = fs::read_to_string(path).map_err(Failure::file(path))?;
                let is_csv = path
                    .extension()
                    .is_some_and(|end| end.eq_ignore_ascii_case("csv"));
                let study = if is_csv {
                    from_csv(&text, &[]).map(Study::Sequence)
                } else {
                    file_study(&text)
                };
                let study = study
                    .map_err(|error| Failure::Usage(format!("{}: {error}", path.display())))?;
                Ok(StudyOf::Whole(study))
            }
        }
    }
}

impl StudyOf<'_> {
    /// The study of this motor.
    ///
    /// # Errors
    /// A parameter does not exist. Ranges are checked with the motors of the line.
    pub fn on(&self, motor: MotorId) -> Result<Study, Failure> {
        match self {
            Self::Whole(study) => Ok(study.clone()),
            Self::Parameters(kind, set) => {
                let mut study = Study::of(*kind, motor);
                for (name, values) in *set {
                    assign(&mut study, name, values).map_err(Failure::Usage)?;
                }
                Ok(study)
            }
        }
    }
}

/// The study of a file: a sequence or a study, as JSON.
///
/// # Errors
/// [`SequenceError`] names the place that does not fit.
pub fn file_study(text: &str) -> Result<Study, SequenceError> {
    if text.contains("\"motorlink_study\"") {
        Study::from_json(text)
    } else {
        Sequence::from_json(text).map(Study::Sequence)
    }
}

/// Sets a parameter of a study.
///
/// # Errors
/// It does not exist, or takes one number.
pub fn assign(study: &mut Study, name: &str, values: &[f64]) -> Result<(), String> {
    if let (Study::Step(step), "accelerations") = (&mut *study, name) {
        let bytes = values.iter().map(|value| {
            let byte = Some(*value).filter(|value| (0.0..=255.0).contains(value));
            let byte = byte.ok_or("accelerations: expected 0 to 255")?;
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "it is within 0 to 255"
            )]
            Ok::<_, String>(Acceleration::new(byte as u8))
        });
        step.accelerations = bytes.collect::<Result<_, _>>()?;
        return Ok(());
    }
    let mut parameters = study.parameters();
    let names: Vec<_> = parameters.iter().map(|parameter| parameter.name).collect();
    let Some(parameter) = parameters
        .iter_mut()
        .find(|parameter| parameter.name == name)
    else {
        return Err(format!("{name}: expected one of {}", names.join(", ")));
    };
    match values {
        // It is neither below nor above a bound.
        [value] if value.is_nan() => return Err(format!("{name}: expected a number")),
        [value] => parameter.set(*value),
        _ => return Err(format!("{name}: expected one number")),
    }
    Ok(())
}
