//! A log and a recording made again from what was kept.

use motorlink_bus::LineEvent;

use super::{
    Stream, Timeline,
    block::Blocks,
    content::{Batch, Content, Note},
};
use crate::{log::Log, recording::Recording};

/// Takes the files of a session, in their order: those of the packets first.
#[derive(Debug)]
pub(crate) struct Replay {
    pub(crate) log: Log,
    pub(crate) recording: Recording,
    pub(crate) timeline: Timeline,
    stream: Stream,
    blocks: Blocks,
}

impl Replay {
    /// Into this log and recording; the earliest run began at this epoch, in microseconds since 1970.
    pub(crate) fn new(log: Log, recording: Recording, first_epoch_us: i64) -> Self {
        Self {
            log,
            recording,
            timeline: Timeline::from(first_epoch_us),
            stream: Stream::Packets,
            blocks: Blocks::new(Vec::new()),
        }
    }

    /// The next file.
    pub(crate) fn take(&mut self, stream: Stream, bytes: Vec<u8>) {
        self.stream = stream;
        self.blocks = Blocks::new(bytes);
    }

    /// Plays so many entries, and the rest of their block. Says whether the file is through.
    pub(crate) fn advance(&mut self, entries: u64) -> bool {
        let mut played = 0;
        while played < entries {
            let Self {
                log,
                recording,
                timeline,
                stream,
                blocks,
            } = self;
            let Some(block) = blocks.next_block() else {
                return true;
            };
            match (*stream, Content::read(block)) {
                (Stream::Packets, Some(Content::Epoch(epoch_us))) => timeline.begin(epoch_us),
                (Stream::Recorded, Some(Content::Epoch(epoch_us))) => timeline.recall(epoch_us),
                (Stream::Packets, Some(Content::Traffic(batch))) => {
                    played += u64::from(batch.count);
                    for traffic in placed(batch, timeline) {
                        log.passed(&traffic);
                        recording.roll(&traffic);
                    }
                }
                (Stream::Recorded, Some(Content::Traffic(batch))) => {
                    played += u64::from(batch.count);
                    for traffic in placed(batch, timeline) {
                        recording.record_again(&traffic);
                    }
                }
                (_, Some(Content::Note(note))) => {
                    played += 1;
                    match note {
                        Note::Say { at, error, text } => log.say(timeline.at(at), error, &text),
                        Note::Clear => log.clear(),
                        Note::Record(on) => {
                            // A crash ended the one before without a word.
                            recording.record_on(false);
                            recording.record_on(on);
                        }
                        Note::Exported => recording.all_exported(),
                    }
                }
                (_, None) => {}
            }
        }
        false
    }
}

fn placed(batch: Batch<'_>, timeline: &mut Timeline) -> impl Iterator<Item = LineEvent> {
    batch.traffic().map(|traffic| LineEvent {
        at: timeline.at(traffic.at),
        ..traffic
    })
}
