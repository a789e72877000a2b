//! Line events as earlier versions saved them.
//!
//! Each frame of a model with separate frames is followed by a frame of a DDSM115 that repeats it, and is left out here.

use motorlink_bus::{JunkBytes, LineEvent, LineEventKind};
use motorlink_protocol::{Frame, Instant, Layout, Mode, MotorId, family::Model};
use serde::Deserialize;

/// In the order of their encoding.
#[derive(Deserialize)]
enum Kind {
    Sent {
        frame: Frame,
        mode: Option<Mode>,
    },
    Received {
        frame: Frame,
        asked: Option<Layout>,
    },
    Junk(JunkBytes),
    Silence {
        id: MotorId,
        waited_us: u32,
    },
    Commanded {
        _frame: Frame,
        _mode: Option<Mode>,
    },
    /// An earlier `Layout` had a third value, so it is read as a number.
    Reading {
        _frame: Frame,
        _asked: Option<u32>,
    },
    NotSent {
        frame: Frame,
    },
    SentByHand {
        frame: Frame,
        mode: Option<Mode>,
    },
    RepeatedByHand {
        frame: Frame,
        mode: Option<Mode>,
    },
    ModelSelected(Model),
}

impl Kind {
    fn of_now(self) -> Option<LineEventKind> {
        Some(match self {
            Self::Sent { frame, mode } => LineEventKind::Sent { frame, mode },
            Self::Received { frame, asked } => LineEventKind::Received { frame, asked },
            Self::Junk(junk) => LineEventKind::Junk(junk),
            Self::Silence { id, waited_us } => LineEventKind::Silence { id, waited_us },
            Self::Commanded { .. } | Self::Reading { .. } => return None,
            Self::NotSent { frame } => LineEventKind::NotSent { frame },
            Self::SentByHand { frame, mode } => LineEventKind::SentByHand { frame, mode },
            Self::RepeatedByHand { frame, mode } => LineEventKind::RepeatedByHand { frame, mode },
            Self::ModelSelected(model) => LineEventKind::ModelSelected(model),
        })
    }
}

/// Decodes them, oldest first. Ends at the first invalid one.
pub(super) fn traffic(bytes: &[u8]) -> impl Iterator<Item = LineEvent> {
    let mut rest = bytes;
    let events = std::iter::from_fn(move || {
        let (event, behind): ((Instant, Kind), _) = postcard::take_from_bytes(rest).ok()?;
        rest = behind;
        Some(event)
    });
    events.filter_map(|(at, kind)| {
        let kind = kind.of_now()?;
        Some(LineEvent { at, kind })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Written by version 0.1.0 of a DDSM210: model, drive frame, the same for a DDSM115, not sent.
    #[test]
    fn what_earlier_versions_saved_is_read_without_frames_that_were_on_no_line() {
        let drive = [1, 0x64, 1, 0xF4, 0, 0, 0, 0, 0, 0xC3];
        let mut bytes = vec![7, 9, 2];
        bytes.extend([8, 0]);
        bytes.extend(drive);
        bytes.extend([1, 2, 8, 4]);
        bytes.extend(drive);
        bytes.extend([1, 2, 9, 5]);
        bytes.extend(drive);
        bytes.extend([1, 2, 10, 6]);
        bytes.extend(drive);
        let frame = Frame::new(drive);
        let mode = Some(Mode::Velocity);
        let expected = [
            (7, LineEventKind::ModelSelected(Model::Ddsm210)),
            (8, LineEventKind::Sent { frame, mode }),
            (10, LineEventKind::NotSent { frame }),
        ];
        let expected = expected.map(|(at, kind)| LineEvent {
            at: Instant::from_micros(at),
            kind,
        });
        assert_eq!(traffic(&bytes).collect::<Vec<_>>(), expected);
    }
}
