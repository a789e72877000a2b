//! The size and the period of a saved session.

use std::time::Duration;

use motorlink_messages::recorder::SavedSession;
use motorlink_protocol::Instant;

use super::{
    Stream,
    block::Blocks,
    content::{Batch, Content, Note},
};
use crate::log::ENTRIES_MAX;

/// Summarizes the files of a session, in order.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// The epoch of the previous block, in microseconds since 1970.
    epoch_us: i64,
    first_epoch_us: Option<i64>,
    from_us: Option<i64>,
    to_us: i64,
    packets: u64,
    /// Those before the log was cleared.
    cleared: u64,
    recorded: u64,
    recorded_for: Duration,
    /// The newest sample since Record was pressed.
    newest: Option<Instant>,
}

impl Summary {
    /// Adds a file.
    pub fn add(&mut self, stream: Stream, bytes: Vec<u8>) {
        let mut blocks = Blocks::new(bytes);
        while let Some(block) = blocks.next_block() {
            match Content::read(block) {
                Some(Content::Epoch(epoch_us)) => {
                    self.epoch_us = epoch_us;
                    let first = self.first_epoch_us.unwrap_or(epoch_us);
                    self.first_epoch_us = Some(first.min(epoch_us));
                }
                Some(Content::Traffic(batch)) => self.batch(stream, batch),
                Some(Content::Note(Note::Message { at, .. })) => self.extend_to(at),
                Some(Content::Note(Note::Clear)) => {
                    self.cleared = std::mem::take(&mut self.packets);
                }
                Some(Content::Note(Note::UndoClear)) => {
                    let cleared = std::mem::take(&mut self.cleared);
                    self.packets = (self.packets + cleared).min(ENTRIES_MAX);
                }
                Some(Content::Note(Note::Record(true))) => self.newest = None,
                Some(Content::Note(Note::Record(false) | Note::Exported) | Content::State(..))
                | None => {}
            }
        }
    }

    fn batch(&mut self, stream: Stream, batch: Batch<'_>) {
        let count = u64::from(batch.count);
        let first = match stream {
            Stream::Packets => batch.traffic().next(),
            Stream::Recorded => batch.samples().next(),
        };
        let first = first.map_or(batch.last, |first| first.at);
        match stream {
            Stream::Packets => self.packets = (self.packets + count).min(ENTRIES_MAX),
            Stream::Recorded => {
                self.recorded += count;
                self.recorded_for += batch.last.since(self.newest.unwrap_or(first));
                self.newest = Some(batch.last);
            }
        }
        self.extend_to(first);
        self.extend_to(batch.last);
    }

    fn extend_to(&mut self, at: Instant) {
        let at_us = i64::try_from(at.as_micros()).unwrap_or(i64::MAX);
        let at_us = self.epoch_us.saturating_add(at_us);
        self.from_us = Some(self.from_us.unwrap_or(at_us).min(at_us));
        self.to_us = self.to_us.max(at_us);
    }

    /// The epoch of the earliest run, in microseconds since 1970.
    #[must_use]
    pub fn first_epoch_us(&self) -> i64 {
        self.first_epoch_us.unwrap_or_default()
    }

    /// The summary for the page; `None` if the session is empty.
    #[must_use]
    #[allow(
        clippy::cast_precision_loss,
        reason = "microseconds since 1970 fit into 53 bits until 2255"
    )]
    pub fn session(&self) -> Option<SavedSession> {
        let has_content = self.packets > 0 || self.recorded > 0;
        let from_us = self.from_us.filter(|_| has_content)?;
        Some(SavedSession {
            from_ms: from_us as f64 / 1000.0,
            to_ms: self.to_us as f64 / 1000.0,
            packets: self.packets,
            recorded: self.recorded,
            recorded_ms: u64::try_from(self.recorded_for.as_millis()).unwrap_or(u64::MAX),
        })
    }
}
