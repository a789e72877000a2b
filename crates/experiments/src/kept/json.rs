//! A kept run as a JSON file, and back.
//!
//! Rows are arrays, because a run of minutes has tens of thousands. Times are microseconds since the start.

use std::{fmt, ops::RangeInclusive};

use motorlink_protocol::{Current, Faults, Instant, MotorId};
use nojson::{JsonFormatter, RawJson, RawJsonValue, json};

use super::{
    Outcome, RunHeader,
    setpoint::{of_parts, parts},
};
use crate::{
    plan::MOTORS_MAX,
    runner::{Cause, End, Mark, Record, RecordPart, Sample, SentSetpoint},
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
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JsonError {
    /// The field that does not fit.
    pub place: &'static str,
}

impl fmt::Display for JsonError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "not a run of this version: {}", self.place)
    }
}

impl std::error::Error for JsonError {}

type Result<T> = std::result::Result<T, JsonError>;

/// The whole run as a file.
#[must_use]
pub fn run_to_json(header: &RunHeader, record: &Record) -> String {
    let began = header.began.unwrap_or(Instant::from_micros(0));
    let micros = |at: Instant| u64::try_from(at.since(began).as_micros()).unwrap_or(u64::MAX);
    let ended = match header.outcome {
        Outcome::Ended(End::Finished { at } | End::Aborted { at, .. }) => Some(micros(at)),
        _ => None,
    };
    let samples = record.samples().iter().map(|it| {
        json_row(move |f| {
            f.array(|f| {
                f.element(micros(it.at))?;
                f.element(it.id.get())?;
                f.element(it.rpm)?;
                f.element(it.current.map(Current::raw))?;
                f.element(it.degrees)?;
                f.element(it.celsius)
            })
        })
    });
    let sent = record.sent_setpoints().iter().map(|it| {
        let (unit, value, acceleration) = parts(it.setpoint);
        json_row(move |f| {
            f.array(|f| {
                f.element(micros(it.at))?;
                f.element(it.id.get())?;
                f.element(unit)?;
                f.element(value)?;
                f.element(acceleration)
            })
        })
    });
    let marks = record.marks().iter().map(|it| {
        json_row(move |f| {
            f.array(|f| {
                f.element(micros(it.at))?;
                f.element(it.step)
            })
        })
    });
    let motors = header.motors.iter().map(|(id, name)| {
        json_row(move |f| {
            f.array(|f| {
                f.element(id.get())?;
                f.element(name)
            })
        })
    });
    let text = json(|f| {
        f.object(|f| {
            f.member("motorlink_run", VERSION)?;
            f.member("number", header.number)?;
            f.member("name", &header.name)?;
            f.member("study", Inner(&header.study))?;
            f.member("motors", motors.clone().collect::<Vec<_>>())?;
            f.member("model", &header.model)?;
            f.member("signs", SIGNS)?;
            f.member("setup", Inner(&header.setup))?;
            f.member("page_version", &header.page_version)?;
            f.member("began_unix_ms", header.began_unix_ms)?;
            f.member("is_started", header.began.is_some())?;
            f.member("request_hz", header.request_hz)?;
            f.member("outcome", outcome_name(header.outcome))?;
            f.member("why", header.outcome.cause().map(|cause| cause.to_string()))?;
            f.member("ended_us", ended)?;
            f.member("samples", samples.clone().collect::<Vec<_>>())?;
            f.member("sent", sent.clone().collect::<Vec<_>>())?;
            f.member("marks", marks.clone().collect::<Vec<_>>())
        })
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

fn json_row<F: Fn(&mut JsonFormatter<'_, '_>) -> fmt::Result>(write: F) -> Row<F> {
    Row(write)
}

struct Row<F>(F);

impl<F: Fn(&mut JsonFormatter<'_, '_>) -> fmt::Result> nojson::DisplayJson for Row<F> {
    fn fmt(&self, f: &mut JsonFormatter<'_, '_>) -> fmt::Result {
        (self.0)(f)
    }
}

const fn outcome_name(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Running => "running",
        Outcome::Ended(End::Finished { .. }) => "finished",
        Outcome::Ended(End::Aborted { cause, .. }) => cause_name(cause),
        Outcome::PageClosed => "page_closed",
    }
}

const fn cause_name(cause: Cause) -> &'static str {
    match cause {
        Cause::Stopped => "stopped",
        Cause::Driven(_) => "driven",
        Cause::Fault(..) => "fault",
        Cause::Silent(_) => "silent",
        Cause::Limit(..) => "limit",
        Cause::OtherLoop(..) => "other_loop",
        Cause::Refused(_) => "refused",
        Cause::Unplugged => "unplugged",
        Cause::TabClosed => "tab_closed",
        Cause::PageSilent => "page_silent",
        Cause::OperatorLost => "operator_lost",
        Cause::FocusLost => "focus_lost",
        Cause::Slept => "slept",
        Cause::Late => "late",
        Cause::WaitTimedOut { .. } => "wait_timed_out",
        Cause::PausedTooLong => "paused_too_long",
        Cause::PortClosed => "port_closed",
        Cause::Scan => "scan",
        Cause::OtherModel => "other_model",
        Cause::LeftDriven => "left_driven",
        Cause::ProgramFailed => "program_failed",
    }
}

/// Reads such a file. A cause with details, such as a limit, is read without them: the file has them as text only.
///
/// # Errors
/// [`JsonError`] names the field that does not fit.
pub fn run_from_json(text: &str) -> Result<(RunHeader, Record)> {
    let raw = RawJson::parse(text).map_err(|_| JsonError { place: "JSON" })?;
    let file = File(raw.value());
    if !(1..=VERSION).contains(&crate::number::whole(file.number("motorlink_run")?)) {
        return Err(JsonError {
            place: "motorlink_run",
        });
    }
    let began = Instant::from_micros(0);
    let motors = file.rows("motors", |row| {
        Some((motor(&cell(row, 0)?)?, string(&cell(row, 1)?)?))
    })?;
    let ended = file.optional_number("ended_us")?;
    let at = Instant::from_micros(micros(ended.unwrap_or_default()));
    let first = motors.first().map_or(MotorId::FIRST, |(id, _)| *id);
    let outcome = outcome(&file.text("outcome")?, at, first);
    let header = RunHeader {
        number: crate::number::whole(file.number("number")?),
        name: file.text("name")?,
        study: file.inner("study")?,
        motors,
        model: file.text("model")?,
        setup: file.inner("setup")?,
        page_version: file.text("page_version")?,
        began_unix_ms: file.number_in("began_unix_ms", 0.0..=UNIX_MS_MAX)?,
        began: file.bool("is_started")?.then_some(began),
        request_hz: file.number_in("request_hz", 0.0..=HZ_MAX)?,
        outcome: outcome.ok_or(JsonError { place: "outcome" })?,
        bytes: u32::try_from(text.len()).unwrap_or(u32::MAX),
    };
    let part = RecordPart {
        samples: file.rows("samples", sample)?,
        sent: file.rows("sent", sent)?,
        marks: file.rows("marks", |row| {
            Some(Mark {
                at: Instant::from_micros(micros(real(&cell(row, 0)?)?)),
                step: usize::try_from(crate::number::whole(real(&cell(row, 1)?)?)).ok()?,
            })
        })?,
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

fn outcome(name: &str, at: Instant, id: MotorId) -> Option<Outcome> {
    use crate::runner::ExceededLimit;
    use motorlink_protocol::Mode;
    let causes = [
        Cause::Stopped,
        Cause::Driven(id),
        Cause::Fault(id, Faults::NONE),
        Cause::Silent(id),
        Cause::Limit(id, ExceededLimit::OfBus),
        Cause::OtherLoop(id, Mode::Velocity),
        Cause::Refused(id),
        Cause::Unplugged,
        Cause::TabClosed,
        Cause::PageSilent,
        Cause::OperatorLost,
        Cause::FocusLost,
        Cause::Slept,
        Cause::Late,
        Cause::WaitTimedOut { step: 0 },
        Cause::PausedTooLong,
        Cause::PortClosed,
        Cause::Scan,
        Cause::OtherModel,
        Cause::LeftDriven,
        Cause::ProgramFailed,
    ];
    match name {
        // Nothing runs in a file.
        "running" | "page_closed" => Some(Outcome::PageClosed),
        "finished" => Some(Outcome::Ended(End::Finished { at })),
        _ => {
            let cause = causes.into_iter().find(|it| cause_name(*it) == name)?;
            Some(Outcome::Ended(End::Aborted { cause, at }))
        }
    }
}

struct File<'a>(RawJsonValue<'a, 'a>);

impl<'a> File<'a> {
    fn get(&self, place: &'static str) -> Result<RawJsonValue<'a, 'a>> {
        let member = self.0.to_member(place).ok();
        let value = member.and_then(nojson::RawJsonMember::optional);
        value.ok_or(JsonError { place })
    }

    fn number(&self, place: &'static str) -> Result<f64> {
        real(&self.get(place)?).ok_or(JsonError { place })
    }

    fn number_in(&self, place: &'static str, range: RangeInclusive<f64>) -> Result<f64> {
        let number = self.number(place)?;
        let fits = range.contains(&number);
        fits.then_some(number).ok_or(JsonError { place })
    }

    fn optional_number(&self, place: &'static str) -> Result<Option<f64>> {
        let value = self.get(place)?;
        if value.kind().is_null() {
            return Ok(None);
        }
        real(&value).map(Some).ok_or(JsonError { place })
    }

    fn text(&self, place: &'static str) -> Result<String> {
        string(&self.get(place)?).ok_or(JsonError { place })
    }

    /// The text of an [`Inner`].
    fn inner(&self, place: &'static str) -> Result<String> {
        let value = self.get(place)?;
        if value.kind().is_object() {
            Ok(value.as_raw_str().to_owned())
        } else {
            self.text(place)
        }
    }

    fn bool(&self, place: &'static str) -> Result<bool> {
        match self.get(place)?.as_raw_str() {
            "true" => Ok(true),
            "false" => Ok(false),
            _ => Err(JsonError { place }),
        }
    }

    fn rows<T>(
        &self,
        place: &'static str,
        read: impl Fn(&[RawJsonValue<'a, 'a>]) -> Option<T>,
    ) -> Result<Vec<T>> {
        let error = JsonError { place };
        let rows = self.get(place)?.to_array().map_err(|_| error.clone())?;
        let row = |row: RawJsonValue<'a, 'a>| {
            let cells: Vec<_> = row.to_array().ok()?.collect();
            read(&cells)
        };
        rows.map(row).collect::<Option<Vec<T>>>().ok_or(error)
    }
}

fn cell<'a>(row: &[RawJsonValue<'a, 'a>], place: usize) -> Option<RawJsonValue<'a, 'a>> {
    row.get(place).copied()
}

fn real(value: &RawJsonValue<'_, '_>) -> Option<f64> {
    let number = value.as_number_str().ok()?.parse::<f64>().ok()?;
    number.is_finite().then_some(number)
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
