//! Decides which bytes to append to which file and when, and which files to remove.

use std::{collections::VecDeque, time::Duration};

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_messages::recorder::push_traffic;
use motorlink_protocol::{Instant, family::Model};

use super::{
    Segment, Stream,
    content::{Note, push_batch, push_epoch, push_note},
};
use crate::{
    commanded::{Commanded, Commands},
    texts::cut,
};

/// Approximate bytes of one file: a full log loses this much per rotation.
pub const SEGMENT_BYTES_MAX: usize = 2 << 20;

/// Bytes of packets before the oldest file is removed: a million entries of 19 bytes, which are 1 for the
/// kind, 5 for the time and 13 for a frame with its layout.
pub const PACKETS_BYTES_MAX: usize = 20_000_000;

/// A crash may lose one second. Line events arrive 50 ms late, and a write takes milliseconds.
const WRITE_WITHIN: Duration = Duration::from_millis(250);

/// Written bytes survive a crash of the page at once, and a power cut after a flush.
const FLUSH_PERIOD: Duration = Duration::from_secs(5);

/// Bytes of line events in a block: half of its maximum.
const BATCH_BYTES: usize = 1 << 15;

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

    /// Saves the command of the recorded sample that follows, where it differs from the one before.
    pub(crate) fn mark(&mut self, sample: &LineEvent, commanded: Option<Commanded>) {
        self.recorded.mark(sample, commanded);
    }

    /// Adds a message of the page.
    pub fn add_message(&mut self, at: Instant, error: bool, text: &str) {
        let text = cut(text).to_owned();
        self.packets.note(&Note::Message { at, error, text });
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
        self.actions
            .extend(self.packets.write(Stream::Packets, epoch_us));
        self.actions
            .extend(self.recorded.write(Stream::Recorded, epoch_us));
        while let Some(number) = self.packets.drop_oldest() {
            self.actions.push_back(removal(Stream::Packets, number));
        }
    }
}

const fn removal(stream: Stream, number: u32) -> StoreAction {
    StoreAction::Remove(Segment { stream, number })
}

/// Writes one stream of blocks, split into files.
#[derive(Debug, Default)]
struct StreamWriter {
    /// The existing files with their sizes; bytes are appended to the last.
    files: VecDeque<(u32, usize)>,
    /// The greatest used number.
    last: u32,
    wants_epoch: bool,
    /// Blocks that are not written yet.
    blocks: Vec<u8>,
    /// Line events of the next block.
    batch: Vec<u8>,
    batch_count: u32,
    batch_last: Instant,
    /// The model of the line, and before the blocks that are not written yet.
    model: Model,
    model_before: Model,
    /// The commands that the next block contains. Each block repeats them: the block before may be damaged.
    marks: Commands,
}

impl StreamWriter {
    fn new() -> Self {
        Self {
            wants_epoch: true,
            ..Self::default()
        }
    }

    /// A new one on the same line.
    fn begun_again(&self) -> Self {
        Self {
            model: self.model,
            model_before: self.model,
            ..Self::new()
        }
    }

    #[inline(never)]
    fn pass(&mut self, traffic: &LineEvent) {
        push_traffic(&mut self.batch, traffic);
        if let LineEventKind::ModelSelected(model) = traffic.kind {
            // It counts as no event.
            self.model = model;
            return;
        }
        self.batch_count += 1;
        self.batch_last = traffic.at;
        if self.batch.len() > BATCH_BYTES {
            self.end_batch();
        }
    }

    /// The mark counts as no event.
    fn mark(&mut self, sample: &LineEvent, commanded: Option<Commanded>) {
        let LineEventKind::Received { frame, .. } = &sample.kind else {
            return;
        };
        let [address, ..] = *frame.bytes();
        if let Some(mark) = self.marks.mark(address, sample.at, commanded) {
            push_traffic(&mut self.batch, &mark);
        }
    }

    fn note(&mut self, note: &Note) {
        self.end_batch();
        push_note(&mut self.blocks, note);
    }

    fn end_batch(&mut self) {
        if self.batch_count > 0 {
            push_batch(
                &mut self.blocks,
                self.batch_count,
                self.batch_last,
                &self.batch,
            );
            self.batch.clear();
            self.marks.clear();
            self.batch_count = 0;
        }
    }

    const fn waits(&self) -> bool {
        self.batch_count > 0 || !self.blocks.is_empty()
    }

    /// Drops unwritten bytes if they exceed the limit.
    fn bound(&mut self, bytes_max: usize) {
        if self.blocks.len() + self.batch.len() > bytes_max {
            self.model_before = self.model;
            self.blocks.clear();
            self.batch.clear();
            self.marks.clear();
            self.batch_count = 0;
        }
    }

    fn write(&mut self, stream: Stream, epoch_us: i64) -> Option<StoreAction> {
        if !self.waits() {
            return None;
        }
        self.end_batch();
        let blocks = std::mem::take(&mut self.blocks);
        let full = |size: usize| size + blocks.len() > SEGMENT_BYTES_MAX;
        let is_new = self.files.back().is_none_or(|(_, size)| full(*size));
        if is_new {
            self.last += 1;
            self.files.push_back((self.last, 0));
            self.wants_epoch = true;
        }
        let mut bytes = Vec::with_capacity(blocks.len() + 32);
        if std::mem::take(&mut self.wants_epoch) {
            push_epoch(&mut bytes, epoch_us);
        }
        let model = std::mem::replace(&mut self.model_before, self.model);
        if is_new && model.has_separate_frames() {
            // The files before it may be gone.
            let at = self.batch_last;
            let kind = LineEventKind::ModelSelected(model);
            let mut begins = Vec::new();
            push_traffic(&mut begins, &LineEvent { at, kind });
            push_batch(&mut bytes, 0, at, &begins);
        }
        bytes.extend(blocks);
        let (number, size) = self.files.back_mut()?;
        *size += bytes.len();
        let number = *number;
        Some(StoreAction::Append(Segment { stream, number }, bytes))
    }

    /// Takes the oldest file, if the others are enough.
    fn drop_oldest(&mut self) -> Option<u32> {
        let kept: usize = self.files.iter().skip(1).map(|(_, size)| size).sum();
        if self.files.len() < 2 || kept < PACKETS_BYTES_MAX {
            return None;
        }
        self.files.pop_front().map(|(number, _)| number)
    }

    /// Starts again; returns the numbers of the previous files.
    fn restart(&mut self) -> impl Iterator<Item = u32> + use<> {
        let files = std::mem::take(&mut self.files);
        let last = self.last;
        *self = Self {
            last,
            ..Self::new()
        };
        files.into_iter().map(|(number, _)| number)
    }

    /// Takes over these files and renumbers its own after them. Returns by how much the numbers grew.
    fn continue_after(&mut self, stream: Stream, before: &[(Segment, usize)]) -> u32 {
        let mut files: VecDeque<(u32, usize)> = before
            .iter()
            .filter(|(segment, _)| segment.stream == stream)
            .map(|(segment, size)| (segment.number, *size))
            .collect();
        let shift = files.back().map_or(0, |(number, _)| *number);
        // Always continue in a new file, because the last file of the other session may be truncated.
        let own = self.files.iter();
        files.extend(own.map(|(number, size)| (number.saturating_add(shift), *size)));
        let begins = self.files.is_empty();
        self.files = files;
        self.last = self.last.saturating_add(shift);
        self.wants_epoch |= begins;
        if begins && !self.files.is_empty() {
            self.last += 1;
            self.files.push_back((self.last, 0));
        }
        shift
    }
}
