//! Parses the text of a field into a value in range, or into a message about what is wrong.

use motorlink_i18n::tr;
use motorlink_messages::{
    bus::{CommandRate, Limits},
    protocol::{CurrentTarget, OpenLoopTarget, PositionTarget, SpeedTarget},
};

use crate::ui::format;

/// The parsed content of a field.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Typed {
    /// A value in range.
    Value(i32),
    /// Empty or only a sign: the user is still typing.
    Unfinished,
    /// Not a number, or one out of range; the text names the rule.
    Wrong(String),
}

/// How a field parses and displays its value.
#[derive(Clone, Copy)]
pub(crate) struct Entry {
    /// Least value.
    pub(crate) min: i32,
    /// Greatest value.
    pub(crate) max: i32,
    /// Parses a text into a value between these two.
    pub(crate) read: fn(&str, i32, i32) -> Typed,
    /// Formats a value.
    pub(crate) show: fn(i32) -> String,
    /// Displayed number per unit of the value.
    pub(crate) scale: f64,
    /// Change of the displayed number by an arrow key.
    pub(crate) step: f64,
    /// Change of the displayed number by page up and page down.
    pub(crate) page: f64,
}

impl Entry {
    /// A whole number in this range that is displayed as it is.
    pub(crate) const fn whole(min: i32, max: i32, read: fn(&str, i32, i32) -> Typed) -> Self {
        Self {
            min,
            max,
            read,
            show: |value| value.to_string(),
            scale: 1.0,
            step: 1.0,
            page: 10.0,
        }
    }

    /// Parses a text.
    pub(crate) fn read(self, text: &str) -> Typed {
        (self.read)(text, self.min, self.max)
    }

    /// The entry with a smaller range, up to this distance from zero.
    pub(crate) fn limited(self, limit: i32) -> Self {
        Self {
            min: self.min.max(-limit),
            max: self.max.min(limit),
            ..self
        }
    }

    /// The displayed number of a value.
    pub(crate) fn shown(self, value: i32) -> f64 {
        f64::from(value) * self.scale
    }

    /// The displayed number as plain text, for attributes.
    pub(crate) fn plain(self, value: i32) -> String {
        if self.scale < 1.0 {
            format!("{:.2}", self.shown(value))
        } else {
            value.to_string()
        }
    }

    /// The value after a change of the displayed number.
    #[allow(
        clippy::cast_possible_truncation,
        reason = "a float cast saturates, and the value is clamped to its range"
    )]
    pub(crate) fn moved(self, value: i32, by: f64) -> i32 {
        // Fractions move in whole steps.
        let grid = if self.scale < 1.0 { self.step } else { 1.0 };
        let shown = (self.shown(value) / grid).round() * grid + by;
        ((shown / self.scale).round() as i32).clamp(self.min, self.max)
    }
}

/// Degrees per step of the raw position.
const DEGREES_PER_RAW: f64 = 360.0 / PositionTarget::MAX as f64;

/// Speed in rpm.
pub(crate) const SPEED: Entry = Entry {
    show: format::signed,
    ..Entry::whole(SpeedTarget::MIN, SpeedTarget::MAX, |text, min, max| {
        whole(text, |rpm| within(rpm, min, max, tr!("Speed in rpm")))
    })
};

/// Byte 6 of a drive frame.
pub(crate) const ACCELERATION: Entry = Entry::whole(0, 255, |text, min, max| {
    whole(text, |byte| within(byte, min, max, tr!("Acceleration")))
});

/// Raw torque current.
pub(crate) const CURRENT: Entry = Entry {
    show: format::signed,
    step: 100.0,
    page: 1000.0,
    ..Entry::whole(CurrentTarget::MIN, CurrentTarget::MAX, |text, min, max| {
        whole(text, |raw| within(raw, min, max, tr!("Raw current")))
    })
};

/// Amps of the greatest raw torque current.
const AMPS_MAX: f32 = 8.0;

/// Amps per step of the raw torque current.
const AMPS_PER_RAW: f64 = AMPS_MAX as f64 / CurrentTarget::MAX as f64;

