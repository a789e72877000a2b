//! Formats numbers for the page: a sign for directions, a typographic minus, a dash for unknown.

use std::time::Duration;

pub(crate) use motorlink_i18n::terms::{in_language, rpm};
use motorlink_i18n::tr;
use motorlink_messages::protocol::{Current, CurrentTarget, PositionTarget, Rpm, Setpoint};

/// Shown for an unknown value. Unknown is not zero.
pub(crate) const UNKNOWN: &str = "–";

/// The typographic minus, as wide as the plus, so that a number keeps its width when its sign changes.
const MINUS: char = '\u{2212}';

/// A narrow space without line breaks.
const GROUP_SPACE: char = '\u{202F}';

/// `2.7`, `0.125`: amps from milliamps, with one decimal if that is exact.
pub(crate) fn milliamps(milliamps: u16) -> String {
    let (amps, rest) = (milliamps / 1_000, milliamps % 1_000);
    in_language(if rest.is_multiple_of(100) {
        format!("{amps}.{}", rest / 100)
    } else {
        format!("{amps}.{rest:03}")
    })
}

/// `+100`, `−50`, `0`
pub(crate) fn signed(value: i32) -> String {
    match value {
        0 => "0".to_owned(),
        1.. => format!("+{value}"),
        _ => format!("{MINUS}{}", value.unsigned_abs()),
    }
}

/// `0.50`: with so many decimals.
pub(crate) fn fixed(value: f32, decimals: usize) -> String {
    // As `f64`, like every other number of the page: to write both adds 1 KB to the first visit.
    format!("{:.decimals$}", f64::from(value))
}

/// `+0.18`, `−0.50`, `0.00`: a value that rounds to zero has no sign.
pub(crate) fn signed_decimal(value: f32, decimals: usize) -> String {
    let digits = fixed(value.abs(), decimals);
    let is_zero = digits.bytes().all(|byte| matches!(byte, b'0' | b'.'));
    let digits = in_language(digits);
    if is_zero {
        return digits;
    }
    let sign = if value < 0.0 { MINUS } else { '+' };
    format!("{sign}{digits}")
}

/// `+100`
pub(crate) fn speed(speed: Rpm) -> String {
    signed(speed.rpm().into())
}

/// `+100 rpm`, in the unit of the language.
pub(crate) fn speed_in_rpm(speed: Rpm) -> String {
    in_rpm(speed.rpm().into())
}

fn in_rpm(value: i32) -> String {
    tr!("{speed} rpm", speed = signed(value))
}

/// `+0.18`, in amps.
pub(crate) fn current(current: Current) -> String {
    signed_decimal(current.amps(), 2)
}

/// `+0.18` and `A`; where the scale is not certain, the raw number and `raw`.
pub(crate) fn current_in(value: Current, is_certain: bool) -> (String, &'static str) {
    if is_certain {
        (current(value), "A")
    } else {
        (signed(value.raw().into()), tr!("raw"))
    }
}

/// Torque of a DDSM115 per current: its data sheet, 0.96 N·m at 1.25 A.
const TORQUE_NM_PER_A: f32 = 0.75;

/// `+2.44 A`
pub(crate) fn amps_of(target: CurrentTarget) -> String {
    format!("{} A", amps_of_target(target))
}

/// `+2.44`, in amps.
pub(crate) fn amps_of_target(target: CurrentTarget) -> String {
    signed_decimal(target.amps(), 2)
}

/// `+1.83 N·m`: the torque of a DDSM115.
pub(crate) fn torque_of(target: CurrentTarget) -> String {
    format!("{} N·m", signed_decimal(target.amps() * TORQUE_NM_PER_A, 2))
}

/// `90.0`: as few decimals as give the same target again. The raw number nearest to 180 degrees is 180.005 degrees.
pub(crate) fn angle_of(target: PositionTarget) -> String {
    let tenths = (target.degrees() * 10.0).round() / 10.0;
    let decimals = if PositionTarget::from_degrees(tenths) == target {
        1
    } else {
        2
    };
    in_language(fixed(target.degrees(), decimals))
}

/// `+100 rpm`, `brake`, `+0.50 A`, `90.0°`: a setpoint.
pub(crate) fn goal(setpoint: Setpoint) -> String {
    match setpoint {
        Setpoint::Velocity { speed, .. } => in_rpm(speed.rpm().into()),
        Setpoint::Brake => tr!("brake").to_owned(),
        Setpoint::Current(target) => amps_of(target),
        Setpoint::OpenLoop(target) => in_language(target.to_string()),
        Setpoint::Position(target) => in_language(fixed(target.degrees(), 1) + "°"),
    }
}

