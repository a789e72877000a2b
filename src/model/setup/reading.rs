//! Reads a file, and finds the place of an invalid value.

use motorlink_i18n::tr;
use motorlink_messages::{
    bus::{CommandRate, Limits, Ramp},
    experiments::analysis::WhenSilent,
    protocol::MotorId,
};
use nojson::{JsonValueKind, RawJson, RawJsonValue};

use crate::model::{
    names_and_sides::{NameAndSide, NamesAndSides, Side},
    setup::{Misfit, SETUP_BYTES_MAX, Setup, SetupError, VERSION},
};

const FIELDS: [&str; 10] = [
    "motorlink_setup",
    "model",
    "detect_model",
    "command_rate_hz",
    "keep_driving_while_hidden",
    "ramp_rpm_per_s",
    "speed_limit_rpm",
    "current_limit_ma",
    "temperature_limit_c",
    "motors",
];
const FIELDS_OF_MOTOR: [&str; 5] = ["id", "name", "side", "drives_together", "when_frames_cease"];

fn a_version() -> &'static str {
    tr!("1 (the supported version)")
}
fn a_model() -> &'static str {
    tr!("\"ddsm115\", \"ddsm315\", \"ddsm210\" or \"ddsm400\"")
}
fn a_rate() -> &'static str {
    tr!("a whole number from 1 to 500")
}
fn a_ramp() -> &'static str {
    tr!("a whole number from 0 to 10000")
}
fn a_speed_limit() -> &'static str {
    tr!("a whole number from 1 to 380")
}
fn a_current_limit() -> &'static str {
    tr!("a whole number from 100 to 8000")
}
fn a_temperature_limit() -> &'static str {
    tr!("a whole number from 30 to 80")
}
fn a_yes() -> &'static str {
    tr!("true or false")
}
fn a_list() -> &'static str {
    tr!("a list of motors")
}
fn an_id() -> &'static str {
    tr!("a whole number from 1 to 254")
}
fn a_name() -> &'static str {
    tr!("text of at most 16 characters, no control characters")
}
fn a_side() -> &'static str {
    tr!("\"none\", \"left\" or \"right\"")
}
fn a_behaviour() -> &'static str {
    tr!("\"keeps\", \"coasts\" or \"brakes\"")
}
fn fields_in_braces() -> &'static str {
    tr!("a JSON object")
}

/// Maximal characters of an unknown field in an error.
const TOLD_MAX: usize = 32;

/// A value of the file with its place.
type Value<'a> = RawJsonValue<'a, 'a>;

pub(crate) fn read(file: &[u8]) -> Result<Setup, SetupError> {
    if file.len() > SETUP_BYTES_MAX {
        return Err(SetupError::TooLarge);
    }
    // Editors on Windows add a byte order mark.
    let file = file.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(file);
    let text = std::str::from_utf8(file).map_err(|error| no_json(file, error.valid_up_to()))?;
    let json = RawJson::parse(text);
    let json = json.map_err(|error| no_json(file, error.position()))?;
    let file = json.value();
    // First of all: another version may have other fields.
    check_version(file)?;
    let [
        _,
        model,
        detect_model,
        rate,
        keep_driving,
        ramp,
        speed,
        current,
        temperature,
        motors,
    ] = fields(file, &FIELDS)?;
    Ok(Setup {
        model: fit(model, a_model(), |value| text_of(value)?.parse().ok())?,
        detect_model: fit(detect_model, a_yes(), yes)?,
        rate: fit(rate, a_rate(), |value| CommandRate::new(whole(value)?).ok())?,
        keep_driving: fit(keep_driving, a_yes(), yes)?,
        ramp: fit(ramp, a_ramp(), |value| {
            whole(value).filter(|ramp| *ramp <= Ramp::MAX)
        })?,
        speed_limit: limit(speed, a_speed_limit(), Limits::SPEED_RPM)?,
        current_limit: limit(current, a_current_limit(), Limits::CURRENT_MA)?,
        temperature_limit: limit(temperature, a_temperature_limit(), Limits::TEMPERATURE_C)?,
        names: motors.map(names).transpose()?,
    })
}

fn limit(
    value: Option<Value>,
    allowed: &'static str,
    (least, most): (u16, u16),
) -> Result<Option<u16>, SetupError> {
    fit(value, allowed, |value| {
        whole(value).filter(|limit| (least..=most).contains(limit))
    })
}

fn check_version(file: Value) -> Result<(), SetupError> {
    let [name, ..] = FIELDS;
    let mut members = file
        .to_object()
        .map_err(|_| not(file, fields_in_braces()))?;
    let version = members.find(|(key, _)| text_of(*key).as_deref() == Some(name));
    let (_, version) = version.ok_or_else(|| missing(file, name, a_version()))?;
    match whole(version) {
        Some(VERSION) => Ok(()),
        _ => Err(not(version, a_version())),
    }
}

