//! A kept run as a JSON file, and back.
//!
//! Rows are arrays, because a run of minutes has tens of thousands. Times are microseconds since the start.

use std::fmt;

use motorlink_protocol::{Current, Instant, MotorId};
use nojson::{JsonFormatter, RawJson, RawJsonMember, RawJsonValue, array, object};

use super::{
    Outcome, RunHeader, outcome_names,
    setpoint::{of_parts, parts},
};
use crate::{
    plan::MOTORS_MAX,
    runner::{End, Mark, Record, RecordPart, Sample, SentSetpoint},
    study::Study,
};

/// The version of the file format that this program writes. Version 1, which it also reads, has study and setup as strings.
const VERSION: u32 = 2;

/// What the signs in a file mean.
const SIGNS: &str = "+ is forward: speed, current, setpoint and angle of a motor that is mounted mirrored are turned. \
    In a position run they are the motor's own.";

/// The end of the year 9999: what reads a date cannot fail on a later one.
const UNIX_MS_MAX: f64 = 253_402_300_799_000.0;
/// Maximal setpoints per second to a motor.
const HZ_MAX: f64 = 1_000.0;

/// Why a file is not a run.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("not a run of this version: {}", .place)]
pub struct JsonError {
    /// The field that does not fit.
    pub place: &'static str,
}

type Result<T> = std::result::Result<T, JsonError>;

/// The whole run as a file.
#[must_use]
pub fn run_to_json(header: &RunHeader, record: &Record) -> String {
    let began = header.began.unwrap_or(Instant::ZERO);
    let micros = |at: Instant| u64::try_from(at.since(began).as_micros()).unwrap_or(u64::MAX);
    let ended = match header.outcome {
        Outcome::Ended(End::Finished { at } | End::Aborted { at, .. }) => Some(micros(at)),
        _ => None,
    };
    let samples = record.samples().iter().map(|it| {
        array(move |f| {
            f.element(micros(it.at))?;
            f.element(it.id.get())?;
            f.element(it.rpm)?;
            f.element(it.current.map(Current::raw))?;
            f.element(it.degrees)?;
            f.element(it.celsius)
        })
    });
    let sent = record.sent_setpoints().iter().map(|it| {
        let (unit, value, acceleration) = parts(it.setpoint);
        array(move |f| {
            f.element(micros(it.at))?;
            f.element(it.id.get())?;
            f.element(unit)?;
            f.element(value)?;
            f.element(acceleration)
        })
    });
    let marks = record.marks().iter().map(|it| {
        array(move |f| {
            f.element(micros(it.at))?;
            f.element(it.step)
        })
    });
    let motors = header.motors.iter().map(|(id, name)| {
        array(move |f| {
            f.element(id.get())?;
            f.element(name)
        })
    });
    let text = object(|f| {
        f.member("motorlink_run", VERSION)?;
        f.member("number", header.number)?;
        f.member("name", &header.name)?;
        f.member("study", Inner(&header.study))?;
        f.member("motors", array(|f| f.elements(motors.clone())))?;
        f.member("model", &header.model)?;
        f.member("signs", SIGNS)?;
        f.member("setup", Inner(&header.setup))?;
        f.member("page_version", &header.page_version)?;
        f.member("began_unix_ms", header.began_unix_ms)?;
        f.member("is_started", header.began.is_some())?;
        f.member("request_hz", header.request_hz)?;
        f.member("outcome", outcome_names::name(header.outcome))?;
        f.member("why", header.outcome.cause().map(|cause| cause.to_string()))?;
        f.member("ended_us", ended)?;
        f.member("samples", array(|f| f.elements(samples.clone())))?;
        f.member("sent", array(|f| f.elements(sent.clone())))?;
        f.member("marks", array(|f| f.elements(marks.clone())))
    });
    format!("{text}\n")
}

/// A text that is a JSON object, as that object; another text as a string.
struct Inner<'a>(&'a str);

