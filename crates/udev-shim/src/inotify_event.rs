//! One inotify event, as the kernel writes it.

use rustix::fs::inotify::ReadFlags;

use crate::device::Action;

/// The fixed part of an event.
///
/// | bytes | what |
/// |---|---|
/// | 0-3 | watch |
/// | 4-7 | mask: what happened |
/// | 8-11 | cookie |
/// | 12-15 | length of the name that follows, with its padding of zeros |
pub const HEADER_BYTES: usize = 16;

/// The kernel pads names, with their closing zero, to a multiple of this.
pub const NAME_STEP_BYTES: usize = 16;

/// The longest file name, 255 bytes, with its closing zero.
pub const NAME_BYTES_MAX: usize = 256;

/// What an event says of an adapter's file.
#[derive(Debug, PartialEq, Eq)]
pub struct FileEvent<'a> {
    /// The file's name.
    pub name: &'a str,
    /// Whether it came or went.
    pub action: Action,
}

impl<'a> FileEvent<'a> {
    /// Reads the first event of `bytes` (in this machine's byte order); none if it is not the
    /// coming or going of a file with a name.
    pub fn parse(bytes: &'a [u8]) -> Option<Self> {
        let (header, rest) = bytes.split_at_checked(HEADER_BYTES)?;
        let mask = u32::from_ne_bytes(header.get(4..8)?.try_into().ok()?);
        let padded_len = u32::from_ne_bytes(header.get(12..16)?.try_into().ok()?);
        let padded = rest.get(..usize::try_from(padded_len).ok()?)?;
        let name = std::str::from_utf8(padded.split(|byte| *byte == 0).next()?).ok()?;
        let mask = ReadFlags::from_bits_retain(mask);
        let action = if mask.intersects(ReadFlags::MOVED_TO) {
            Action::Add
        } else if mask.intersects(ReadFlags::MOVED_FROM | ReadFlags::DELETE) {
            Action::Remove
        } else {
            return None;
        };
        (!name.is_empty()).then_some(Self { name, action })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn event(mask: u32, name: &[u8]) -> Vec<u8> {
        let mut padded = name.to_vec();
        padded.resize((name.len() / NAME_STEP_BYTES + 1) * NAME_STEP_BYTES, 0);
        let len = u32::try_from(padded.len()).unwrap();
        let fields = [1, mask, 0, len].map(u32::to_ne_bytes).concat();
        [fields, padded].concat()
    }

    // Masks as in inotify(7).
    const MODIFY: u32 = 0x2;
    const MOVED_FROM: u32 = 0x40;
    const MOVED_TO: u32 = 0x80;
    const DELETE: u32 = 0x200;

    #[test]
    fn files_come_and_go() {
        for (mask, action) in [
            (MOVED_TO, Action::Add),
            (MOVED_FROM, Action::Remove),
            (DELETE, Action::Remove),
        ] {
            let bytes = event(mask, b"adapter-1");
            assert_eq!(
                FileEvent::parse(&bytes),
                Some(FileEvent {
                    name: "adapter-1",
                    action
                })
            );
        }
    }

    #[test]
    fn whatever_else_the_kernel_says_is_nothing() {
        assert_eq!(FileEvent::parse(&event(MODIFY, b"adapter-1")), None);
        assert_eq!(FileEvent::parse(&event(MOVED_TO, b"")), None);
        assert_eq!(FileEvent::parse(&event(MOVED_TO, b"\xff\xfe")), None);
        let whole = event(MOVED_TO, b"adapter-1");
        for len in 0..whole.len() {
            assert_eq!(FileEvent::parse(&whole[..len]), None);
        }
    }
}
