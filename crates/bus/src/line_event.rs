//! Events of the line, for the packet log.

use motorlink_protocol::{FRAME_LEN, Frame, Instant, Layout, Mode, MotorId, family::Model};

/// One event of the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LineEvent {
    /// When the frame was given to the port, or when its last byte was read.
    pub at: Instant,
    /// What happened.
    pub kind: LineEventKind,
}

/// What happened on the line. Echoes are not among them: the request is logged, and the echo is
/// counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum LineEventKind {
    /// A frame that the bus decided.
    Sent {
        /// The bytes.
        frame: Frame,
        /// The loop in which the motor reads the value of a drive frame, if known.
        mode: Option<Mode>,
    },
    /// A good frame of a motor.
    Received {
        /// The bytes.
        frame: Frame,
        /// The layout of bytes 6 and 7; `None` if the request is uncertain.
        asked: Option<Layout>,
    },
    /// Bytes that are not a good frame: a corrupt reply, a collision, noise. More than ten bytes
    /// make several events. A second has at most 500 of these events; the counters have all bytes.
    Junk(JunkBytes),
    /// A motor sent nothing in its reply window. Not reported during a scan.
    Silence {
        /// Which motor.
        id: MotorId,
        /// Length of the reply window.
        waited_us: u32,
    },
    /// What is known of a motor before its next reply, where only its replies are left. Nothing passed on the line at
    /// this time: the bus reports no such event, a recording has it.
    Known {
        /// Which motor.
        id: MotorId,
        /// The loop that it is in.
        mode: Mode,
        /// The value of its last drive frame, in this loop, while such frames came.
        value: Option<[u8; 2]>,
    },
    /// A frame that the port refused because it was still busy with the one before.
    NotSent {
        /// The bytes.
        frame: Frame,
    },
    /// The first raw frame of a [`Command::SendRaw`](crate::Command::SendRaw): the operator pressed Send for it.
    SentByHand {
        /// The bytes.
        frame: Frame,
        /// As in [`LineEventKind::Sent`].
        mode: Option<Mode>,
    },
    /// A repetition of that raw frame.
    RepeatedByHand {
        /// The bytes.
        frame: Frame,
        /// As in [`LineEventKind::Sent`].
        mode: Option<Mode>,
    },
    /// A bus starts. The following frames are of this model.
    ModelSelected(Model),
}

impl LineEventKind {
    /// The frame that was sent, by the bus or by hand, and the loop in which the motor reads its value, if known.
    /// `None` for other events.
    #[must_use]
    pub const fn sent(&self) -> Option<(Frame, Option<Mode>)> {
        match self {
            Self::Sent { frame, mode }
            | Self::SentByHand { frame, mode }
            | Self::RepeatedByHand { frame, mode } => Some((*frame, *mode)),
            Self::Received { .. }
            | Self::Known { .. }
            | Self::Junk(_)
            | Self::Silence { .. }
            | Self::NotSent { .. }
            | Self::ModelSelected(_) => None,
        }
    }

    /// Whether it happened on the line. The others say what the frames behind them mean.
    #[must_use]
    pub const fn is_on_the_wire(&self) -> bool {
        !matches!(self, Self::Known { .. } | Self::ModelSelected(_))
    }
}

/// One to ten bytes that are not a good frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct JunkBytes {
    bytes: [u8; FRAME_LEN],
    length: u8,
}

impl JunkBytes {
    /// At most the first ten of these bytes.
    #[must_use]
    pub fn new(junk: &[u8]) -> Self {
        let mut bytes = [0; FRAME_LEN];
        let length = junk.len().min(FRAME_LEN);
        for (slot, byte) in bytes.iter_mut().zip(junk) {
            *slot = *byte;
        }
        Self {
            bytes,
            length: u8::try_from(length).unwrap_or_default(),
        }
    }

    /// The bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        let length = usize::from(self.length).min(FRAME_LEN);
        self.bytes.get(..length).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn junk_keeps_its_first_ten_bytes() {
        assert_eq!(JunkBytes::new(&[1, 2, 3]).bytes(), [1, 2, 3]);
        assert_eq!(JunkBytes::new(&[7; 12]).bytes(), [7; 10]);
        assert!(JunkBytes::new(&[]).bytes().is_empty());
    }
}
