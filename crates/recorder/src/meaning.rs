//! The text of an entry.

use std::fmt::Write;

use motorlink_bus::{JunkBytes, LineEventKind};
use motorlink_i18n::{Language, current_language, set_language, terms, tr, translate};
use motorlink_messages::recorder::Row;
use motorlink_protocol::{Explained, FRAME_LEN, Frame, explain_received, explain_sent};

use crate::{
    digits::{push_0x, push_decimal, push_hex},
    entry::{Entry, EntryContent},
    texts::Texts,
    wall_clock::WallClock,
};

/// Adds the meaning of an entry in the current language.
pub(crate) fn push_meaning(out: &mut String, entry: &Entry, texts: &Texts) {
    // A million entries are searched while the user waits, mostly in English: this path allocates no
    // string per part.
    if current_language() == Language::English {
        return push_english(out, entry, texts);
    }
    match &entry.content {
        EntryContent::Message { text, .. } => out.push_str(&translate(texts.get(*text))),
        EntryContent::Line(passed) => out.push_str(&translated(passed)),
    }
}

fn translated(passed: &LineEventKind) -> String {
    match passed {
        LineEventKind::Sent { frame, mode }
        | LineEventKind::SentByHand { frame, mode }
        | LineEventKind::RepeatedByHand { frame, mode }
        | LineEventKind::Commanded { frame, mode } => terms::explained(explain_sent(frame, *mode)),
        LineEventKind::Received { frame, asked } | LineEventKind::Reading { frame, asked } => {
            terms::explained(explain_received(frame, *asked))
        }
        LineEventKind::Junk(junk) => match explained_junk(junk) {
            Some(explained) => tr!("{what}: dropped", what = terms::explained(explained)),
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

/// The explanation of junk that is as long as a frame.
fn explained_junk(junk: &JunkBytes) -> Option<Explained> {
    let frame = <[u8; FRAME_LEN]>::try_from(junk.bytes()).ok()?;
    Some(explain_received(&Frame::new(frame), None))
}

/// Milliseconds and tenths, rounded: the resolution of a browser's clock.
fn to_tenths(micros: u32) -> (u64, u64) {
    let tenths = (u64::from(micros) + 50) / 100;
    (tenths / 10, tenths % 10)
}

/// Adds the meaning of an entry in English, as in files.
pub(crate) fn push_english(out: &mut String, entry: &Entry, texts: &Texts) {
    // Writing to a string does not fail.
    let _ = match &entry.content {
        EntryContent::Message { text, .. } => out.write_str(&in_english(texts.get(*text))),
        EntryContent::Line(
            LineEventKind::Sent { frame, mode }
            | LineEventKind::SentByHand { frame, mode }
            | LineEventKind::RepeatedByHand { frame, mode }
            | LineEventKind::Commanded { frame, mode },
        ) => {
            write!(out, "{}", explain_sent(frame, *mode))
        }
        EntryContent::Line(
            LineEventKind::Received { frame, asked } | LineEventKind::Reading { frame, asked },
        ) => {
            write!(out, "{}", explain_received(frame, *asked))
        }
        EntryContent::Line(LineEventKind::Junk(junk)) => push_junk(out, junk),
        EntryContent::Line(LineEventKind::Silence { waited_us, .. }) => {
            out.push_str("no reply within ");
            let (millis, tenth) = to_tenths(*waited_us);
            push_decimal(out, millis);
            out.push('.');
            push_decimal(out, tenth);
            out.write_str(" ms")
        }
        EntryContent::Line(LineEventKind::NotSent { .. }) => {
            out.write_str("not sent: adapter still busy with the previous frame")
        }
    };
}

/// A message of the page as in files, whatever language it is shown in.
fn in_english(stored: &str) -> String {
    let shown_in = current_language();
    set_language(Language::English);
    let text = translate(stored);
    set_language(shown_in);
    text
}

fn push_junk(out: &mut String, junk: &JunkBytes) -> std::fmt::Result {
    let bytes = junk.bytes();
    if let Some(explained) = explained_junk(junk) {
        return write!(out, "{explained}: dropped");
    }
    push_decimal(out, u64::try_from(bytes.len()).unwrap_or_default());
    out.write_str(if bytes.len() == 1 {
        " byte, no valid frame"
    } else {
        " bytes, no valid frame"
    })
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
