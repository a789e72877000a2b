//! The fields of the tools: the new ID of a motor, how often a frame is repeated, and the ramp.

use crate::{
    model::terms,
    ui::entry::{Entry, Typed, plain, whole},
};
use motorlink_i18n::tr;
use motorlink_messages::{
    bus::{Ramp, RawInterval},
    protocol::{AssignableId, MotorId, MotorIdError},
};

/// The value while no new ID is entered; no motor has it.
pub(crate) const NO_NEW_ID: i32 = 0;

/// 35 minutes at the shortest interval. For more, the frame can be repeated until stopped.
const COUNT_MAX: i32 = 1_000_000;

/// The new ID of a motor, decimal or in hex with 0x.
pub(crate) const NEW_ID: Entry = Entry {
    show: |id| match id {
        NO_NEW_ID => String::new(),
        id => id.to_string(),
    },
    ..Entry::whole(
        MotorId::FIRST.get() as i32,
        MotorId::LAST.get() as i32,
        |text, _, _| new_id(text),
    )
};

/// How often a frame is sent; 0 is until stopped.
pub(crate) const COUNT: Entry = Entry::whole(0, COUNT_MAX, |text, _, _| {
    whole(text, |count| {
        let fits = (0..=COUNT_MAX).contains(&count);
        fits.then_some(count)
            .ok_or(tr!("Enter 0 to 1\u{202F}000\u{202F}000."))
    })
});

/// Milliseconds between two of them.
pub(crate) const INTERVAL: Entry = Entry::whole(
    RawInterval::MIN_MS as i32,
    RawInterval::MAX_MS as i32,
    |text, _, _| {
        whole(text, |millis| {
            let fits = interval(millis).is_some();
            fits.then_some(millis)
                .ok_or(tr!("Enter 2 to 60\u{202F}000."))
        })
    },
);

/// The ramp in rpm per second; 0 is none.
pub(crate) const RAMP: Entry = Entry {
    step: 10.0,
    page: 100.0,
    ..Entry::whole(0, Ramp::MAX as i32, |text, _, _| {
        if text.trim().is_empty() {
            return Typed::Value(0);
        }
        whole(text, |rpm| {
            let fits = (0..=Ramp::MAX.into()).contains(&rpm);
            fits.then_some(rpm).ok_or(tr!("Enter 0 to 10\u{202F}000."))
        })
    })
};

/// The entered interval.
pub(crate) fn interval(millis: i32) -> Option<RawInterval> {
    RawInterval::new(u16::try_from(millis).ok()?).ok()
}

/// The entered ID; `None` before one is entered.
pub(crate) fn assignable(id: i32) -> Option<AssignableId> {
    check(id).ok()
}

fn check(id: i32) -> Result<AssignableId, &'static str> {
    let byte = u8::try_from(id).map_err(|_| terms::no_motor_id(MotorIdError::TooLarge))?;
    let id = MotorId::new(byte).map_err(terms::no_motor_id)?;
    AssignableId::new(id).map_err(terms::not_assignable)
}

fn new_id(text: &str) -> Typed {
    let text = plain(text);
    let digits = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"));
    let Some(digits) = digits else {
        let number = text.trim_start_matches(['-', '+']);
        return if number.bytes().all(|digit| digit.is_ascii_digit()) {
            whole(&text, |id| check(id).map(|_| id))
        } else {
            Typed::Wrong(tr!("Enter a number, such as 5 or 0x05.").to_owned())
        };
    };
    if digits.is_empty() {
        return Typed::Unfinished;
    }
    let is_hex = digits.bytes().all(|digit| digit.is_ascii_hexdigit());
    match i32::from_str_radix(digits, 16) {
        Ok(id) if is_hex => {
            check(id).map_or_else(|error| Typed::Wrong(error.to_owned()), |_| Typed::Value(id))
        }
        Err(_) if is_hex => Typed::Wrong(terms::no_motor_id(MotorIdError::TooLarge).to_owned()),
        _ => Typed::Wrong(tr!("Enter hex digits after 0x, such as 0x0A.").to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wrong(text: &str) -> String {
        match NEW_ID.read(text) {
            Typed::Wrong(words) => words,
            typed => panic!("{text} is {typed:?}"),
        }
    }

    #[test]
    fn a_new_id_is_decimal_or_hex() {
        for (text, id) in [
            ("5", 5),
            (" 254 ", 254),
            ("0x0A", 10),
            ("0Xfe", 254),
            ("0x5", 5),
            ("201", 201),
            ("010", 10),
        ] {
            assert_eq!(NEW_ID.read(text), Typed::Value(id), "{text}");
        }
        for text in ["", "0x", " "] {
            assert_eq!(NEW_ID.read(text), Typed::Unfinished, "{text:?}");
        }
    }

    #[test]
    fn an_id_that_no_motor_may_get_is_refused_with_the_reason() {
        for (text, why) in [
            ("0", "0 is not a valid ID"),
            ("0x00", "0 is not a valid ID"),
            ("255", "1 to 254"),
            ("0xFF", "1 to 254"),
            ("0x100000000", "1 to 254"),
            ("99999999999", "1 to 254"),
            ("-1", "1 to 254"),
            ("200", "ID query"),
            ("0xC8", "ID query"),
            ("0xG1", "hex digits"),
            ("0x-5", "hex digits"),
            ("C8", "such as 5 or 0x05"),
            ("five", "such as 5 or 0x05"),
        ] {
            let words = wrong(text);
            assert!(words.contains(why), "{text}: {words}");
            assert!(words.ends_with('.'), "{words}");
        }
    }

    #[test]
    fn nothing_entered_is_shown_as_nothing_and_stepped_from() {
        assert_eq!((NEW_ID.show)(NO_NEW_ID), "");
        assert_eq!(assignable(NO_NEW_ID), None);
        assert_eq!(assignable(200), None);
        assert_eq!(assignable(5).unwrap().id().get(), 5);
        assert_eq!(NEW_ID.moved(NO_NEW_ID, NEW_ID.step), 1);
    }

    #[test]
    fn no_ramp_is_zero_or_nothing() {
        for (text, rpm) in [("", 0), ("0", 0), (" 1 ", 1), ("10000", 10_000)] {
            assert_eq!(RAMP.read(text), Typed::Value(rpm), "{text:?}");
        }
        for text in ["-1", "10001", "x"] {
            assert!(matches!(RAMP.read(text), Typed::Wrong(_)), "{text}");
        }
    }

    #[test]
    fn a_repeat_is_kept_in_the_range_of_the_bus() {
        assert_eq!(COUNT.read("0"), Typed::Value(0));
        assert_eq!(
            COUNT.read("1000001"),
            Typed::Wrong("Enter 0 to 1\u{202F}000\u{202F}000.".to_owned())
        );
        assert_eq!(INTERVAL.read("60000"), Typed::Value(60_000));
        for text in ["1", "60001", "-5", "99999999999"] {
            assert_eq!(
                INTERVAL.read(text),
                Typed::Wrong("Enter 2 to 60\u{202F}000.".to_owned()),
                "{text}"
            );
        }
        assert_eq!(interval(2).unwrap().millis(), 2);
        assert_eq!(interval(1), None);
    }
}
