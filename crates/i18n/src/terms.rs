//! The terms of the protocol in the current language. `motorlink-protocol` has them in English for other
//! programs; the English here is the same.

use motorlink_protocol::{
    Fault, Faults, Mode, MotorIdError, NotAssignable, Reply, ReplyError, RequestError, Rpm,
    UnknownMode,
};

use crate::{current_language, tr};

/// A number with the decimal mark of the language.
#[must_use]
pub fn in_language(number: String) -> String {
    match current_language().decimal_mark() {
        '.' => number,
        mark => number.replace('.', &mark.to_string()),
    }
}

/// The unit of a speed: `rpm`. German drive engineers write `U/min`.
#[must_use]
pub fn rpm() -> &'static str {
    tr!("rpm")
}

/// `+100 rpm`, in the unit of the language.
#[must_use]
pub fn speed(speed: Rpm) -> String {
    // As the protocol writes it: +0 at a standstill.
    let sign = if speed.rpm() < 0 { '\u{2212}' } else { '+' };
    format!("{sign}{} {}", speed.magnitude(), rpm())
}

/// `velocity loop`
#[must_use]
pub fn mode(mode: Mode) -> &'static str {
    match mode {
        Mode::OpenLoop => tr!("open loop"),
        Mode::Current => tr!("current loop"),
        Mode::Velocity => tr!("velocity loop"),
        Mode::Position => tr!("position loop"),
    }
}

/// `stall`
#[must_use]
pub fn fault(fault: Fault) -> &'static str {
    match fault {
        Fault::Sensor => tr!("sensor"),
        Fault::BusOvercurrent => tr!("bus overcurrent"),
        Fault::PhaseOvercurrent => tr!("phase overcurrent"),
        Fault::Overcurrent => tr!("overcurrent"),
        Fault::Stall => tr!("stall"),
        Fault::OverTemperature => tr!("over-temperature"),
        Fault::Disconnected => tr!("disconnected"),
        Fault::Voltage => tr!("over- or undervoltage"),
    }
}

/// `OK`, or `stall, over-temperature`, or `unknown bits 0x20`.
#[must_use]
pub fn faults(faults: Faults) -> String {
    if faults.is_none() {
        return "OK".to_owned();
    }
    let mut named = faults
        .iter()
        .map(fault)
        .map(str::to_owned)
        .collect::<Vec<_>>();
    if faults.unknown_bits() != 0 {
        let bits = format!("0x{:02X}", faults.unknown_bits());
        named.push(tr!("unknown bits {bits}", bits));
    }
    let listed = |some, other| tr!("{some}, {other}", some, other);
    named.into_iter().reduce(listed).unwrap_or_default()
}

/// Why a number is not a valid motor ID.
#[must_use]
pub fn no_motor_id(error: MotorIdError) -> &'static str {
    match error {
        MotorIdError::Zero => tr!("0 is not a valid ID: use 1 to 254."),
        MotorIdError::TooLarge => tr!("Not a valid ID: use a whole number from 1 to 254."),
    }
}

/// Why a motor cannot be given an ID.
#[must_use]
pub fn not_assignable(NotAssignable: NotAssignable) -> &'static str {
    tr!("200 (0xC8) is reserved for the ID query: use another ID.")
}

/// What a combined reply says.
pub(crate) fn received(reply: &Reply) -> String {
    // What is unknown is left out.
    let parts = [
        reply.speed.map(speed),
        reply
            .current
            .map(|current| in_language(current.to_string())),
        reply
            .detail
            .temperature()
            .map(|temperature| temperature.to_string()),
        reply
            .detail
            .angle()
            .map(|angle| in_language(angle.to_string())),
        (reply.mode != Mode::Velocity).then(|| mode(reply.mode).to_owned()),
    ];
    let mut said = String::new();
    for part in parts.into_iter().flatten() {
        if !said.is_empty() {
            said.push_str(", ");
        }
        said.push_str(&part);
    }
    if !reply.faults.is_none() {
        said = tr!(
            "{said}, fault: {faults}",
            said,
            faults = faults(reply.faults)
        );
    }
    said
}

pub(crate) fn no_request(error: RequestError) -> String {
    match error {
        RequestError::BadCrc { expected, found } => bad_crc(expected, found),
        RequestError::BadId(error) => uncapped(no_motor_id(error)),
        RequestError::NotAssignable => uncapped(not_assignable(NotAssignable)),
        RequestError::UnknownCommand(byte) => tr!(
            "byte 1 is {byte}; expected 64 (drive), 74 (query) or A0 (mode)",
            byte = hex(byte)
        ),
        RequestError::BadMode(error) => bad_mode(error),
        RequestError::NotZero { place } => {
            tr!("byte {place} must be 00 in this frame", place)
        }
    }
}

pub(crate) fn no_reply(error: ReplyError) -> String {
    match error {
        ReplyError::BadCrc { expected, found } => bad_crc(expected, found),
        ReplyError::BadId(error) => uncapped(no_motor_id(error)),
        ReplyError::BadMode(error) => bad_mode(error),
    }
}

fn bad_crc(expected: u8, found: u8) -> String {
    tr!(
        "CRC {found}, expected {expected}",
        found = hex(found),
        expected = hex(expected)
    )
}

fn bad_mode(UnknownMode(byte): UnknownMode) -> String {
    tr!(
        "mode byte is {byte}; expected 01 (current), 02 (velocity) or 03 (position)",
        byte = hex(byte)
    )
}

fn hex(byte: u8) -> String {
    format!("{byte:02X}")
}

/// A sentence as a part of another: without its capital and its full stop.
fn uncapped(sentence: &str) -> String {
    let mut part = sentence.trim_end_matches(['.', '。']).to_owned();
    if let Some(first) = part.get_mut(..1) {
        first.make_ascii_lowercase();
    }
    part
}