impl nojson::DisplayJson for Inner<'_> {
    fn fmt(&self, f: &mut JsonFormatter<'_, '_>) -> fmt::Result {
        match RawJson::parse(self.0) {
            Ok(raw) if raw.value().kind().is_object() => f.value(&raw),
            _ => f.value(self.0),
        }
    }
}

/// Reads such a file. A cause with details, such as a limit, is read without them: the file has them as text only.
///
/// # Errors
/// [`JsonError`] names the field that does not fit.
pub fn run_from_json(text: &str) -> Result<(RunHeader, Record)> {
    let raw = RawJson::parse(text).map_err(|_| JsonError { place: "JSON" })?;
    let file = raw.value();
    field(file, "motorlink_run", &|it| {
        rounded(it).filter(|version| (1..=VERSION).contains(version))
    })?;
    let motors = field(file, "motors", &|it| rows(it, &named_motor))?;
    let ended = field(file, "ended_us", &|it| optional(it, real).ok())?;
    let at = Instant::from_micros(micros(ended.unwrap_or_default()));
    let first = motors.first().map_or(MotorId::FIRST, |(id, _)| *id);
    let truth = |it: &RawJsonValue<'_, '_>| it.as_boolean_str().ok()?.parse::<bool>().ok();
    let header = RunHeader {
        outcome: field(file, "outcome", &|it| {
            outcome_names::read(&string(it)?, at, first)
        })?,
        number: field(file, "number", &rounded)?,
        name: field(file, "name", &string)?,
        study: field(file, "study", &inner)?,
        motors,
        model: field(file, "model", &string)?,
        setup: field(file, "setup", &inner)?,
        page_version: field(file, "page_version", &string)?,
        began_unix_ms: field(file, "began_unix_ms", &|it| up_to(UNIX_MS_MAX, it))?,
        began: field(file, "is_started", &truth)?.then_some(Instant::ZERO),
        request_hz: field(file, "request_hz", &|it| up_to(HZ_MAX, it))?,
        bytes: u32::try_from(text.len()).unwrap_or(u32::MAX),
    };
    let part = RecordPart {
        samples: field(file, "samples", &|it| rows(it, &sample))?,
        sent: field(file, "sent", &|it| rows(it, &sent))?,
        marks: field(file, "marks", &|it| rows(it, &mark))?,
    };
    check(&header, &part)?;
    let mut record = header.record();
    record.add_part(part);
    Ok((header, record))
}

/// The page evaluates what is stored, so the work for it is bounded here: times are in order, every row is of one of at most
/// 16 motors, and the run of a study begins each step of its sequence at most once.
fn check(header: &RunHeader, part: &RecordPart) -> Result<()> {
    let marks = part.marks.len();
    let are_many = match header.study() {
        Some(Study::Sequence(_)) | None => false,
        Some(study) => marks > study.sequence().steps.len(),
    };
    let is_unknown = |id: MotorId| header.motors.iter().all(|(known, _)| *known != id);
    let wrong = [
        ("motors", header.motors.len() > MOTORS_MAX),
        ("samples", part.samples.iter().any(|it| is_unknown(it.id))),
        ("sent", part.sent.iter().any(|it| is_unknown(it.id))),
        ("samples", !part.samples.is_sorted_by_key(|it| it.at)),
        ("sent", !part.sent.is_sorted_by_key(|it| it.at)),
        (
            "marks",
            are_many || !part.marks.is_sorted_by_key(|it| it.at),
        ),
    ];
    match wrong.into_iter().find(|(_, is_wrong)| *is_wrong) {
        Some((place, _)) => Err(JsonError { place }),
        None => Ok(()),
    }
}