/// The same raw torque current, in amps.
pub(crate) const AMPS: Entry = Entry {
    min: CurrentTarget::MIN,
    max: CurrentTarget::MAX,
    read: amps,
    show: |raw| CurrentTarget::new(raw).map_or_else(|_| String::new(), format::amps_of_target),
    scale: AMPS_PER_RAW,
    step: 0.05,
    page: 0.5,
};

/// Raw output without a controller.
pub(crate) const OUTPUT: Entry = Entry {
    show: format::signed,
    step: 100.0,
    page: 1000.0,
    ..Entry::whole(
        OpenLoopTarget::MIN,
        OpenLoopTarget::MAX,
        |text, min, max| whole(text, |raw| within(raw, min, max, tr!("Raw output"))),
    )
};

/// Raw angle.
pub(crate) const POSITION: Entry = Entry {
    step: 100.0,
    page: 1000.0,
    ..Entry::whole(
        PositionTarget::MIN,
        PositionTarget::MAX,
        |text, min, max| whole(text, |raw| within(raw, min, max, tr!("Raw position"))),
    )
};

/// The same raw angle, in degrees.
pub(crate) const ANGLE: Entry = Entry {
    min: PositionTarget::MIN,
    max: PositionTarget::MAX,
    read: |text, _, _| degrees(text),
    show: |raw| PositionTarget::new(raw).map_or_else(|_| String::new(), format::angle_of),
    scale: DEGREES_PER_RAW,
    step: 1.0,
    page: 10.0,
};

/// Drive frames per second.
pub(crate) const RATE: Entry = Entry::whole(
    CommandRate::MIN as i32,
    CommandRate::MAX as i32,
    |text, min, max| {
        whole(text, |hertz| {
            within(hertz, min, max, tr!("Command rate in Hz"))
        })
    },
);

/// Speed at which a motor is stopped, in rpm.
pub(crate) const SPEED_LIMIT: Entry = Entry {
    step: 10.0,
    page: 50.0,
    ..Entry::whole(
        Limits::SPEED_RPM.0 as i32,
        Limits::SPEED_RPM.1 as i32,
        |text, min, max| whole(text, |rpm| within(rpm, min, max, tr!("Speed limit"))),
    )
};

/// Current at which a motor is stopped, in mA, shown in amps.
pub(crate) const CURRENT_LIMIT: Entry = Entry {
    min: Limits::CURRENT_MA.0 as i32,
    max: Limits::CURRENT_MA.1 as i32,
    read: milliamps,
    show: |milliamps| {
        let tenths = milliamps / 100;
        format::in_language(format!("{}.{}", tenths / 10, tenths % 10))
    },
    scale: 0.001,
    step: 0.1,
    page: 1.0,
};

/// Temperature at which a motor is stopped, in degrees Celsius.
pub(crate) const TEMPERATURE_LIMIT: Entry = Entry {
    page: 5.0,
    ..Entry::whole(
        Limits::TEMPERATURE_C.0 as i32,
        Limits::TEMPERATURE_C.1 as i32,
        |text, min, max| {
            whole(text, |degrees| {
                within(degrees, min, max, tr!("Temperature limit"))
            })
        },
    )
};

/// Amps, rounded to a tenth.
#[allow(
    clippy::cast_possible_truncation,
    reason = "a float cast saturates, and the value is in its range"
)]
fn milliamps(text: &str, least: i32, most: i32) -> Typed {
    let text = plain(text);
    if is_unfinished(&text) {
        return Typed::Unfinished;
    }
    let tenths = decimal(&text).map(|amps| (amps * 10.0).round() as i32);
    match tenths.map(|tenths| tenths.saturating_mul(100)) {
        Some(value) if (least..=most).contains(&value) => Typed::Value(value),
        Some(_) => Typed::Wrong(tr!(
            "Current limit must be 0.1 to {most} A, not {text}.",
            most = most / 1_000,
            text
        )),
        None => Typed::Wrong(tr!("Enter the current in amps.").to_owned()),
    }
}

