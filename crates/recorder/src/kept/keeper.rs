//! Which bytes go into which file, when, and which files have to go.

use std::{collections::VecDeque, time::Duration};

use motorlink_bus::LineEvent;
use motorlink_messages::recorder::push_traffic;
use motorlink_protocol::Instant;

use super::{
    Segment, Stream,
    content::{Note, push_batch, push_epoch, push_note},
};
use crate::texts::cut;

/// Bytes of one file, about: what one rotation gives up of a log that is full.
pub const SEGMENT_BYTES_MAX: usize = 2 << 20;

/// Bytes of packets that are kept at least before any goes: a million entries of 19 bytes, which is 1 for
/// the kind, 5 for the time and 13 for a frame with what is known of it.
pub const PACKETS_BYTES_MAX: usize = 20_000_000;

/// A crash may cost a second. Traffic comes 50 ms late, and a write takes milliseconds.
const WRITE_WITHIN: Duration = Duration::from_millis(250);

/// What was written outlives the page at once, and a power cut from then on.
const FLUSH_PERIOD: Duration = Duration::from_secs(5);

/// Bytes of traffic in a block, half of what a block holds.
const BATCH_BYTES: usize = 1 << 15;

/// Bytes that wait for the first epoch, without which no time is known.
const EARLY_BYTES_MAX: usize = 1 << 20;

/// What is to be done with the files of the session, in this order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Act {
    /// Add these bytes to this file; where there is no such file, it begins with them.
    Append(Segment, Vec<u8>),
    /// Remove this file.
    Remove(Segment),
    /// See to it that what was written outlives a power cut.
    Flush,
    /// The files of this session are from now on behind those of the session that is restored: the
    /// numbers of either stream are so much greater.
    Adopt {
        /// Of packets.
        packets: u32,
        /// Of recorded samples.
        recorded: u32,
    },
    /// Remove every session, this one too, and tell the page. It begins anew.
    Erase,
}

/// Keeps what goes into the recorder.
#[derive(Debug, Default)]
pub struct Keeper {
    epoch_us: Option<i64>,
    packets: Tape,
    recorded: Tape,
    /// Since when something waits to be written.
    waiting_since: Option<Instant>,
    /// Since when something written has not been flushed.
    unflushed_since: Option<Instant>,
    acts: VecDeque<Act>,
}

impl Keeper {
    /// From now on times count from this moment, in microseconds since 1970.
    pub fn set_epoch(&mut self, epoch_us: i64) {
        if self.epoch_us == Some(epoch_us) {
            return;
        }
        if let Some(epoch_us) = self.epoch_us {
            // What waits belongs to the epoch before.
            self.write(epoch_us);
        }
        self.epoch_us = Some(epoch_us);
        self.packets.wants_epoch = true;
        self.recorded.wants_epoch = true;
    }

    /// This passed on the line; `recorded` where it is a sample of the recording too.
    pub fn passed(&mut self, traffic: &LineEvent, recorded: bool) {
        self.packets.pass(traffic);
        if recorded {
            self.recorded.pass(traffic);
        }
    }

    /// The page said this.
    pub fn say(&mut self, at: Instant, error: bool, text: &str) {
        let text = cut(text).to_owned();
        self.packets.note(&Note::Say { at, error, text });
    }

    /// The log was cleared.
    pub fn clear(&mut self) {
        self.packets.note(&Note::Clear);
    }

    /// The recording began or ended; `anew` where it forgot what there was.
    pub fn record(&mut self, on: bool, anew: bool) {
        if anew {
            let gone = self.recorded.begin_anew();
            self.acts
                .extend(gone.map(|number| removal(Stream::Recorded, number)));
        }
        self.recorded.note(&Note::Record(on));
    }

    /// A file was made of all that was recorded.
    pub fn exported(&mut self) {
        self.recorded.note(&Note::Exported);
    }

    /// This session goes on behind another, of which these are the files in order, and their sizes.
    pub fn adopt(&mut self, before: &[(Segment, usize)]) {
        let packets = self.packets.go_behind(Stream::Packets, before);
        let recorded = self.recorded.go_behind(Stream::Recorded, before);
        self.acts.push_back(Act::Adopt { packets, recorded });
    }

    /// Everything that is kept is to be removed.
    pub fn erase(&mut self) {
        *self = Self {
            epoch_us: self.epoch_us,
            packets: Tape::new(),
            recorded: Tape::new(),
            acts: VecDeque::from([Act::Erase]),
            ..Self::default()
        };
    }

