//! The words of an entry, as a row of the packet log and its CSV show them.

use std::fmt::Write;

use motorlink_bus::{JunkBytes, LineEventKind};
use motorlink_i18n::{
    Language, current_language, family_terms, set_language, terms, tr, translate,
};
use motorlink_messages::recorder::Row;
use motorlink_protocol::{
    FRAME_LEN, Frame, Request, explain_received, explain_sent, family::Model,
};

use crate::{
    digits::{push_0x, push_hex},
    entry::{Entry, EntryContent},
    stored_texts::Texts,
    wall_clock::WallClock,
};

/// Adds the meaning of an entry in the current language.
pub(crate) fn push_meaning(out: &mut String, entry: &Entry, texts: &Texts) {
    // A million entries are searched while the user waits, mostly combined frames in English: for them, this allocates
    // no string per part.
    let is_plain = current_language() == Language::English && !entry.model.has_separate_frames();
    // Writing to a string does not fail.
    let _ = match &entry.content {
        EntryContent::Line(
            LineEventKind::Sent { frame, mode }
            | LineEventKind::SentByHand { frame, mode }
            | LineEventKind::RepeatedByHand { frame, mode },
        ) if is_plain => {
            write!(out, "{}", explain_sent(frame, *mode))
        }
        EntryContent::Line(LineEventKind::Received { frame, asked }) if is_plain => {
            write!(out, "{}", explain_received(frame, *asked))
        }
        EntryContent::Message { text, .. } => out.write_str(&translate(texts.get(*text))),
        EntryContent::Line(passed) => out.write_str(&translated(entry.model, passed)),
    };
}

fn translated(model: Model, passed: &LineEventKind) -> String {
    match passed {
        LineEventKind::Sent { frame, mode }
        | LineEventKind::SentByHand { frame, mode }
        | LineEventKind::RepeatedByHand { frame, mode } => family_terms::sent(model, frame, *mode),
        LineEventKind::Received { frame, asked } => family_terms::received(model, frame, *asked),
        // No entries.
        LineEventKind::Known { .. } | LineEventKind::ModelSelected(_) => String::new(),
        LineEventKind::Junk(junk) => match frame_of(junk) {
            Some(frame) if Request::set_id_of(&frame).is_some() => {
                let what = family_terms::sent(model, &frame, None);
                tr!("{what}, by another program", what)
            }
            Some(frame) => {
                let what = family_terms::received(model, &frame, None);
                tr!("{what}: dropped", what)
            }
            None => match junk.bytes().len() {
                1 => tr!("1 byte, no valid frame").to_owned(),
                count => tr!("{count} bytes, no valid frame", count),
            },
        },
        LineEventKind::Silence { waited_us, .. } => {
            let (millis, tenth) = to_tenths(*waited_us);
            let ms = terms::in_language(format!("{millis}.{tenth}"));
            tr!("no reply within {ms} ms", ms)
        }
        LineEventKind::NotSent { .. } => {
            tr!("not sent: adapter still busy with the previous frame").to_owned()
        }
    }
}

/// Junk that is as long as a frame.
fn frame_of(junk: &JunkBytes) -> Option<Frame> {
    let frame = <[u8; FRAME_LEN]>::try_from(junk.bytes()).ok()?;
    Some(Frame::new(frame))
}

/// Milliseconds and tenths, rounded: the resolution of a browser's clock.
fn to_tenths(micros: u32) -> (u64, u64) {
    let tenths = (u64::from(micros) + 50) / 100;
    (tenths / 10, tenths % 10)
}

/// The same in English, as in files, whatever language the page is shown in.
pub(crate) fn push_english(out: &mut String, entry: &Entry, texts: &Texts) {
    let shown_in = current_language();
    set_language(Language::English);
    push_meaning(out, entry, texts);
    set_language(shown_in);
}

/// Adds the ID of the motor that an entry concerns: `0x01`, or nothing.
pub(crate) fn push_id(out: &mut String, entry: &Entry) {
    if let Some(id) = entry.id() {
        push_0x(out, id.get());
    }
}

/// An entry as a row of the log.
pub(crate) fn row(entry: &Entry, texts: &Texts, clock: WallClock) -> Row {
    let mut row = Row {
        number: 0,
        kind: entry.kind(),
        time: String::new(),
        id: String::new(),
        hex: String::new(),
        meaning: String::new(),
        collapsed_before: 0,
        opened: 0,
    };
    clock.local(entry.at).push_time_of_day(&mut row.time);
    push_id(&mut row.id, entry);
    push_hex(&mut row.hex, entry.bytes());
    push_meaning(&mut row.meaning, entry, texts);
    row
}

#[cfg(test)]
mod tests {
    use motorlink_i18n::untranslated;
    use motorlink_protocol::{Instant, Layout, Mode, MotorId};

    use super::*;
    use crate::entry::Visibility;

    const fn entry(content: EntryContent) -> Entry {
        Entry {
            at: Instant::ZERO,
            content,
            model: Model::Ddsm115,
            routine: false,
            visibility: Visibility::Hidden,
        }
    }

    fn meaning(content: EntryContent, texts: &Texts) -> String {
        let mut out = String::new();
        push_meaning(&mut out, &entry(content), texts);
        out
    }

    fn passed(passed: LineEventKind) -> String {
        meaning(EntryContent::Line(passed), &Texts::default())
    }

