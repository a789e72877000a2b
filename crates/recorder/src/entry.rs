//! One entry of the log, small enough to keep a million of them.

use motorlink_bus::LineEventKind;
use motorlink_messages::recorder::Kind;
use motorlink_protocol::{Instant, MotorId, Request};

use crate::texts::TextRef;

/// What the log keeps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub(crate) at: Instant,
    pub(crate) what: What,
    /// Whether it is part of a routine exchange, by what came before it.
    pub(crate) routine: bool,
    /// What the view has made of it.
    pub(crate) verdict: Verdict,
}

/// A million entries are 24 MB.
const _: () = assert!(size_of::<Entry>() == 24);

/// What an entry is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum What {
    /// Something on the line.
    Passed(LineEventKind),
    /// Something that the page said.
    Said { error: bool, text: TextRef },
}

/// What the filter makes of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// It is not asked for.
    Hidden,
    /// It would be shown if it were not routine.
    Collapsed,
    /// It is a row.
    Shown,
}

impl Entry {
    pub(crate) const fn kind(&self) -> Kind {
        match self.what {
            What::Passed(LineEventKind::Sent { .. }) => Kind::Tx,
            What::Passed(LineEventKind::Received { .. }) => Kind::Rx,
            What::Passed(
                LineEventKind::Junk(_)
                | LineEventKind::Silence { .. }
                | LineEventKind::NotSent { .. },
            )
            | What::Said { error: true, .. } => Kind::Error,
            What::Said { error: false, .. } => Kind::System,
        }
    }

    /// The motor that it is of or to. What every motor hears is to none.
    pub(crate) fn id(&self) -> Option<MotorId> {
        match self.what {
            What::Passed(LineEventKind::Sent { frame, .. } | LineEventKind::NotSent { frame }) => {
                let [first, second, third, ..] = *frame.bytes();
                let to_all = match first {
                    0xAA => (second, third) == (0x55, 0x53),
                    0xC8 => frame == Request::IdQuery.frame(),
                    _ => false,
                };
                MotorId::new(first).ok().filter(|_| !to_all)
            }
            What::Passed(LineEventKind::Received { frame, .. }) => {
                let [first, ..] = *frame.bytes();
                MotorId::new(first).ok()
            }
            What::Passed(LineEventKind::Silence { id, .. }) => Some(id),
            What::Passed(LineEventKind::Junk(_)) | What::Said { .. } => None,
        }
    }

    /// Its bytes, as far as it has any.
    pub(crate) fn bytes(&self) -> &[u8] {
        match &self.what {
            What::Passed(
                LineEventKind::Sent { frame, .. }
                | LineEventKind::Received { frame, .. }
                | LineEventKind::NotSent { frame },
            ) => frame.bytes(),
            What::Passed(LineEventKind::Junk(junk)) => junk.bytes(),
            What::Passed(LineEventKind::Silence { .. }) | What::Said { .. } => &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use motorlink_bus::JunkBytes;
    use motorlink_protocol::Frame;

    use super::*;

    fn sent(text: &str) -> Entry {
        let frame: Frame = text.parse().unwrap();
        entry(LineEventKind::Sent { frame, mode: None })
    }

    const fn entry(passed: LineEventKind) -> Entry {
        Entry {
            at: Instant::ZERO,
            what: What::Passed(passed),
            routine: false,
            verdict: Verdict::Hidden,
        }
    }

    #[test]
    fn frames_to_one_motor_are_of_that_motor_and_frames_to_all_of_none() {
        let id = |text| sent(text).id().map(MotorId::get);
        assert_eq!(id("01 74 00 00 00 00 00 00 00 04"), Some(1));
        assert_eq!(id("02 A0 00 00 00 00 00 00 00 03"), Some(2));
        assert_eq!(id("C8 64 00 00 00 00 00 00 00 DE"), None, "ID query");
        assert_eq!(id("C8 74 00 00 00 00 00 00 00 00"), Some(200));
        assert_eq!(id("AA 55 53 01 00 00 00 00 00 00"), None, "set ID");
        assert_eq!(id("00 01 02 03 04 05 06 07 08 09"), None, "no motor has it");
    }

    #[test]
    fn junk_is_of_nobody_and_silence_of_its_motor() {
        let junk = entry(LineEventKind::Junk(JunkBytes::new(&[1, 2, 3])));
        assert_eq!((junk.id(), junk.bytes()), (None, &[1, 2, 3][..]));
        let silence = entry(LineEventKind::Silence {
            id: MotorId::FIRST,
            waited_us: 8_000,
        });
        assert_eq!(
            (silence.id(), silence.kind()),
            (Some(MotorId::FIRST), Kind::Error)
        );
        assert!(silence.bytes().is_empty());
    }
}