    /// What is to be done now.
    #[inline(never)]
    pub fn poll(&mut self, now: Instant) -> Option<Act> {
        if let Some(act) = self.acts.pop_front() {
            return Some(act);
        }
        if self.packets.waits() || self.recorded.waits() {
            let since = *self.waiting_since.get_or_insert(now);
            if let Some(epoch_us) = self.epoch_us {
                if now >= since + WRITE_WITHIN {
                    self.waiting_since = None;
                    self.unflushed_since.get_or_insert(now);
                    self.write(epoch_us);
                    return self.acts.pop_front();
                }
            } else {
                self.packets.bound(EARLY_BYTES_MAX);
            }
        }
        let flush = self.flush_at().is_some_and(|at| at <= now);
        flush.then(|| {
            self.unflushed_since = None;
            Act::Flush
        })
    }

    /// When it is to be polled again though nothing has come.
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
        self.acts
            .extend(self.packets.write(Stream::Packets, epoch_us));
        self.acts
            .extend(self.recorded.write(Stream::Recorded, epoch_us));
        while let Some(number) = self.packets.give_way() {
            self.acts.push_back(removal(Stream::Packets, number));
        }
    }
}

const fn removal(stream: Stream, number: u32) -> Act {
    Act::Remove(Segment { stream, number })
}

/// One stream of blocks, cut into files.
#[derive(Debug, Default)]
struct Tape {
    /// The files there are, with their sizes; the last is written to.
    files: VecDeque<(u32, usize)>,
    /// The greatest number that was used.
    last: u32,
    wants_epoch: bool,
    /// Blocks that wait to be written.
    blocks: Vec<u8>,
    /// Traffic that is to be the next block.
    batch: Vec<u8>,
    batch_count: u32,
    batch_last: Instant,
}

impl Tape {
    fn new() -> Self {
        Self {
            wants_epoch: true,
            ..Self::default()
        }
    }

    fn pass(&mut self, traffic: &LineEvent) {
        push_traffic(&mut self.batch, traffic);
        self.batch_count += 1;
        self.batch_last = traffic.at;
        if self.batch.len() > BATCH_BYTES {
            self.end_batch();
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
            self.batch_count = 0;
        }
    }

    const fn waits(&self) -> bool {
        self.batch_count > 0 || !self.blocks.is_empty()
    }

    /// Forgets what waits where that is too much.
    fn bound(&mut self, bytes_max: usize) {
        if self.blocks.len() + self.batch.len() > bytes_max {
            self.blocks.clear();
            self.batch.clear();
            self.batch_count = 0;
        }
    }

    fn write(&mut self, stream: Stream, epoch_us: i64) -> Option<Act> {
        if !self.waits() {
            return None;
        }
        self.end_batch();
        let blocks = std::mem::take(&mut self.blocks);
        let full = |size: usize| size + blocks.len() > SEGMENT_BYTES_MAX;
        if self.files.back().is_none_or(|(_, size)| full(*size)) {
            self.last += 1;
            self.files.push_back((self.last, 0));
            self.wants_epoch = true;
        }
        let mut bytes = Vec::with_capacity(blocks.len() + 32);
        if std::mem::take(&mut self.wants_epoch) {
            push_epoch(&mut bytes, epoch_us);
        }
        bytes.extend(blocks);
        let (number, size) = self.files.back_mut()?;
        *size += bytes.len();
        let number = *number;
        Some(Act::Append(Segment { stream, number }, bytes))
    }

    /// The oldest file, where those behind it are enough.
    fn give_way(&mut self) -> Option<u32> {
        let kept: usize = self.files.iter().skip(1).map(|(_, size)| size).sum();
        if self.files.len() < 2 || kept < PACKETS_BYTES_MAX {
            return None;
        }
        self.files.pop_front().map(|(number, _)| number)
    }

    /// Forgets everything; gives the files that were.
    fn begin_anew(&mut self) -> impl Iterator<Item = u32> + use<> {
        let files = std::mem::take(&mut self.files);
        let last = self.last;
        *self = Self {
            last,
            ..Self::new()
        };
        files.into_iter().map(|(number, _)| number)
    }

    /// Numbers its files behind these, and counts these as its own. Gives how much greater the numbers are.
    fn go_behind(&mut self, stream: Stream, before: &[(Segment, usize)]) -> u32 {
        let mut files: VecDeque<(u32, usize)> = before
            .iter()
            .filter(|(segment, _)| segment.stream == stream)
            .map(|(segment, size)| (segment.number, *size))
            .collect();
        let shift = files.back().map_or(0, |(number, _)| *number);
        // Where it has no file yet, it begins one of its own: the last one of the other may be torn.
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
