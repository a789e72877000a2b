//! The saved session: the inputs of the recorder in files, to rebuild another recorder from them.
//!
//! The files contain inputs: line events, messages, what the page showed, clearings, and when recording began and
//! ended. So files are only appended to, never rewritten.
//!
//! | file | what it holds |
//! |---|---|
//! | `block` | the unit of writing, with a checksum |
//! | `content` | the content of a block |
//! | `before` | the line events of earlier versions |
//! | `when_to_write` | decides when to write, and which files to remove |
//! | `stream_writer` | the bytes to append, and to which file of its stream |
//! | `summary` | the size and the period of a saved session |
//! | `timeline` | the times of several runs on one clock |
//! | `rebuild` | rebuilds a log and a recording |

mod before;
mod block;
mod content;
mod rebuild;
mod stream_writer;
mod summary;
mod timeline;
mod when_to_write;

pub use block::{Blocks, CONTENT_MAX};
pub(crate) use rebuild::Rebuild;
pub use stream_writer::{PACKETS_BYTES_MAX, SEGMENT_BYTES_MAX};
pub use summary::Summary;
pub(crate) use timeline::Timeline;
pub use when_to_write::{SessionWriter, StoreAction};

/// A stream of blocks. Each is split into files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stream {
    /// All inputs of the log.
    Packets,
    /// Recorded samples.
    Recorded,
}

/// A file of a session: a segment of one of its streams, ordered by number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Segment {
    /// The stream.
    pub stream: Stream,
    /// The number, from 1.
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

    /// The segment with this file name; `None` for other files.
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
    fn a_segment_is_parsed_from_its_file_name() {
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