/// What `read` makes of this field.
fn field<T>(
    file: RawJsonValue<'_, '_>,
    place: &'static str,
    read: &dyn Fn(&RawJsonValue<'_, '_>) -> Option<T>,
) -> Result<T> {
    let member = file.to_member(place).ok();
    let value = member.and_then(RawJsonMember::optional);
    value.as_ref().and_then(read).ok_or(JsonError { place })
}

/// What `read` makes of the cells of each row.
fn rows<T>(
    rows: &RawJsonValue<'_, '_>,
    read: &dyn Fn(&[RawJsonValue<'_, '_>]) -> Option<T>,
) -> Option<Vec<T>> {
    let row = |row: RawJsonValue<'_, '_>| read(&row.to_array().ok()?.collect::<Vec<_>>());
    rows.to_array().ok()?.map(row).collect()
}

/// The text of an [`Inner`].
fn inner(value: &RawJsonValue<'_, '_>) -> Option<String> {
    if value.kind().is_object() {
        Some(value.as_raw_str().to_owned())
    } else {
        string(value)
    }
}

fn real(value: &RawJsonValue<'_, '_>) -> Option<f64> {
    let number = value.as_number_str().ok()?.parse::<f64>().ok()?;
    number.is_finite().then_some(number)
}

fn rounded(value: &RawJsonValue<'_, '_>) -> Option<u32> {
    real(value).map(crate::number::whole)
}

/// From 0 up to this number.
fn up_to(max: f64, value: &RawJsonValue<'_, '_>) -> Option<f64> {
    real(value).filter(|number| (0.0..=max).contains(number))
}

fn string(value: &RawJsonValue<'_, '_>) -> Option<String> {
    Some(value.to_unquoted_string_str().ok()?.into_owned())
}

fn whole<T: TryFrom<i64>>(value: &RawJsonValue<'_, '_>) -> Option<T> {
    let number = value.as_number_str().ok()?.parse::<i64>().ok()?;
    T::try_from(number).ok()
}

fn motor(value: &RawJsonValue<'_, '_>) -> Option<MotorId> {
    MotorId::new(whole(value)?).ok()
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float cast saturates, which is what is meant"
)]
fn micros(value: f64) -> u64 {
    value as u64
}

/// A value of a sample that may be null.
fn optional<T>(
    value: &RawJsonValue<'_, '_>,
    read: impl Fn(&RawJsonValue<'_, '_>) -> Option<T>,
) -> Result<Option<T>> {
    if value.kind().is_null() {
        return Ok(None);
    }
    read(value).map(Some).ok_or(JsonError { place: "samples" })
}

fn named_motor(row: &[RawJsonValue<'_, '_>]) -> Option<(MotorId, String)> {
    Some((motor(row.first()?)?, string(row.get(1)?)?))
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "the shortest text of an `f32` gives the same `f32` again"
)]
fn sample(row: &[RawJsonValue<'_, '_>]) -> Option<Sample> {
    let [at, id, rpm, current, degrees, celsius] = row else {
        return None;
    };
    Some(Sample {
        id: motor(id)?,
        at: Instant::from_micros(whole(at)?),
        rpm: optional(rpm, whole).ok()?,
        current: optional(current, whole).ok()?.map(Current::from_raw),
        degrees: optional(degrees, |it| Some(real(it)? as f32)).ok()?,
        celsius: optional(celsius, whole).ok()?,
    })
}

fn sent(row: &[RawJsonValue<'_, '_>]) -> Option<SentSetpoint> {
    let [at, id, unit, value, acceleration] = row else {
        return None;
    };
    Some(SentSetpoint {
        id: motor(id)?,
        at: Instant::from_micros(whole(at)?),
        setpoint: of_parts(&string(unit)?, whole(value)?, whole(acceleration)?)?,
    })
}

fn mark(row: &[RawJsonValue<'_, '_>]) -> Option<Mark> {
    Some(Mark {
        at: Instant::from_micros(micros(real(row.first()?)?)),
        step: usize::try_from(rounded(row.get(1)?)?).ok()?,
    })
}
