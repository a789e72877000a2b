//! The session on disk: what goes into the recorder is kept as it came, and read back into another.
//!
//! Inputs are kept, not state: traffic, the page's lines, clearings, and when recording began and ended.
//! So what is written grows with what happens, and nothing that was written is ever written again.
//!
//! | file | what it holds |
//! |---|---|
//! | `block` | what is written in one go, with a check |
//! | `content` | what is in a block |
//! | `keeper` | which bytes go into which file, when, and which files have to go |
//! | `summary` | what a kept session holds, in numbers |
//! | `timeline` | the times of several runs on one clock |
//! | `replay` | a log and a recording made again from what was kept |

mod block;
mod content;
mod keeper;
mod replay;
mod summary;
mod timeline;

pub use block::{Blocks, CONTENT_MAX};
pub use keeper::{Act, Keeper, PACKETS_BYTES_MAX, SEGMENT_BYTES_MAX};
pub(crate) use replay::Replay;
pub use summary::Summary;
pub(crate) use timeline::Timeline;

/// What a file holds a part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stream {
    /// Everything that the log takes in.
    Packets,
    /// Samples, while they are recorded.
    Recorded,
}

/// A file of a session: a segment of one of its streams. Those with greater numbers go on behind it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Segment {
    /// Of what it is a part.
    pub stream: Stream,
    /// Which part, from 1.
    pub number: u32,
}

impl Segment {
    /// The name of its file.
    #[must_use]
    pub fn name(self) -> String {
        let letter = match self.stream {
            Stream::Packets => 'p',
            Stream::Recorded => 'r',
        };
        format!("{letter}{}", self.number)
    }

    /// The segment in the file of this name; `None` where it is another kind of file.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let (stream, number) = match name.strip_prefix('p') {
            Some(number) => (Stream::Packets, number),
            None => (Stream::Recorded, name.strip_prefix('r')?),
        };
        let number = number.parse().ok()?;
        let segment = Self { stream, number };
        (segment.name() == name).then_some(segment)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_known_by_its_name() {
        for (name, stream, number) in [("p1", Stream::Packets, 1), ("r27", Stream::Recorded, 27)] {
            let segment = Segment { stream, number };
            assert_eq!(segment.name(), name);
            assert_eq!(Segment::from_name(name), Some(segment));
        }
        for other in ["", "p", "alive", "p01", "p+1", "q1", "p-1", "p4294967296"] {
            assert_eq!(Segment::from_name(other), None, "{other}");
        }
    }
}
