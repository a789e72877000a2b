//! An entry in words.

use std::fmt::Write;

use motorlink_bus::{JunkBytes, LineEventKind};
use motorlink_i18n::{Language, spoken, terms, tr};
use motorlink_messages::recorder::Row;
use motorlink_protocol::{Explained, FRAME_LEN, Frame, explain_received, explain_sent};

use crate::{
    digits::{push_0x, push_decimal, push_hex},
    entry::{Entry, What},
    texts::Texts,
    wall_clock::WallClock,
};

/// Adds what an entry says, in the language that is spoken.
pub(crate) fn push_meaning(out: &mut String, entry: &Entry, texts: &Texts) {
    // A million entries are searched while a person waits, and most of them in English: that is written
    // without a text of its own for each part.
    if spoken() == Language::English {
        return push_english(out, entry, texts);
    }
    match &entry.what {
        What::Said { text, .. } => out.push_str(texts.get(*text)),
        What::Passed(passed) => out.push_str(&translated(passed)),
    }
}

fn translated(passed: &LineEventKind) -> String {
    match passed {
        LineEventKind::Sent { frame, mode } => terms::explained(explain_sent(frame, *mode)),
        LineEventKind::Received { frame, asked } => {
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

/// Ten bytes are taken for a frame.
fn explained_junk(junk: &JunkBytes) -> Option<Explained> {
    let frame = <[u8; FRAME_LEN]>::try_from(junk.bytes()).ok()?;
    Some(explain_received(&Frame::new(frame), None))
}

/// Milliseconds and their tenths, to the nearest, which is the step of a browser's clock.
fn to_tenths(micros: u32) -> (u64, u64) {
    let tenths = (u64::from(micros) + 50) / 100;
    (tenths / 10, tenths % 10)
}

/// Adds what an entry says in English, as files have it.
pub(crate) fn push_english(out: &mut String, entry: &Entry, texts: &Texts) {
    // Writing into a text does not fail.
    let _ = match &entry.what {
        What::Said { text, .. } => out.write_str(texts.get(*text)),
        What::Passed(LineEventKind::Sent { frame, mode }) => {
            write!(out, "{}", explain_sent(frame, *mode))
        }
        What::Passed(LineEventKind::Received { frame, asked }) => {
            write!(out, "{}", explain_received(frame, *asked))
        }
        What::Passed(LineEventKind::Junk(junk)) => push_junk(out, junk),
        What::Passed(LineEventKind::Silence { waited_us, .. }) => {
            out.push_str("no reply within ");
            let (millis, tenth) = to_tenths(*waited_us);
            push_decimal(out, millis);
            out.push('.');
            push_decimal(out, tenth);
            out.write_str(" ms")
        }
        What::Passed(LineEventKind::NotSent { .. }) => {
            out.write_str("not sent: adapter still busy with the previous frame")
        }
    };
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

/// Adds the motor that an entry is of or to: `0x01`, or nothing.
pub(crate) fn push_id(out: &mut String, entry: &Entry) {
    if let Some(id) = entry.id() {
        push_0x(out, id.get());
    }
}

/// An entry as a row of the log.
pub(crate) fn row(
    entry: &Entry,
    texts: &Texts,
    clock: WallClock,
    number: u64,
    collapsed_before: u32,
) -> Row {
    let mut row = Row {
        number,
        kind: entry.kind(),
        time: String::new(),
        id: String::new(),
        hex: String::new(),
        meaning: String::new(),
        collapsed_before,
    };
    clock.local(entry.at).push_time_of_day(&mut row.time);
    push_id(&mut row.id, entry);
    push_hex(&mut row.hex, entry.bytes());
    push_meaning(&mut row.meaning, entry, texts);
    row
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::{Instant, Layout, Mode, MotorId};

    use super::*;
    use crate::entry::Verdict;

    fn said(what: What, texts: &Texts) -> String {
        let entry = Entry {
            at: Instant::ZERO,
            what,
            routine: false,
            verdict: Verdict::Hidden,
        };
        let mut out = String::new();
        push_meaning(&mut out, &entry, texts);
        out
    }

    fn passed(passed: LineEventKind) -> String {
        said(What::Passed(passed), &Texts::default())
    }

    fn junk(text: &str) -> String {
        let bytes: Vec<u8> = text
            .split(' ')
            .map(|byte| u8::from_str_radix(byte, 16).unwrap())
            .collect();
        passed(LineEventKind::Junk(JunkBytes::new(&bytes)))
    }

    #[test]
    fn frames_are_said_as_everywhere_else() {
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
    fn junk_says_what_is_wrong_with_it() {
        assert_eq!(
            junk("01 02 02 CD 00 64 17 CF 00 5B"),
            "CRC 5B, expected 8F: dropped"
        );
        assert_eq!(junk("01 02 03"), "3 bytes, no valid frame");
        assert_eq!(junk("FF"), "1 byte, no valid frame");
    }

    #[test]
    fn silence_says_how_long_it_was() {
        let silence = |waited_us| {
            let id = MotorId::FIRST;
            passed(LineEventKind::Silence { id, waited_us })
        };
        assert_eq!(silence(8_000), "no reply within 8.0 ms");
        assert_eq!(silence(25_050), "no reply within 25.1 ms");
        assert_eq!(silence(999), "no reply within 1.0 ms");
    }

    #[test]
    fn every_entry_is_said_in_the_language_that_is_spoken() {
        motorlink_i18n::speak(Language::German);
        let frame = "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap();
        let asked = Some(Layout::Drive);
        assert_eq!(
            passed(LineEventKind::Received { frame, asked }),
            "+100 rpm, +0,175 A, 66,96°"
        );
        assert!(junk("FF").starts_with("1 ") && !junk("FF").contains("frame is"));
        let id = MotorId::FIRST;
        let waited_us = 8_000;
        assert!(passed(LineEventKind::Silence { id, waited_us }).contains("8,0 ms"));
    }

    #[test]
    fn what_the_page_said_stands_as_it_was_said() {
        let mut texts = Texts::default();
        let text = texts.keep("connected");
        assert_eq!(said(What::Said { error: false, text }, &texts), "connected");
    }
}
