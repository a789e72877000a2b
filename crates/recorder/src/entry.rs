//! One entry of the log, small enough for a million of them.

use motorlink_bus::LineEventKind;
use motorlink_messages::recorder::Kind;
use motorlink_protocol::{Instant, MotorId, Request, family::Model};

use crate::stored_texts::TextRef;

/// An entry of the log.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub(crate) at: Instant,
    pub(crate) content: EntryContent,
    /// The model of the line at that time.
    pub(crate) model: Model,
    /// Whether it is part of a routine exchange, given the entries before it.
    pub(crate) routine: bool,
    /// How the view shows it.
    pub(crate) visibility: Visibility,
}

/// A million entries are 24 MB.
const _: () = assert!(size_of::<Entry>() == 24);

/// The content of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EntryContent {
    /// An event of the line.
    Line(LineEventKind),
    /// A message of the page.
    Message { error: bool, text: TextRef },
}

/// Whether the view shows an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Visibility {
    /// It does not match the filter.
    Hidden,
    /// It matches, but it is routine.
    Collapsed,
    /// It is a row.
    Shown,
}

impl Entry {
    pub(crate) const fn kind(&self) -> Kind {
        match self.content {
            EntryContent::Line(
                LineEventKind::Sent { .. }
                | LineEventKind::SentByHand { .. }
                | LineEventKind::RepeatedByHand { .. },
            ) => Kind::Tx,
            EntryContent::Line(LineEventKind::Received { .. }) => Kind::Rx,
            EntryContent::Line(
                LineEventKind::Junk(_)
                | LineEventKind::Silence { .. }
                | LineEventKind::NotSent { .. },
            )
            | EntryContent::Message { error: true, .. } => Kind::Error,
            EntryContent::Line(LineEventKind::Known { .. } | LineEventKind::ModelSelected(_))
            | EntryContent::Message { error: false, .. } => Kind::System,
        }
    }

    /// The motor that it comes from or goes to; `None` for broadcasts.
    pub(crate) fn id(&self) -> Option<MotorId> {
        match self.content {
            EntryContent::Line(
                LineEventKind::Sent { frame, .. }
                | LineEventKind::SentByHand { frame, .. }
                | LineEventKind::RepeatedByHand { frame, .. }
                | LineEventKind::NotSent { frame },
            ) => {
                let [first, second, third, ..] = *frame.bytes();
                let to_all = match first {
                    0xAA => (second, third) == (0x55, 0x53),
                    0xC8 => frame == Request::IdQuery.frame(),
                    _ => false,
                };
                MotorId::new(first).ok().filter(|_| !to_all)
            }
            EntryContent::Line(LineEventKind::Received { frame, .. }) => {
                let [first, ..] = *frame.bytes();
                MotorId::new(first).ok()
            }
            EntryContent::Line(
                LineEventKind::Silence { id, .. } | LineEventKind::Known { id, .. },
            ) => Some(id),
            EntryContent::Line(LineEventKind::Junk(_) | LineEventKind::ModelSelected(_))
            | EntryContent::Message { .. } => None,
        }
    }

    /// Its bytes, if it has any.
    pub(crate) fn bytes(&self) -> &[u8] {
        match &self.content {
            EntryContent::Line(
                LineEventKind::Sent { frame, .. }
                | LineEventKind::SentByHand { frame, .. }
                | LineEventKind::RepeatedByHand { frame, .. }
                | LineEventKind::Received { frame, .. }
                | LineEventKind::NotSent { frame },
            ) => frame.bytes(),
            EntryContent::Line(LineEventKind::Junk(junk)) => junk.bytes(),
            EntryContent::Line(
                LineEventKind::Silence { .. }
                | LineEventKind::Known { .. }
                | LineEventKind::ModelSelected(_),
            )
            | EntryContent::Message { .. } => &[],
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
            content: EntryContent::Line(passed),
            model: Model::Ddsm115,
            routine: false,
            visibility: Visibility::Hidden,
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
