//! The session file: all events of a bus, in a file that other programs can open too.
//!
//! It is an MCAP file (<https://mcap.dev>) with JSON messages; `docs/sessions.md` describes its channels. The crate
//! does no I/O: [`Writer`] takes records and returns bytes, [`Opening`] and [`Cursor`] request bytes and return
//! records. None of them keeps more than a chunk, the index and the [`Overview`].
//!
//! | module | what it holds |
//! |---|---|
//! | `record` | the records of a session |
//! | `messages` | records in, JSON messages by channel out |
//! | `writer` | records in, bytes of a file out |
//! | `reader` | bytes of a file in, records out |
//! | `replay` | plays records: what the page shows at a place of the session |
//! | `runs` | runs of experiments as attachments |
//! | `copy` | copies a file with other bookmarks |
//! | `export` | CSV tables and a report |
//! | `import` | CSV files as sessions |
//! | `overview` | a summary of the whole session over time |
//! | `page_messages` | messages of the page as events |
//! | `channels` | the messages of each channel, as JSON |
//! | `mcap` | the container |
//!
//! # Example
//!
//! ```
//! use motorlink_bus::{LineEvent, LineEventKind};
//! use motorlink_protocol::Instant;
//! use motorlink_session::{Writer, for_each_record, open};
//!
//! let frame = "01 64 00 64 00 00 00 00 00 4F".parse()?;
//! let sent = LineEventKind::Sent { frame, mode: None };
//! let mut writer = Writer::new(1_795_266_936_962_000, &[("page", "0.1.0")]);
//! writer.line(&LineEvent { at: Instant::from_millis(20), kind: sent });
//! let file = writer.finish();
//!
//! let mut source = &file[..];
//! let session = open(&mut source)??;
//! let mut records = Vec::new();
//! let problems = for_each_record(&mut source, &session, |record| records.push(record))?;
//! assert!(problems.is_empty());
//! assert_eq!(records[0].line().map(|line| line.kind), Some(sent));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod channels;
mod clock;
mod copy;
mod export;
mod format;
mod import;
mod mcap;
mod messages;
mod overview;
mod page_messages;
mod reader;
mod record;
mod replay;
mod runs;
mod writer;

pub use channels::{Channel, TelemetryJson};
pub use copy::{BOOKMARK_TEXT_MAX, CopyStep, Copying, copy};
pub use export::{About, Table, report};
pub use import::Import;
pub use messages::{Message, Messages};
pub use overview::{BOOKMARKS_MAX, BUCKETS_MAX, Extent, MARKS_MAX, Mark, MotorOverview, Overview};
pub use reader::{
    Attachment, Cursor, Next, NotASession, Opening, Problem, Problems, Session, Source, Step,
    for_each_record, open, overview,
};
pub use record::{Event, EventKind, Record, What};
pub use replay::{LookBack, Player, Todo};
pub use runs::{AttachedRun, RunEvents};
pub use writer::Writer;
