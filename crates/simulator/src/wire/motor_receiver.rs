//! How motors find frames in the host's bytes.

use motorlink_protocol::{FRAME_LEN, Frame, Instant};

use super::{shared_wire::PassedByte, timing::FRAME_GAP};

/// Ten bytes of the host.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HostFrame {
    /// Start of the first byte.
    pub(crate) start: Instant,
    /// As the host sent it.
    pub(crate) sent: Frame,
    /// As the motors receive it.
    pub(crate) received: Frame,
}

/// Ten bytes make a frame. A silence starts a new one.
#[derive(Clone, Debug, Default)]
pub(crate) struct MotorReceiver {
    sent: [u8; FRAME_LEN],
    received: [u8; FRAME_LEN],
    filled: usize,
    start: Instant,
    last_end: Instant,
}

impl MotorReceiver {
    /// Takes a byte of the host. Returns the frame that it completes.
    pub(crate) fn receive(&mut self, byte: PassedByte) -> Option<HostFrame> {
        if byte.start.since(self.last_end) > FRAME_GAP {
            self.filled = 0;
        }
        self.last_end = byte.end;
        if self.filled == 0 {
            self.start = byte.start;
        }
        let places = (
            self.sent.get_mut(self.filled),
            self.received.get_mut(self.filled),
        );
        if let (Some(sent), Some(received)) = places {
            *sent = byte.sent;
            *received = byte.received;
        }
        self.filled = (self.filled + 1) % FRAME_LEN;
        (self.filled == 0).then(|| HostFrame {
            start: self.start,
            sent: Frame::new(self.sent),
            received: Frame::new(self.received),
        })
    }
}
