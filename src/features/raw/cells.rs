//! The bytes of an entered frame, each with its meaning.

use motorlink_i18n::tr;
use std::fmt::Write;

use motorlink_messages::protocol::{
    FRAME_LEN, Frame, RequestError,
    family::{self, Model},
};

use crate::{
    features::raw::editor::{Entered, Outcome, Piece, SET_ID, SWITCH_MODE, Tenth},
    ui::escape::escaped,
};

const DRIVE: u8 = 0x64;
const QUERY: u8 = 0x74;

/// Characters that a cell shows of an invalid byte.
const SHOWN_MAX: usize = 4;

/// The meaning of each byte, by the type of the frame.
fn labels(bytes: &[Piece], model: Model) -> [&'static str; FRAME_LEN] {
    let is_separate = model.has_separate_frames();
    let byte = |place: usize| match bytes.get(place) {
        Some(Piece::Byte(byte)) => Some(*byte),
        _ => None,
    };
    let (command, zero) = (tr!("command" as "byte"), tr!("zero" as "byte"));
    if [byte(0), byte(1), byte(2)] == SET_ID.map(Some) {
        let set_id = tr!("set ID");
        let last = if is_separate { "CRC" } else { tr!("no CRC") };
        let new_id = tr!("new ID");
        return [
            set_id, set_id, set_id, new_id, zero, zero, zero, zero, zero, last,
        ];
    }
    let mut labels = [
        "ID", command, zero, zero, zero, zero, zero, zero, zero, "CRC",
    ];
    match byte(1) {
        Some(DRIVE) => {
            labels[2] = tr!("value high");
            labels[3] = tr!("value low");
            labels[6] = tr!("accel" as "byte");
            labels[7] = tr!("brake" as "byte");
        }
        Some(SWITCH_MODE) if is_separate => labels[2] = tr!("mode" as "byte"),
        // Its mode takes the place of the CRC.
        Some(SWITCH_MODE) => labels[9] = tr!("mode" as "byte"),
        Some(QUERY) => {}
        _ => {
            labels[2] = tr!("byte 2");
            labels[3] = tr!("byte 3");
            labels[4] = tr!("byte 4");
            labels[5] = tr!("byte 5");
            labels[6] = tr!("byte 6");
            labels[7] = tr!("byte 7");
            labels[8] = tr!("byte 8");
        }
    }
    labels
}

/// Ten cells as HTML, each with a byte and its meaning. An invalid, doubtful or added byte has a mark and a text.
pub(crate) fn cells(entered: &Entered) -> String {
    let outcome = entered.outcome();
    let (doubt, tenth, added) = match &outcome {
        Outcome::Frame { frame, tenth } => {
            let [.., last] = frame.bytes();
            let added = matches!(tenth, Tenth::CrcAdded | Tenth::ZeroAdded).then_some(*last);
            let doubt = place_of_doubt(frame, entered.model());
            (doubt, Some(*tenth), added)
        }
        _ => (None, None, None),
    };
    let mut html = String::new();
    for (place, label) in labels(entered.pieces(), entered.model())
        .into_iter()
        .enumerate()
    {
        let piece = entered.pieces().get(place);
        let (mut class, mut label) = ("", label);
        let mut text = match piece {
            Some(Piece::Byte(byte)) => format!("{byte:02X}"),
            Some(Piece::Half(digit)) => format!("{digit}·"),
            Some(Piece::Wrong { text, .. }) => {
                (class, label) = (" wrong", tr!("invalid"));
                text.chars().take(SHOWN_MAX).collect()
            }
            None => "··".to_owned(),
        };
        if doubt == Some(place) {
            class = " doubtful";
        }
        if place == FRAME_LEN - 1 {
            if let Some(byte) = added {
                (class, text) = (" added", format!("{byte:02X}"));
            }
            label = match tenth {
                Some(Tenth::CrcAdded) => tr!("CRC added"),
                Some(Tenth::ZeroAdded) => tr!("added" as "byte"),
                Some(Tenth::WrongCrc { .. }) => tr!("bad CRC"),
                _ => label,
            };
        }
        if piece.is_none() && text == "··" {
            class = " empty";
        }
        let _ = write!(
            html,
            "<span class=\"cell{class}\"><span class=\"cell-name\">{label}</span> \
             <span class=\"cell-place\">{place}</span> <b>{}</b> </span>",
            escaped(&text)
        );
    }
    html
}