fn names(motors: Value) -> Result<NamesAndSides, SetupError> {
    let mut names = NamesAndSides::default();
    for motor in motors.to_array().map_err(|_| not(motors, a_list()))? {
        let [id, name, side, drives, when_silent] = fields(motor, &FIELDS_OF_MOTOR)?;
        let at = id.ok_or_else(|| missing(motor, "id", an_id()))?;
        let id = whole(at).and_then(|id| MotorId::new(u8::try_from(id).ok()?).ok());
        let id = id.ok_or_else(|| not(at, an_id()))?;
        if names.member(id).is_some() {
            return Err(misfit(at, Misfit::SameId));
        }
        let name = fit(name, a_name(), |value| {
            text_of(value).filter(|name| NameAndSide::is_name(name))
        })?;
        let side = fit(side, a_side(), |value| Side::from_key(&text_of(value)?))?;
        let drives = fit(drives, a_yes(), yes)?;
        let when_silent = fit(when_silent, a_behaviour(), |value| {
            WhenSilent::from_key(&text_of(value)?)
        })?;
        names.change(id, |member| {
            // Without trimming, which is only for typed text.
            member.set_name(name.unwrap_or_default().trim());
            member.side = side.unwrap_or_default();
            member.drives = drives.unwrap_or_default();
            member.when_silent = when_silent;
        });
    }
    Ok(names)
}

/// Reads an optional value.
fn fit<T>(
    value: Option<Value>,
    allowed: &'static str,
    read: impl FnOnce(Value) -> Option<T>,
) -> Result<Option<T>, SetupError> {
    let Some(value) = value else { return Ok(None) };
    match read(value) {
        None => Err(not(value, allowed)),
        some => Ok(some),
    }
}

/// The fields of a value, in the order of these names.
fn fields<'a, const N: usize>(
    value: Value<'a>,
    names: &'static [&'static str; N],
) -> Result<[Option<Value<'a>>; N], SetupError> {
    let mut found = [None; N];
    fill(&mut found, value, names)?;
    Ok(found)
}

fn fill<'a>(
    found: &mut [Option<Value<'a>>],
    value: Value<'a>,
    names: &'static [&'static str],
) -> Result<(), SetupError> {
    let members = value.to_object();
    for (key, value) in members.map_err(|_| not(value, fields_in_braces()))? {
        let key = text_of(key).unwrap_or_default();
        let known = names.iter().position(|name| *name == key);
        match known.and_then(|place| found.get_mut(place)) {
            None => return Err(misfit(value, Misfit::Unknown(names))),
            Some(Some(_)) => return Err(misfit(value, Misfit::Twice)),
            Some(slot) => *slot = Some(value),
        }
    }
    Ok(())
}

/// No field takes more than a `u16`.
fn whole(value: Value) -> Option<u16> {
    match value.kind() {
        JsonValueKind::Integer => value.as_raw_str().parse().ok(),
        _ => None,
    }
}

fn yes(value: Value) -> Option<bool> {
    match value.as_raw_str() {
        "true" => Some(true),
        "false" => Some(false),
        _ => None,
    }
}

fn text_of(value: Value) -> Option<String> {
    Some(value.to_unquoted_string_str().ok()?.into_owned())
}

fn not(value: Value, allowed: &'static str) -> SetupError {
    misfit(value, Misfit::Not(allowed))
}

fn missing(value: Value, name: &str, allowed: &'static str) -> SetupError {
    SetupError::At {
        place: field_of(place_of(value), name),
        misfit: Misfit::Missing(allowed),
    }
}

fn misfit(value: Value, misfit: Misfit) -> SetupError {
    SetupError::At {
        place: place_of(value),
        misfit,
    }
}

/// As in `motors[2].side`.
fn place_of(value: Value) -> String {
    let Some(parent) = value.parent() else {
        return String::new();
    };
    let above = place_of(parent);
    if let Ok(mut items) = parent.to_array() {
        let place = items.position(|item| item.index() == value.index());
        return format!("{above}[{}]", place.unwrap_or_default());
    }
    let members = parent.to_object().ok();
    let member = members.and_then(|mut all| all.find(|(_, other)| other.index() == value.index()));
    let key = member.and_then(|(key, _)| text_of(key)).unwrap_or_default();
    let told = key.chars().filter(|character| !character.is_control());
    field_of(above, &told.take(TOLD_MAX).collect::<String>())
}

fn field_of(mut place: String, name: &str) -> String {
    if !place.is_empty() {
        place.push('.');
    }
    place.push_str(name);
    place
}

/// The file is invalid after this many bytes.
fn no_json(file: &[u8], bytes: usize) -> SetupError {
    let before = file.get(..bytes).unwrap_or(file);
    let (mut line, mut column) = (1, 1);
    for character in std::str::from_utf8(before).unwrap_or_default().chars() {
        if character == '\n' {
            (line, column) = (line + 1, 1);
        } else {
            column += 1;
        }
    }
    SetupError::NoJson { line, column }
}