/// `0.1 s`, `2.5 s`, `12 s`, `3 min`: the age of a reading, rounded up so that it never looks newer.
pub(crate) fn age(age: Duration) -> String {
    let tenths = age.as_secs() * 10 + u64::from(age.subsec_nanos().div_ceil(100_000_000));
    let tenths = tenths.max(1);
    match tenths {
        0..100 => in_language(format!("{}.{} s", tenths / 10, tenths % 10)),
        100..1200 => format!("{} s", tenths.div_ceil(10)),
        _ => format!("{} min", tenths.div_ceil(600)),
    }
}

/// The text with a capital first letter, for the start of a sentence. The page's texts begin with ASCII.
pub(crate) fn capitalized(text: &str) -> String {
    let mut text = text.to_owned();
    if let Some(first) = text.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    text
}

/// `18 402`, in groups of three.
pub(crate) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(GROUP_SPACE);
        }
        text.push(digit);
    }
    text
}

/// `00:02:13`, hours, minutes and seconds from milliseconds.
pub(crate) fn stopwatch(millis: u64) -> String {
    let seconds = millis / 1000;
    let (hours, minutes) = (seconds / 3600, seconds / 60 % 60);
    format!("{hours:02}:{minutes:02}:{:02}", seconds % 60)
}

/// `2.9`, milliseconds from microseconds.
pub(crate) fn milliseconds(micros: u32) -> String {
    let tenths = micros.div_ceil(100);
    in_language(format!("{}.{}", tenths / 10, tenths % 10))
}

/// `0.4`, percent from per mille.
pub(crate) fn percent(per_mille: u16) -> String {
    in_language(format!("{}.{}", per_mille / 10, per_mille % 10))
}

#[cfg(test)]
mod tests {
    use motorlink_i18n::{Language, set_language};
    use motorlink_messages::protocol::SpeedTarget;

    use super::*;

    #[test]
    fn a_number_has_its_sign_and_a_real_minus() {
        for (value, text) in [(100, "+100"), (0, "0"), (-330, "\u{2212}330")] {
            assert_eq!(signed(value), text);
        }
        for (value, text) in [
            (0.175, "+0.17"),
            (-0.5, "\u{2212}0.50"),
            (-0.004, "0.00"),
            (0.0, "0.00"),
        ] {
            assert_eq!(signed_decimal(value, 2), text);
        }
    }

    #[test]
    fn an_age_never_looks_newer_than_it_is() {
        for (millis, text) in [
            (0, "0.1 s"),
            (16, "0.1 s"),
            (101, "0.2 s"),
            (2_450, "2.5 s"),
            (9_999, "10 s"),
            (10_000, "10 s"),
            (10_001, "11 s"),
            (59_000, "59 s"),
            (120_000, "2 min"),
            (120_001, "3 min"),
            (185_000, "4 min"),
        ] {
            assert_eq!(age(Duration::from_millis(millis)), text);
        }
        assert_eq!(age(Duration::from_micros(100_001)), "0.2 s");
    }

    #[test]
    fn the_link_is_shown_in_tenths() {
        assert_eq!(milliseconds(2_870), "2.9");
        assert_eq!(percent(4), "0.4");
        assert_eq!(percent(1000), "100.0");
    }

    #[test]
    fn large_numbers_are_grouped() {
        for (number, text) in [
            (0, "0"),
            (999, "999"),
            (1_000, "1\u{202F}000"),
            (18_402, "18\u{202F}402"),
            (1_000_000, "1\u{202F}000\u{202F}000"),
        ] {
            assert_eq!(grouped(number), text);
        }
        assert_eq!(stopwatch(133_900), "00:02:13");
        assert_eq!(stopwatch(36_000_000), "10:00:00");
    }

    #[test]
    fn targets_are_shown_in_the_units_people_think_in() {
        assert_eq!(amps_of(CurrentTarget::new(10_000).unwrap()), "+2.44 A");
        for (degrees, text) in [(90.0, "90.0"), (180.0, "180.0"), (12.34, "12.34")] {
            assert_eq!(angle_of(PositionTarget::from_degrees(degrees)), text);
        }
        assert_eq!(goal(Setpoint::Current(CurrentTarget::ZERO)), "0.00 A");
        assert_eq!(goal(Setpoint::velocity(SpeedTarget::ZERO)), "0 rpm");
    }

    #[test]
    fn a_speed_has_the_unit_of_the_language() {
        let goal = || goal(Setpoint::velocity(SpeedTarget::clamped(-50)));
        for (language, unit) in [(Language::Chinese, "rpm"), (Language::German, "U/min")] {
            set_language(language);
            assert_eq!(goal(), format!("\u{2212}50 {unit}"));
            assert_eq!(speed_in_rpm(Rpm::new(100)), format!("+100 {unit}"));
        }
    }
}