    fn junk(text: &str) -> String {
        let bytes: Vec<u8> = text
            .split(' ')
            .map(|byte| u8::from_str_radix(byte, 16).unwrap())
            .collect();
        passed(LineEventKind::Junk(JunkBytes::new(&bytes)))
    }

    #[test]
    fn frames_have_the_same_text_as_elsewhere() {
        let frame = "01 64 00 64 00 00 00 00 00 4F".parse().unwrap();
        let mode = Some(Mode::Velocity);
        assert_eq!(
            passed(LineEventKind::Sent { frame, mode }),
            "drive +100 rpm"
        );
        let frame = "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap();
        let asked = Some(Layout::Drive);
        assert_eq!(
            passed(LineEventKind::Received { frame, asked }),
            "+100 rpm, +0.175 A, 66.96°"
        );
    }

    #[test]
    fn junk_has_the_reason_it_was_dropped() {
        assert_eq!(
            junk("01 02 02 CD 00 64 17 CF 00 5B"),
            "CRC 5B, expected 8F: dropped"
        );
        assert_eq!(junk("01 02 03"), "3 bytes, no valid frame");
        assert_eq!(junk("FF"), "1 byte, no valid frame");
    }

    #[test]
    fn a_set_id_frame_of_another_program_is_named_with_any_ending() {
        for last in ["00", "92", "DE"] {
            let said = junk(&format!("AA 55 53 02 00 00 00 00 00 {last}"));
            assert_eq!(said, "set ID 0x02 on all motors, by another program");
        }
        let frame = "AA 55 53 02 00 00 00 00 00 DE".parse().unwrap();
        let sent = LineEventKind::SentByHand { frame, mode: None };
        assert_eq!(passed(sent), "set ID 0x02 on all motors");
        let wrong = junk("AA 55 53 02 00 00 00 00 00 11");
        assert!(wrong.ends_with(": dropped"), "{wrong}");
    }

    #[test]
    fn silence_has_its_duration() {
        let silence = |waited_us| {
            let id = MotorId::FIRST;
            passed(LineEventKind::Silence { id, waited_us })
        };
        assert_eq!(silence(8_000), "no reply within 8.0 ms");
        assert_eq!(silence(25_050), "no reply within 25.1 ms");
        assert_eq!(silence(999), "no reply within 1.0 ms");
    }

    #[test]
    fn frames_of_each_model_are_explained_in_its_units() {
        let said = |model, kind| {
            let entry = Entry {
                model,
                ..entry(EntryContent::Line(kind))
            };
            let mut out = String::new();
            push_meaning(&mut out, &entry, &Texts::default());
            out
        };
        let frame = "01 64 01 F4 00 00 00 00 00 C3".parse().unwrap();
        let sent = LineEventKind::Sent {
            frame,
            mode: Some(Mode::Velocity),
        };
        assert_eq!(said(Model::Ddsm115, sent), "drive +500 rpm");
        assert_eq!(said(Model::Ddsm210, sent), "drive +50 rpm");
        let received = |body| LineEventKind::Received {
            frame: Frame::with_crc(body),
            asked: None,
        };
        let drive = received([1, 0x65, 0x01, 0xF5, 0x20, 0, 0, 30, 0]);
        assert_eq!(said(Model::Ddsm400, drive), "+50.1 rpm, +1.000 A, 30 °C");
        let odometry = received([1, 0x74, 0, 0, 0, 3, 0x20, 0, 0]);
        assert_eq!(said(Model::Ddsm210, odometry), "3 turns, 90.00°");
        let noise = LineEventKind::Junk(JunkBytes::new(&[1, 0x64, 0, 0, 0, 0, 0, 0, 0, 0]));
        assert!(said(Model::Ddsm210, noise).ends_with(": dropped"));
        set_language(Language::German);
        assert_eq!(said(Model::Ddsm400, drive), "+50,1 U/min, +1,000 A, 30 °C");
        let mut file = String::new();
        let entry = Entry {
            model: Model::Ddsm400,
            ..entry(EntryContent::Line(drive))
        };
        push_english(&mut file, &entry, &Texts::default());
        assert_eq!(file, "+50.1 rpm, +1.000 A, 30 °C");
    }

    #[test]
    fn every_entry_is_in_the_current_language() {
        set_language(Language::German);
        let frame = "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap();
        let asked = Some(Layout::Drive);
        assert_eq!(
            passed(LineEventKind::Received { frame, asked }),
            "+100 U/min, +0,175 A, 66,96°"
        );
        assert!(junk("FF").starts_with("1 ") && !junk("FF").contains("frame is"));
        let id = MotorId::FIRST;
        let waited_us = 8_000;
        assert!(passed(LineEventKind::Silence { id, waited_us }).contains("8,0 ms"));
    }

    #[test]
    fn a_message_of_the_page_follows_the_language_and_is_english_in_files() {
        let mut texts = Texts::default();
        let id = MotorId::FIRST;
        let text = texts.keep(&untranslated(|| tr!("Motor {id}: brake on", id)));
        let message = EntryContent::Message { error: false, text };
        let said = || tr!("Motor {id}: brake on", id);
        for language in Language::ALL {
            set_language(language);
            assert_eq!(meaning(message, &texts), said());
            let mut file = String::new();
            push_english(&mut file, &entry(message), &texts);
            assert_eq!(file, "Motor 0x01: brake on");
        }
        let text = texts.keep("Arm v1.2");
        let message = EntryContent::Message { error: false, text };
        assert_eq!(meaning(message, &texts), "Arm v1.2");
    }
}
