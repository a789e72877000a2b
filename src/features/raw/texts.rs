//! Texts of an entered frame: its meaning, its errors and its result.

use crate::{
    features::raw::editor::{Entered, Outcome, Piece, Tenth, Why},
    ui::format,
};
use motorlink_i18n::{family_terms, tr};
use motorlink_messages::{
    bus::{RawAnswer, RawStatus, unassignable_id},
    protocol::{
        Frame, Mode, MotorId,
        family::{Model, Request},
    },
};

/// Characters that are quoted of an invalid byte.
const SHOWN_MAX: usize = 12;

/// The meaning of the frame, or what is missing or wrong.
///
/// `chosen` is the chosen motor and its reported loop, which gives the value of a drive frame its unit.
pub(crate) fn meaning(entered: &Entered, chosen: Option<(MotorId, Mode)>) -> String {
    match entered.outcome() {
        Outcome::Nothing => tr!(
            "Enter 9 bytes to have the CRC added, or 10 to send them unchanged. You can paste \
                 log lines."
        )
        .to_owned(),
        Outcome::TooFew(9) => tr!("Byte 9 needs one more digit.").to_owned(),
        Outcome::TooFew(bytes) => {
            tr!("{bytes} of 9 bytes; the CRC is added as byte 9.", bytes)
        }
        Outcome::LoopMissing => tr!(
            "Byte 9 of a mode switch is the loop, not a CRC. Enter 01 (current), 02 (velocity) \
                 or 03 (position)."
        )
        .to_owned(),
        Outcome::Wrong(place) => match entered.pieces().get(place) {
            Some(Piece::Wrong { text, why }) => what_is_wrong(place, text, *why),
            _ => String::new(),
        },
        Outcome::Frame { frame, tenth } => said(&frame, tenth, chosen, entered.model()),
    }
}

fn what_is_wrong(place: usize, text: &str, why: Why) -> String {
    let text: String = text.chars().take(SHOWN_MAX).collect();
    let why = match why {
        Why::NotHex => tr!("is not hex: use two digits, 0-9 or A-F"),
        Why::OneDigit => tr!("has one digit: a byte has two"),
        Why::NoDigits => tr!("needs hex digits after it"),
        Why::ManyDigits => tr!("has more than two digits: separate bytes with spaces"),
        Why::NotOneLogLine => {
            return tr!(
                "“{text}” is part of a log line: paste one whole line or only the bytes.",
                text
            );
        }
        Why::Surplus => tr!("is one too many: a frame has ten bytes, 0 to 9"),
    };
    tr!("Byte {place}: “{text}” {why}.", place, text, why)
}

fn said(frame: &Frame, tenth: Tenth, chosen: Option<(MotorId, Mode)>, model: Model) -> String {
    let request = Request::parse(model, frame);
    let to = request.ok().and_then(|request| request.addressee());
    let mode = chosen.filter(|(id, _)| Some(*id) == to);
    let meaning = family_terms::sent(model, frame, mode.map(|(_, mode)| mode));
    let mut words = match to {
        Some(id) => tr!("To motor {id}: {meaning}.", id, meaning),
        None => format!("{}.", format::capitalized(&meaning)),
    };
    let rest = match (request.is_ok(), tenth) {
        // The reason why it is not sent is shown at the button.
        (false, _) if unassignable_id(frame).is_some() => return words,
        (false, _) => tr!("The frame is sent unchanged."),
        (true, Tenth::ZeroAdded | Tenth::NoCrc) => tr!("The frame has no CRC and gets no reply."),
        (true, Tenth::Loop) => tr!("Byte 9 is the loop: the frame has no CRC and gets no reply."),
        (true, _) => return words,
    };
    words.push(' ');
    words.push_str(rest);
    words
}

/// How often a frame was sent, and the last reply.
pub(crate) fn sent(raw: &RawStatus) -> String {
    let RawStatus {
        count,
        sent,
        answered,
        ..
    } = raw;
    if *count == 1 {
        let words = match (sent, raw.running) {
            (0, true) => tr!("Sending"),
            (0, false) => tr!("Stopped before sending"),
            _ => tr!("Sent once"),
        };
        return words.to_owned();
    }
    let state = if raw.running {
        tr!("Repeating: sent")
    } else if *count == 0 || sent < count {
        tr!("Stopped: sent")
    } else {
        tr!("Sent")
    };
    match count {
        0 => tr!("{state} {sent}, replies: {answered}", state, sent, answered),
        count => tr!(
            "{state} {sent} of {count}, replies: {answered}",
            state,
            sent,
            count,
            answered
        ),
    }
}