fn within(value: i32, min: i32, max: i32, quantity: &str) -> Result<i32, String> {
    if (min..=max).contains(&value) {
        Ok(value)
    } else {
        Err(tr!(
            "{quantity} must be {min} to {max}, not {value}.",
            quantity,
            min,
            max,
            value
        ))
    }
}

/// The text without spaces and with an ASCII minus.
pub(crate) fn plain(text: &str) -> String {
    text.chars()
        .filter(|character| !character.is_whitespace())
        .map(|character| match character {
            '\u{2212}' | '–' => '-',
            ',' => '.',
            other => other,
        })
        .collect()
}

fn amps(text: &str, min: i32, max: i32) -> Typed {
    let text = plain(text);
    let text = text.trim_end_matches('A');
    if is_unfinished(text) {
        return Typed::Unfinished;
    }
    let Some(amps) = decimal(text) else {
        return Typed::Wrong(tr!("Enter the current in amps.").to_owned());
    };
    let raw = i32::from(CurrentTarget::from_amps(amps));
    // A range of whole amps ends between two raw numbers.
    let in_range = (min - 1..=max + 1).contains(&raw) && amps.abs() <= AMPS_MAX;
    if in_range {
        return Typed::Value(raw.clamp(min, max));
    }
    let end = |raw| CurrentTarget::new(raw).map_or_else(|_| String::new(), format::amps_of_target);
    Typed::Wrong(tr!(
        "Current must be {min} to {max} A, not {text}.",
        min = end(min),
        max = end(max),
        text
    ))
}

fn is_unfinished(text: &str) -> bool {
    matches!(text, "" | "-" | "+")
}

/// Parses a whole number that `check` accepts.
pub(crate) fn whole<E: ToString>(text: &str, check: impl Fn(i32) -> Result<i32, E>) -> Typed {
    let text = plain(text);
    if is_unfinished(&text) {
        return Typed::Unfinished;
    }
    match text.parse::<i32>() {
        Ok(value) => {
            check(value).map_or_else(|error| Typed::Wrong(error.to_string()), Typed::Value)
        }
        // A number that does not fit is far out of range: the message names the range instead of "no number".
        Err(_) if is_digits(text.trim_start_matches(['-', '+'])) => {
            let far = if text.starts_with('-') {
                i32::MIN
            } else {
                i32::MAX
            };
            check(far).map_or_else(|error| Typed::Wrong(error.to_string()), Typed::Value)
        }
        Err(_) => Typed::Wrong(tr!("Enter a whole number.").to_owned()),
    }
}

fn is_digits(text: &str) -> bool {
    text.bytes().all(|byte| byte.is_ascii_digit())
}

fn degrees(text: &str) -> Typed {
    let text = plain(text);
    let text = text.trim_end_matches('°');
    if is_unfinished(text) {
        return Typed::Unfinished;
    }
    match decimal(text) {
        Some(angle) if (0.0..=360.0).contains(&angle) => {
            Typed::Value(PositionTarget::from_degrees(angle).into())
        }
        Some(_) => Typed::Wrong(tr!("Angle must be 0 to 360 degrees, not {text}.", text)),
        None => Typed::Wrong(tr!("Enter the angle in degrees.").to_owned()),
    }
}

/// Parses a plain decimal number, to a thousandth. The parser of the standard library also handles exponents and
/// exact rounding, and adds 20 KB.
fn decimal(text: &str) -> Option<f32> {
    let (sign, digits) = match text.strip_prefix('-') {
        Some(digits) => (-1.0, digits),
        None => (1.0, text.strip_prefix('+').unwrap_or(text)),
    };
    let (whole, part) = digits.split_once('.').unwrap_or((digits, "0"));
    if !is_digits(whole) || !is_digits(part) || (whole.is_empty() && part.is_empty()) {
        return None;
    }
    let number = |digits: &str| {
        digits
            .bytes()
            .fold(0.0, |value, digit| value * 10.0 + f32::from(digit - b'0'))
    };
    let thousandths: String = part.chars().chain("000".chars()).take(3).collect();
    Some(sign * (number(whole) + number(&thousandths) / 1000.0))
}

#[cfg(test)]
#[path = "entry_tests.rs"]
mod tests;
