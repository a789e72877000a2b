//! The reader of sessions. It requests parts of the file and keeps at most one chunk.
//!
//! | file | what it holds |
//! |---|---|
//! | `opening` | opens a file as a [`Session`] |
//! | `summary` | the index at the end of a file |
//! | `scan` | the index of a file whose end is missing |
//! | `cursor` | reads records from any time on |
//! | `blocking` | a blocking interface for programs and tests |
//! | `problems` | missing and unreadable parts |

mod blocking;
mod cursor;
mod opening;
mod problems;
mod scan;
mod summary;

use std::{collections::BTreeMap, ops::Range, time::Duration};

pub use blocking::{Source, for_each_record, open, overview};
pub(crate) use cursor::decompressed;
pub use cursor::{Cursor, Next};
pub use motorlink_messages::sessions::{NotASession, Problem};
pub use opening::{Opening, Step};
pub use problems::Problems;

use crate::{
    channels::Topic,
    format,
    mcap::summary::{AttachmentIndex, ChunkIndex},
    overview::Overview,
};

/// Maximal number of chunks. An hour at 500 exchanges a second has 700.
const CHUNKS_MAX: usize = 200_000;

/// Maximal bytes of the overview. An overview of 32 motors has a megabyte.
const OVERVIEW_BYTES_MAX: u64 = 4 << 20;

/// Maximal bytes of another attachment. The largest run of an experiment has 32 MB.
const ATTACHMENT_BYTES_MAX: u64 = 40 << 20;

/// An open session file: its index.
#[derive(Debug, Default)]
pub struct Session {
    chunks: Vec<ChunkIndex>,
    attachments: Vec<AttachmentIndex>,
    topics: BTreeMap<u16, Topic>,
    /// Whether the summary has channels. Not every writer repeats them there.
    has_channels: bool,
    about: BTreeMap<String, String>,
    problems: Problems,
}

/// A file that is attached to the session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attachment {
    /// Its name, such as `setup.json`.
    pub name: String,
    /// Its media type, such as `application/json`.
    pub media_type: String,
    /// Its size in bytes.
    pub size: u64,
}

impl Session {
    /// Missing and unreadable parts, as far as known. Reading chunks can find more: see [`Cursor::problems`].
    #[must_use]
    pub const fn problems(&self) -> &Problems {
        &self.problems
    }

    /// The origin of the session, as names and values.
    #[must_use]
    pub const fn about(&self) -> &BTreeMap<String, String> {
        &self.about
    }

    /// The first and the last time in the index, in nanoseconds since 1970, UTC.
    #[must_use]
    pub fn span_ns(&self) -> Option<(u64, u64)> {
        let from = self.chunks.iter().map(|chunk| chunk.from_ns).min()?;
        let to = self.chunks.iter().map(|chunk| chunk.to_ns).max()?;
        Some((from, to))
    }

    /// From when on to read in order to know what was before `utc_ns`: at least this time before it, and further back
    /// while the chunks have together no more than `bytes`, decompressed. Nanoseconds since 1970; 0 is the beginning
    /// of the file.
    #[must_use]
    pub fn look_back(&self, utc_ns: u64, least: Duration, bytes: u64) -> u64 {
        let least = u64::try_from(least.as_nanos()).unwrap_or(u64::MAX);
        let from_ns = utc_ns.saturating_sub(least);
        let is_before = |chunk: &&ChunkIndex| chunk.to_ns < utc_ns;
        let until = self.chunks.iter().take_while(is_before).count() + 1;
        let chunks = self.chunks.get(..until).unwrap_or(&self.chunks);
        let mut sum = 0_u64;
        let mut start_ns = utc_ns;
        for chunk in chunks.iter().rev() {
            sum = sum.saturating_add(chunk.size);
            if sum > bytes && chunk.to_ns < from_ns {
                return start_ns.min(from_ns);
            }
            start_ns = start_ns.min(chunk.from_ns);
        }
        0
    }

    /// Number of chunks in the index.
    #[must_use]
    pub fn chunks(&self) -> usize {
        self.chunks.iter().filter(|chunk| !chunk.is_loose).count()
    }

    /// The chunks, and messages outside of chunks.
    pub(crate) fn chunk_indexes(&self) -> &[ChunkIndex] {
        &self.chunks
    }

    /// Where the attachments begin.
    pub(crate) fn attachment_offsets(&self) -> impl Iterator<Item = u64> {
        self.attachments.iter().map(|index| index.offset)
    }

    /// Whether it is known without reading chunks that this is or is not a session.
    fn is_known(&self) -> bool {
        let is_ours = !self.topics.is_empty() || !self.about.is_empty();
        is_ours || self.has_channels || self.chunks.is_empty()
    }

    /// The channels that the reader uses.
    pub(crate) const fn topics(&self) -> &BTreeMap<u16, Topic> {
        &self.topics
    }

    /// All attachments.
    pub fn attachments(&self) -> impl Iterator<Item = Attachment> {
        self.attachments.iter().map(|index| Attachment {
            name: index.name.clone(),
            media_type: index.media_type.clone(),
            size: index.size,
        })
    }

    /// The position of the attachment of this name; `None` if there is none, or if it is too large to be read at
    /// once.
    #[must_use]
    pub fn attachment_range(&self, name: &str) -> Option<Range<u64>> {
        let index = self.attachments.iter().rfind(|index| index.name == name)?;
        let max = if name == format::OVERVIEW {
            OVERVIEW_BYTES_MAX
        } else {
            ATTACHMENT_BYTES_MAX
        };
        let end = index.offset.checked_add(index.length)?;
        (index.length <= max).then_some(index.offset..end)
    }

    /// The data of the attachment in these bytes, which were read at [`Self::attachment_range`].
    ///
    /// # Errors
    /// The bytes are damaged.
    pub fn attachment(bytes: &[u8]) -> Result<&[u8], Problem> {
        AttachmentIndex::data(bytes).ok_or(Problem::AttachmentDamaged)
    }

    /// The position of the stored overview. A truncated file has none.
    #[must_use]
    pub fn overview_range(&self) -> Option<Range<u64>> {
        self.attachment_range(format::OVERVIEW)
    }

    /// The overview in these bytes, which were read at [`Self::overview_range`]; `None` if it is unreadable and has
    /// to be computed from every record.
    #[must_use]
    pub fn stored_overview(bytes: &[u8]) -> Option<Overview> {
        Overview::from_json(Self::attachment(bytes).ok()?)
    }
}