/// The reply to the last frame.
pub(crate) fn answer(raw: &RawStatus, model: Model) -> String {
    match raw.last {
        None => String::new(),
        Some(RawAnswer::Reply {
            frame,
            asked,
            after_us,
        }) => {
            let from = frame.bytes().first().copied().unwrap_or_default();
            tr!(
                "{frame}\nFrom {from} after {ms} ms: {meaning}",
                frame,
                from = format!("0x{from:02X}"),
                ms = format::milliseconds(after_us),
                meaning = family_terms::received(model, &frame, asked)
            )
        }
        Some(RawAnswer::Garbled) => {
            tr!("Bytes received, but no valid reply: several motors at once, or noise.").to_owned()
        }
        Some(RawAnswer::NoneExpected) => tr!("Sent. This frame gets no reply.").to_owned(),
        Some(RawAnswer::NotSent) => {
            tr!("Not sent: the adapter is busy. Press Send again.").to_owned()
        }
        Some(RawAnswer::Silence { waited_us }) => {
            tr!(
                "No reply within {ms} ms.",
                ms = format::milliseconds(waited_us)
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::protocol::Layout;

    use super::*;

    const ID: MotorId = MotorId::FIRST;

    fn words(text: &str) -> String {
        meaning(&Entered::read(text), Some((ID, Mode::Velocity)))
    }

    #[test]
    fn a_frame_is_said_in_words() {
        for (text, wanted) in [
            (
                "01 64 00 64 00 00 00 00 00",
                "To motor 0x01: drive +100 rpm.",
            ),
            (
                "02 64 00 64 00 00 00 00 00",
                "To motor 0x02: drive, value 100.",
            ),
            (
                "01 74 00 00 00 00 00 00 00",
                "To motor 0x01: feedback query.",
            ),
            ("C8 64 00 00 00 00 00 00 00", "ID query to all motors."),
            (
                "AA 55 53 05 00 00 00 00 00",
                "Set ID 0x05 on all motors. The frame has no CRC and gets no reply.",
            ),
            (
                "01 A0 00 00 00 00 00 00 00 01",
                "To motor 0x01: switch to the current loop. Byte 9 is the loop: the frame has no CRC and \
                 gets no reply.",
            ),
            (
                "01 64 00 64 00 00 00 00 00 5B",
                "CRC 5B, expected 4F. The frame is sent unchanged.",
            ),
            (
                "AA 55 53 00 00 00 00 00 00",
                "0 is not a valid ID: use 1 to 254.",
            ),
        ] {
            assert_eq!(words(text), wanted);
        }
    }

    #[test]
    fn a_frame_for_another_model_is_said_in_its_units_and_always_has_a_crc() {
        let words = |text| {
            let entered = Entered::read(text).for_model(Model::Ddsm400);
            meaning(&entered, Some((ID, Mode::Velocity)))
        };
        for (text, wanted) in [
            (
                "01 64 01 F4 00 00 00 00 00",
                "To motor 0x01: drive +50 rpm.",
            ),
            (
                "01 A0 02 00 00 00 00 00 00",
                "To motor 0x01: switch to the velocity loop.",
            ),
            ("01 A0 08 00 00 00 00 00 00 6F", "To motor 0x01: enable."),
            ("AA 55 53 05 00 00 00 00 00", "Set ID 0x05 on all motors."),
            (
                "01 A0 02 00 00 00 00 00 00 02",
                "CRC 02, expected E4. The frame is sent unchanged.",
            ),
        ] {
            assert_eq!(words(text), wanted);
        }
    }

    #[test]
    fn what_is_wrong_is_said_with_its_byte_and_characters() {
        for (text, wanted) in [
            ("01 74 0G", "Byte 2: “0G” is not hex"),
            ("01 7 00", "Byte 1: “7” has one digit"),
            (
                "01 64 00 64 00 00 00 00 00 4F FF",
                "Byte 10: “FF” is one too many",
            ),
            ("01 74 00", "3 of 9 bytes"),
            (
                "01 74 00 00 00 00 00 00 00 0",
                "Byte 9 needs one more digit",
            ),
            ("01 A0 00 00 00 00 00 00 00", "is the loop, not a CRC"),
        ] {
            assert!(
                words(text).starts_with(wanted) || words(text).contains(wanted),
                "{}",
                words(text)
            );
        }
    }

    fn status(text: &str, count: u32, last: RawAnswer) -> RawStatus {
        RawStatus {
            frame: Entered::read(text).frame().unwrap(),
            count,
            sent: 3,
            answered: 2,
            running: count == 0,
            last: Some(last),
        }
    }

    #[test]
    fn an_answer_or_its_absence_is_said() {
        let query = "01 74 00 00 00 00 00 00 00";
        let reply = RawAnswer::Reply {
            frame: "01 02 00 0A 00 00 20 F6 00 4A".parse().unwrap(),
            asked: Some(Layout::Query),
            after_us: 2_430,
        };
        let words = answer(&status(query, 1, reply), Model::Ddsm115);
        assert!(
            words.starts_with("01 02 00 0A 00 00 20 F6 00 4A\nFrom 0x01 after 2.5 ms: "),
            "{words}"
        );
        assert!(words.contains("32 °C"), "{words}");

        let silence = RawAnswer::Silence { waited_us: 8_000 };
        assert_eq!(
            answer(&status(query, 1, silence), Model::Ddsm115),
            "No reply within 8.0 ms."
        );
        let switch = "01 A0 00 00 00 00 00 00 00 02";
        let unanswered = RawAnswer::NoneExpected;
        assert!(answer(&status(switch, 1, unanswered), Model::Ddsm115).contains("gets no reply"));
        assert!(
            answer(&status(query, 1, RawAnswer::Garbled), Model::Ddsm115)
                .contains("no valid reply")
        );
    }

    #[test]
    fn a_repeat_says_how_often_and_whether_it_goes_on() {
        let raw = |count| status("01 74 00 00 00 00 00 00 00", count, RawAnswer::Garbled);
        assert_eq!(sent(&raw(1)), "Sent once");
        assert_eq!(sent(&raw(3)), "Sent 3 of 3, replies: 2");
        assert_eq!(sent(&raw(0)), "Repeating: sent 3, replies: 2");
        let running = |count, running| RawStatus {
            running,
            ..raw(count)
        };
        assert_eq!(
            sent(&running(10, true)),
            "Repeating: sent 3 of 10, replies: 2"
        );
        assert_eq!(
            sent(&running(10, false)),
            "Stopped: sent 3 of 10, replies: 2"
        );
        assert_eq!(sent(&running(0, false)), "Stopped: sent 3, replies: 2");
    }
}