/// The index, from 0, of the byte with a value that the motor does not know.
fn place_of_doubt(frame: &Frame, model: Model) -> Option<usize> {
    let error = match family::Request::parse(model, frame).err()? {
        family::RequestError::Frame(error) => error,
        family::RequestError::Mode { .. } => return Some(2),
    };
    let is_set_id = frame.bytes().starts_with(&SET_ID);
    Some(match error {
        RequestError::NotZero { place } => place,
        RequestError::BadId(_) if is_set_id => 3,
        RequestError::BadId(_) => 0,
        RequestError::NotAssignable => 3,
        RequestError::UnknownCommand(_) => 1,
        RequestError::BadCrc { .. } | RequestError::BadMode(_) => FRAME_LEN - 1,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_always_ten_cells() {
        for text in [
            "",
            "01",
            "zz",
            "01 64 00 64 00 00 00 00 00",
            "00 00 00 00 00 00 00 00 00 00 00",
        ] {
            assert_eq!(
                cells(&Entered::read(text)).matches("<b>").count(),
                10,
                "{text}"
            );
        }
    }

    #[test]
    fn every_byte_is_labelled_with_its_meaning() {
        for (text, names) in [
            (
                "01 64 00 64 00 00 00 00 00 4F",
                "ID,command,value high,value low,zero,zero,accel,brake,zero,CRC",
            ),
            (
                "01 64 00 64 00 00 00 00 00",
                "ID,command,value high,value low,zero,zero,accel,brake,zero,CRC added",
            ),
            (
                "01 A0 00 00 00 00 00 00 00 02",
                "ID,command,zero,zero,zero,zero,zero,zero,zero,mode",
            ),
            (
                "AA 55 53 05",
                "set ID,set ID,set ID,new ID,zero,zero,zero,zero,zero,no CRC",
            ),
            (
                "01 74 00 zz",
                "ID,command,zero,invalid,zero,zero,zero,zero,zero,CRC",
            ),
        ] {
            let html = cells(&Entered::read(text));
            let found: Vec<&str> = html
                .split("cell-name\">")
                .skip(1)
                .map(|rest| rest.split_once('<').unwrap().0)
                .collect();
            assert_eq!(found.join(","), names, "{text}");
        }
    }

    #[test]
    fn what_is_wrong_doubtful_or_added_is_marked() {
        let html = |text| cells(&Entered::read(text));
        assert!(html("01 zz").contains("cell wrong"));
        assert!(html("01 64 00 64 07 00 00 00 00").contains("cell doubtful"));
        let added = html("01 64 00 64 00 00 00 00 00");
        assert!(added.contains("cell added"), "{added}");
        assert!(added.contains("<b>4F</b>"), "{added}");
        let wrong = html("01 64 00 64 00 00 00 00 00 5B");
        assert!(
            wrong.contains("doubtful") && wrong.contains("bad CRC"),
            "{wrong}"
        );
    }

    #[test]
    fn what_is_typed_never_becomes_a_tag() {
        let html = cells(&Entered::read("&lt;b&gt; &amp;x"));
        assert!(html.contains("<b>&amp;lt</b>"), "{html}");
        assert!(!html.contains("&lt;b"), "{html}");
    }

    #[test]
    fn a_frame_that_the_motor_does_not_know_is_doubted_at_its_byte() {
        for (text, place) in [
            ("01 64 00 64 00 00 00 00 00 4F", None),
            ("01 64 00 64 07 00 00 00 00", Some(4)),
            ("00 64 00 64 00 00 00 00 00", Some(0)),
            ("01 65 00 64 00 00 00 00 00", Some(1)),
            ("01 64 00 64 00 00 00 00 00 5B", Some(9)),
            ("01 A0 00 00 00 00 00 00 00 09", Some(9)),
            ("AA 55 53 C8 00 00 00 00 00 00", Some(3)),
            ("AA 55 53 FF 00 00 00 00 00 00", Some(3)),
        ] {
            let frame = Entered::read(text).frame().unwrap();
            assert_eq!(place_of_doubt(&frame, Model::Ddsm115), place, "{text}");
        }
    }
}
