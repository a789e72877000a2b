//! The content of a block.

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_messages::recorder::traffic;
use motorlink_protocol::Instant;
use serde::{Deserialize, Serialize, de::DeserializeOwned};

use super::{before, block::push_block};

const HEAD: u8 = 1;
/// Of an earlier version: see [`before`].
const TRAFFIC_BEFORE: u8 = 2;
const NOTE: u8 = 3;
const STATE: u8 = 4;
const TRAFFIC: u8 = 5;

/// The content of one block.
#[derive(Debug)]
pub(super) enum Content<'a> {
    /// The zero of every [`Instant`] from here on, in microseconds since 1970. Each file starts with one, so
    /// that it can be read without the files before it; a page load adds another.
    Epoch(i64),
    /// Line events.
    Traffic(Batch<'a>),
    /// Anything else.
    Note(Note),
    /// What the page showed from this time on.
    State(Instant, &'a [u8]),
}

/// Encoded line events, with the figures for a summary.
#[derive(Clone, Copy, Debug)]
pub(super) struct Batch<'a> {
    /// Without marks.
    pub(super) count: u32,
    /// The time of the last one.
    pub(super) last: Instant,
    bytes: &'a [u8],
    is_from_before: bool,
}

/// Any other input.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Note {
    /// A message of the page.
    Message {
        at: Instant,
        error: bool,
        text: String,
    },
    /// The log was cleared.
    Clear,
    /// The recording began or ended.
    Record(bool),
    /// All recorded samples were exported.
    Exported,
    /// The log before the last [`Note::Clear`] is back.
    UndoClear,
}

impl<'a> Batch<'a> {
    pub(super) fn traffic(self) -> impl Iterator<Item = LineEvent> + use<'a> {
        let (now, before) = if self.is_from_before {
            (&[][..], self.bytes)
        } else {
            (self.bytes, &[][..])
        };
        traffic(now).chain(before::traffic(before))
    }

    /// Without the marks between recorded samples.
    pub(super) fn samples(self) -> impl Iterator<Item = LineEvent> + use<'a> {
        let is_sample = |event: &LineEvent| matches!(event.kind, LineEventKind::Received { .. });
        self.traffic().filter(is_sample)
    }
}

impl<'a> Content<'a> {
    /// Reads a block; `None` where it is of a kind that a later version writes.
    pub(super) fn read((kind, bytes): (u8, &'a [u8])) -> Option<Self> {
        Some(match kind {
            HEAD => Self::Epoch(whole(bytes)?),
            TRAFFIC | TRAFFIC_BEFORE => {
                let ((count, last), bytes) = postcard::take_from_bytes(bytes).ok()?;
                Self::Traffic(Batch {
                    count,
                    last,
                    bytes,
                    is_from_before: kind == TRAFFIC_BEFORE,
                })
            }
            NOTE => Self::Note(whole(bytes)?),
            STATE => {
                let (at, stored) = postcard::take_from_bytes(bytes).ok()?;
                Self::State(at, stored)
            }
            _ => return None,
        })
    }
}

fn whole<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    postcard::from_bytes(bytes).ok()
}

pub(super) fn push_epoch(out: &mut Vec<u8>, epoch_us: i64) {
    push(out, HEAD, &epoch_us, &[]);
}

pub(super) fn push_note(out: &mut Vec<u8>, note: &Note) {
    push(out, NOTE, note, &[]);
}

pub(super) fn push_state(out: &mut Vec<u8>, at: Instant, stored: &[u8]) {
    push(out, STATE, &at, stored);
}

/// Adds a batch of line events, already encoded.
pub(super) fn push_batch(out: &mut Vec<u8>, count: u32, last: Instant, traffic: &[u8]) {
    push(out, TRAFFIC, &(count, last), traffic);
}

fn push<T: Serialize>(out: &mut Vec<u8>, kind: u8, head: &T, behind: &[u8]) {
    // It always encodes.
    if let Ok(mut content) = postcard::to_allocvec(head) {
        content.extend(behind);
        push_block(out, kind, &content);
    }
}
