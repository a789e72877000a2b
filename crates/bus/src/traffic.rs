//! Every frame that passed, for the packet log.

use motorlink_protocol::{FRAME_LEN, Frame, Instant, Layout, Mode, MotorId};

/// One thing that passed on the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Traffic {
    /// When it was handed out to be sent, or when its last byte was read.
    pub at: Instant,
    /// What it was.
    pub passed: Passed,
}

/// What passed on the line. An echo of our own is not among it: it is counted, and was sent already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Passed {
    /// A frame of ours.
    Sent {
        /// Its bytes.
        frame: Frame,
        /// The loop in which its motor reads the value of a drive frame, where that is known.
        mode: Option<Mode>,
    },
    /// A good frame of a motor.
    Heard {
        /// Its bytes.
        frame: Frame,
        /// What was asked, so what its bytes 6 and 7 mean; `None` where that is not certain.
        asked: Option<Layout>,
    },
    /// Bytes that are no good frame: a spoilt reply, two talkers, noise. More than ten are several of
    /// these.
    Junk(JunkBytes),
    /// A motor that was asked, outside a scan, said nothing in its window.
    Silence {
        /// Which motor.
        id: MotorId,
        /// How long it was waited for.
        waited_us: u32,
    },
    /// A frame that was to be sent and was not: the adapter was still at the frame before.
    Unsent {
        /// Its bytes.
        frame: Frame,
    },
}

/// One to ten bytes that are no good frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct JunkBytes {
    bytes: [u8; FRAME_LEN],
    length: u8,
}

impl JunkBytes {
    /// The first ten of these, at most.
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
