//! Decides when to write, and which files to remove.

use std::{collections::VecDeque, time::Duration};

use motorlink_bus::LineEvent;
use motorlink_protocol::Instant;

use super::{Segment, Stream, content::Note, stream_writer::StreamWriter};
use crate::{recording::Sample, stored_texts::cut};

/// A crash may lose one second. Line events arrive 50 ms late, and a write takes milliseconds.
const WRITE_WITHIN: Duration = Duration::from_millis(250);

/// Written bytes survive a crash of the page at once, and a power cut after a flush.
const FLUSH_PERIOD: Duration = Duration::from_secs(5);

/// Bytes that wait for the first epoch; without it no time is known.
const EARLY_BYTES_MAX: usize = 1 << 20;

/// An action on the files of the session. The order of actions matters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StoreAction {
    /// Append these bytes to this file, or create it with them.
    Append(Segment, Vec<u8>),
    /// Remove this file.
    Remove(Segment),
    /// Flush the files, so that they survive a power cut.
    Flush,
    /// The files of this session continue after those of the restored session: their numbers grow by
    /// this much.
    Adopt {
        /// Of packets.
        packets: u32,
        /// Of recorded samples.
        recorded: u32,
    },
    /// Remove every session including this one, and tell the page. The session starts again.
    Erase,
}

/// Writes the inputs of the recorder.
#[derive(Debug, Default)]
pub struct SessionWriter {
    epoch_us: Option<i64>,
    packets: StreamWriter,
    recorded: StreamWriter,
    /// Since when unwritten bytes wait.
    waiting_since: Option<Instant>,
    /// Since when written bytes wait for a flush.
    unflushed_since: Option<Instant>,
    actions: VecDeque<StoreAction>,
}

impl SessionWriter {
    /// Sets the epoch of all times from now on, in microseconds since 1970.
    pub fn set_epoch(&mut self, epoch_us: i64) {
        if self.epoch_us == Some(epoch_us) {
            return;
        }
        if let Some(epoch_us) = self.epoch_us {
            // Waiting bytes belong to the previous epoch.
            self.write(epoch_us);
        }
        self.epoch_us = Some(epoch_us);
        self.packets.wants_epoch = true;
        self.recorded.wants_epoch = true;
    }

    /// Adds a line event; `recorded` if it is also a recorded sample.
    pub fn add_event(&mut self, traffic: &LineEvent, recorded: bool) {
        self.packets.pass(traffic);
        if recorded {
            self.recorded.pass(traffic);
        }
    }

    /// Saves what is known at the recorded sample that follows, where it differs from the one before.
    pub(crate) fn mark(&mut self, sample: &Sample) {
        self.recorded.mark(sample);
    }

    /// Adds a message of the page.
    pub fn add_message(&mut self, at: Instant, error: bool, text: &str) {
        let text = cut(text).to_owned();
        self.packets.note(&Note::Message { at, error, text });
    }

    /// Adds a stored state of the page.
    pub(crate) fn add_state(&mut self, at: Instant, stored: &[u8]) {
        self.packets.state(at, stored);
    }

    /// The log was cleared.
    pub fn clear(&mut self) {
        self.packets.note(&Note::Clear);
    }

    /// The last clearing of the log was undone.
    pub fn undo_clear(&mut self) {
        self.packets.note(&Note::UndoClear);
    }

    /// The recording began or ended; `restarted` if it discarded the samples before.
    pub fn record(&mut self, on: bool, restarted: bool) {
        if restarted {
            let gone = self.recorded.restart();
            self.actions
                .extend(gone.map(|number| removal(Stream::Recorded, number)));
        }
        self.recorded.note(&Note::Record(on));
    }

    /// All recorded samples were exported.
    pub fn exported(&mut self) {
        self.recorded.note(&Note::Exported);
    }

    /// Continues another session, which has these files in order, with their sizes.
    pub fn adopt(&mut self, before: &[(Segment, usize)]) {
        let packets = self.packets.continue_after(Stream::Packets, before);
        let recorded = self.recorded.continue_after(Stream::Recorded, before);
        self.actions
            .push_back(StoreAction::Adopt { packets, recorded });
    }

    /// Removes all sessions.
    pub fn erase(&mut self) {
        *self = Self {
            epoch_us: self.epoch_us,
            packets: self.packets.begun_again(),
            recorded: StreamWriter::new(),
            actions: VecDeque::from([StoreAction::Erase]),
            ..Self::default()
        };
    }

    /// The next action that is due.
    #[inline(never)]
    pub fn poll(&mut self, now: Instant) -> Option<StoreAction> {
        if let Some(action) = self.actions.pop_front() {
            return Some(action);
        }
        if self.packets.waits() || self.recorded.waits() {
            let since = *self.waiting_since.get_or_insert(now);
            if let Some(epoch_us) = self.epoch_us {
                if now >= since + WRITE_WITHIN {
                    self.waiting_since = None;
                    self.unflushed_since.get_or_insert(now);
                    self.write(epoch_us);
                    return self.actions.pop_front();
                }
            } else {
                self.packets.bound(EARLY_BYTES_MAX);
            }
        }
        let flush = self.flush_at().is_some_and(|at| at <= now);
        flush.then(|| {
            self.unflushed_since = None;
            StoreAction::Flush
        })
    }

    /// When to poll again without new input.
    #[must_use]
    pub fn due(&self) -> Option<Instant> {
        let write_at = self.waiting_since.filter(|_| self.epoch_us.is_some());
        let write_at = write_at.map(|since| since + WRITE_WITHIN);
        write_at.into_iter().chain(self.flush_at()).min()
    }

    fn flush_at(&self) -> Option<Instant> {
        self.unflushed_since.map(|since| since + FLUSH_PERIOD)
    }

    fn write(&mut self, epoch_us: i64) {
        let packets = self.packets.write(Stream::Packets, epoch_us);
        let recorded = self.recorded.write(Stream::Recorded, epoch_us);
        for (segment, bytes) in packets.into_iter().chain(recorded) {
            self.actions.push_back(StoreAction::Append(segment, bytes));
        }
        while let Some(number) = self.packets.drop_oldest() {
            self.actions.push_back(removal(Stream::Packets, number));
        }
    }
}

const fn removal(stream: Stream, number: u32) -> StoreAction {
    StoreAction::Remove(Segment { stream, number })
}
