//! Reads a file, and finds the place of an invalid value.

use motorlink_messages::{
    bus::{CommandRate, Limits, Ramp},
    experiments::{
        analysis::WhenSilent,
        vehicle::{Geometry, RADIUS_MM, TRACK_MM},
    },
    protocol::MotorId,
};
use nojson::{JsonValueKind, RawJson, RawJsonValue};

use crate::model::{
    names_and_sides::{NameAndSide, NamesAndSides, Side},
    setup::{Allowed, Misfit, SETUP_BYTES_MAX, Setup, SetupError, VERSION},
};

const FIELDS: [&str; 11] = [
    "motorlink_setup",
    "model",
    "detect_model",
    "command_rate_hz",
    "keep_driving_while_hidden",
    "ramp_rpm_per_s",
    "speed_limit_rpm",
    "current_limit_ma",
    "temperature_limit_c",
    "vehicle",
    "motors",
];
const FIELDS_OF_VEHICLE: [&str; 2] = ["wheel_radius_mm", "track_width_mm"];
const FIELDS_OF_MOTOR: [&str; 5] = ["id", "name", "side", "drives_together", "when_frames_cease"];

const RATE: (u16, u16) = (CommandRate::MIN, CommandRate::MAX);
const ID: (u16, u16) = (1, 254);

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
        vehicle,
        motors,
    ] = fields(file, &FIELDS)?;
    Ok(Setup {
        model: fit(model, Allowed::Model, |value| text_of(value)?.parse().ok())?,
        detect_model: fit(detect_model, Allowed::Yes, yes)?,
        rate: whole_in(rate, RATE)?.and_then(|rate| CommandRate::new(rate).ok()),
        keep_driving: fit(keep_driving, Allowed::Yes, yes)?,
        ramp: whole_in(ramp, (0, Ramp::MAX))?,
        speed_limit: whole_in(speed, Limits::SPEED_RPM)?,
        current_limit: whole_in(current, Limits::CURRENT_MA)?,
        temperature_limit: whole_in(temperature, Limits::TEMPERATURE_C)?,
        geometry: vehicle.map(geometry).transpose()?,
        names: motors.map(names).transpose()?,
    })
}

fn geometry(vehicle: Value) -> Result<Geometry, SetupError> {
    let [radius, track] = fields(vehicle, &FIELDS_OF_VEHICLE)?;
    let [of_radius, of_track] = FIELDS_OF_VEHICLE;
    let measure = |value, name, range| {
        let measure = whole_in(value, range)?;
        measure.ok_or_else(|| missing(vehicle, name, Allowed::Whole(range)))
    };
    let radius_mm = measure(radius, of_radius, RADIUS_MM)?;
    let track_mm = measure(track, of_track, TRACK_MM)?;
    let geometry = Geometry::new(radius_mm.into(), track_mm.into());
    geometry.ok_or_else(|| not(vehicle, Allowed::Object))
}

fn whole_in(value: Option<Value>, range: (u16, u16)) -> Result<Option<u16>, SetupError> {
    let (least, most) = range;
    fit(value, Allowed::Whole(range), |value| {
        whole(value).filter(|whole| (least..=most).contains(whole))
    })
}

fn check_version(file: Value) -> Result<(), SetupError> {
    let [name, ..] = FIELDS;
    let mut members = file.to_object().map_err(|_| not(file, Allowed::Object))?;
    let version = members.find(|(key, _)| text_of(*key).as_deref() == Some(name));
    let (_, version) = version.ok_or_else(|| missing(file, name, Allowed::Version))?;
    match whole(version) {
        Some(VERSION) => Ok(()),
        _ => Err(not(version, Allowed::Version)),
    }
}

fn names(motors: Value) -> Result<NamesAndSides, SetupError> {
    let mut names = NamesAndSides::default();
    for motor in motors.to_array().map_err(|_| not(motors, Allowed::List))? {
        let [id, name, side, drives, when_silent] = fields(motor, &FIELDS_OF_MOTOR)?;
        let at = id.ok_or_else(|| missing(motor, "id", Allowed::Whole(ID)))?;
        let id = whole(at).and_then(|id| MotorId::new(u8::try_from(id).ok()?).ok());
        let id = id.ok_or_else(|| not(at, Allowed::Whole(ID)))?;
        if names.member(id).is_some() {
            return Err(misfit(at, Misfit::SameId));
        }
        let name = fit(name, Allowed::Name, |value| {
            text_of(value).filter(|name| NameAndSide::is_name(name))
        })?;
        let side = fit(side, Allowed::Side, |value| {
            Side::from_key(&text_of(value)?)
        })?;
        let drives = fit(drives, Allowed::Yes, yes)?;
        let when_silent = fit(when_silent, Allowed::Behaviour, |value| {
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
    allowed: Allowed,
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
    for (key, value) in members.map_err(|_| not(value, Allowed::Object))? {
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

fn not(value: Value, allowed: Allowed) -> SetupError {
    misfit(value, Misfit::Not(allowed))
}

fn missing(value: Value, name: &str, allowed: Allowed) -> SetupError {
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
