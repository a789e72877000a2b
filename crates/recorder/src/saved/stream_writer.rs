//! Writes one stream of a session: blocks, split into files.

use std::collections::VecDeque;

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_messages::recorder::push_traffic;
use motorlink_protocol::{Instant, family::Model};

use super::{
    Segment, Stream,
    content::{Note, push_batch, push_epoch, push_note, push_state},
};
use crate::{marks::Marks, recording::Sample};

/// Approximate bytes of one file: a full log loses this much per rotation.
pub const SEGMENT_BYTES_MAX: usize = 2 << 20;

/// Bytes of packets before the oldest file is removed: a million entries of 19 bytes, which are 1 for the
/// kind, 5 for the time and 13 for a frame with its layout, and the states of four motors in the same time.
pub const PACKETS_BYTES_MAX: usize = 48_000_000;

/// Bytes of line events in a block: half of its maximum.
const BATCH_BYTES: usize = 1 << 15;

/// Collects line events and notes in blocks, and assigns the blocks to files.
#[derive(Debug, Default)]
pub(super) struct StreamWriter {
    /// The existing files with their sizes; bytes are appended to the last.
    files: VecDeque<(u32, usize)>,
    /// The greatest used number.
    last: u32,
    pub(super) wants_epoch: bool,
    /// Blocks that are not written yet.
    blocks: Vec<u8>,
    /// Line events of the next block.
    batch: Vec<u8>,
    batch_count: u32,
    batch_last: Instant,
    /// The model of the line, and before the blocks that are not written yet.
    model: Model,
    model_before: Model,
    /// The marks that the next block contains. Each block repeats them: the block before may be damaged.
    marks: Marks,
}

impl StreamWriter {
    pub(super) fn new() -> Self {
        Self {
            wants_epoch: true,
            ..Self::default()
        }
    }

    /// A new one on the same line.
    pub(super) fn begun_again(&self) -> Self {
        Self {
            model: self.model,
            model_before: self.model,
            ..Self::new()
        }
    }

    #[inline(never)]
    pub(super) fn pass(&mut self, traffic: &LineEvent) {
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

    /// A mark counts as no event.
    pub(super) fn mark(&mut self, sample: &Sample) {
        let model = self.marks.model(sample.at, sample.model);
        for mark in model.into_iter().chain(self.marks.sample(sample)) {
            push_traffic(&mut self.batch, &mark);
        }
    }

    pub(super) fn note(&mut self, note: &Note) {
        self.end_batch();
        push_note(&mut self.blocks, note);
    }

    pub(super) fn state(&mut self, at: Instant, stored: &[u8]) {
        self.end_batch();
        push_state(&mut self.blocks, at, stored);
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

    pub(super) const fn waits(&self) -> bool {
        self.batch_count > 0 || !self.blocks.is_empty()
    }

    /// Drops unwritten bytes if they exceed the limit.
    pub(super) fn bound(&mut self, bytes_max: usize) {
        if self.blocks.len() + self.batch.len() > bytes_max {
            self.model_before = self.model;
            self.blocks.clear();
            self.batch.clear();
            self.marks.clear();
            self.batch_count = 0;
        }
    }

    pub(super) fn write(&mut self, stream: Stream, epoch_us: i64) -> Option<(Segment, Vec<u8>)> {
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
        Some((Segment { stream, number }, bytes))
    }

    /// Takes the oldest file, if the others are enough.
    pub(super) fn drop_oldest(&mut self) -> Option<u32> {
        let kept: usize = self.files.iter().skip(1).map(|(_, size)| size).sum();
        if self.files.len() < 2 || kept < PACKETS_BYTES_MAX {
            return None;
        }
        self.files.pop_front().map(|(number, _)| number)
    }

    /// Starts again; returns the numbers of the previous files.
    pub(super) fn restart(&mut self) -> impl Iterator<Item = u32> + use<> {
        let files = std::mem::take(&mut self.files);
        let last = self.last;
        *self = Self {
            last,
            ..Self::new()
        };
        files.into_iter().map(|(number, _)| number)
    }

    /// Takes over these files and renumbers its own after them. Returns by how much the numbers grew.
    pub(super) fn continue_after(&mut self, stream: Stream, before: &[(Segment, usize)]) -> u32 {
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
