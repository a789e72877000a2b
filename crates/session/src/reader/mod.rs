//! The reader of sessions. It asks for parts of the file and keeps none but one chunk.
//!
//! | file | what it holds |
//! |---|---|
//! | `opening` | a file on its way to a [`Session`] |
//! | `summary` | the index at the end of a file |
//! | `scan` | the index of a file whose end is missing |
//! | `cursor` | records from any moment on |
//! | `blocking` | the same for callers that can read at once |
//! | `problems` | what is missing, in words |

mod blocking;
mod cursor;
mod opening;
mod problems;
mod scan;
mod summary;

use std::{collections::BTreeMap, ops::Range};

pub use blocking::{Source, for_each_record, open, overview};
pub use cursor::{Cursor, Next};
pub use opening::{NotASession, Opening, Step};
pub use problems::{Problem, Problems};

use crate::{
    channels::Topic,
    format,
    mcap::summary::{AttachmentIndex, ChunkIndex},
    overview::Overview,
};

/// Chunks at most. An hour at 500 exchanges a second has 700.
const CHUNKS_MAX: usize = 200_000;

/// Bytes of the overview at most. One of 32 motors has a megabyte.
const OVERVIEW_BYTES_MAX: u64 = 4 << 20;

/// Bytes of another attachment at most: experiment runs are tables.
const ATTACHMENT_BYTES_MAX: u64 = 16 << 20;

/// A session file that is open: what lies where in it.
#[derive(Debug, Default)]
pub struct Session {
    chunks: Vec<ChunkIndex>,
    attachments: Vec<AttachmentIndex>,
    topics: BTreeMap<u16, Topic>,
    about: BTreeMap<String, String>,
    problems: Problems,
}

/// A file within the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attachment {
    /// Its name, such as `setup.json`.
    pub name: String,
    /// What it is, such as `application/json`.
    pub media_type: String,
    /// Its bytes.
    pub size: u64,
}

impl Session {
    /// What is missing or unreadable, as far as is known. Reading chunks may find more: see [`Cursor::problems`].
    #[must_use]
    pub const fn problems(&self) -> &Problems {
        &self.problems
    }

    /// Where the session comes from, in names and values.
    #[must_use]
    pub const fn about(&self) -> &BTreeMap<String, String> {
        &self.about
    }

    /// The first and the last moment by the index, in nanoseconds since 1970, UTC.
    #[must_use]
    pub fn span_ns(&self) -> Option<(u64, u64)> {
        let from = self.chunks.iter().map(|chunk| chunk.from_ns).min()?;
        let to = self.chunks.iter().map(|chunk| chunk.to_ns).max()?;
        Some((from, to))
    }

    /// Chunks that the index has.
    #[must_use]
    pub const fn chunks(&self) -> usize {
        self.chunks.len()
    }

    /// Every file within the file.
    pub fn attachments(&self) -> impl Iterator<Item = Attachment> {
        self.attachments.iter().map(|index| Attachment {
            name: index.name.clone(),
            media_type: index.media_type.clone(),
            size: index.size,
        })
    }

    /// Where the attachment of this name lies; `None` where there is none, or it is too large to be read at once.
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

    /// The attachment in these bytes, which were read where [`Self::attachment_range`] says.
    ///
    /// # Errors
    /// The bytes are damaged.
    pub fn attachment(bytes: &[u8]) -> Result<&[u8], Problem> {
        AttachmentIndex::data(bytes).ok_or(Problem::AttachmentDamaged)
    }

    /// Where the stored overview lies. A file that is cut has none.
    #[must_use]
    pub fn overview_range(&self) -> Option<Range<u64>> {
        self.attachment_range(format::OVERVIEW)
    }

    /// The overview in these bytes, which were read where [`Self::overview_range`] says; `None` where it cannot be
    /// read and has to be computed from every record.
    #[must_use]
    pub fn stored_overview(bytes: &[u8]) -> Option<Overview> {
        Overview::from_json(Self::attachment(bytes).ok()?)
    }
}
