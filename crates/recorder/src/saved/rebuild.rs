//! Rebuilds a log and a recording from the files of a session.

use motorlink_bus::LineEvent;
use motorlink_messages::recorder::Filter;

use super::{
    Stream, Timeline,
    block::Blocks,
    content::{Batch, Content, Note},
};
use crate::{log::Log, recording::Recording, states::State};

/// Reads the files of a session, in order, the packets first.
#[derive(Debug)]
pub(crate) struct Rebuild {
    pub(crate) log: Log,
    pub(crate) recording: Recording,
    pub(crate) timeline: Timeline,
    stream: Stream,
    blocks: Blocks,
}

impl Rebuild {
    /// Rebuilds this log and recording. The epoch is that of the earliest run, in microseconds since 1970.
    pub(crate) fn new(log: Log, recording: Recording, first_epoch_us: i64) -> Self {
        Self {
            log,
            recording,
            timeline: Timeline::from(first_epoch_us),
            stream: Stream::Packets,
            blocks: Blocks::new(Vec::new()),
        }
    }

    /// Sets the next file.
    pub(crate) fn take(&mut self, stream: Stream, bytes: Vec<u8>) {
        self.stream = stream;
        self.blocks = Blocks::new(bytes);
    }

    /// Reads this number of entries and the rest of their block. Returns whether the file is done.
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
                        log.add_event(&traffic);
                        recording.roll(&traffic);
                    }
                }
                (Stream::Recorded, Some(Content::Traffic(batch))) => {
                    played += u64::from(batch.count);
                    recording.begin_batch();
                    for traffic in placed(batch, timeline) {
                        recording.record_again(&traffic);
                    }
                }
                (_, Some(Content::Note(note))) => {
                    played += 1;
                    match note {
                        Note::Message { at, error, text } => {
                            log.add_message(timeline.at(at), error, &text);
                        }
                        Note::Clear => log.clear(),
                        Note::UndoClear => _ = log.undo_clear(&Filter::default()),
                        Note::Record(on) => {
                            // After a crash, the end of the previous recording is missing.
                            recording.record_on(false);
                            recording.record_on(on);
                        }
                        Note::Exported => recording.all_exported(),
                    }
                }
                (_, Some(Content::State(at, stored))) => {
                    played += 1;
                    let (at, stored) = (timeline.at(at), stored.to_vec());
                    log.add_state(State { at, stored });
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

#[cfg(test)]
mod tests {
    use motorlink_bus::LineEventKind;
    use motorlink_messages::recorder::push_traffic;
    use motorlink_protocol::{Instant, MotorId};

    use super::super::content::{push_batch, push_note, push_state};
    use super::*;

    const AT: Instant = Instant::from_micros(1);

    fn written(push: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
        let mut block = Vec::new();
        push(&mut block);
        block
    }

    fn silences(count: u32) -> Vec<u8> {
        let kind = LineEventKind::Silence {
            id: MotorId::FIRST,
            waited_us: 1000,
        };
        let batch = written(|batch| {
            for _ in 0..count {
                push_traffic(batch, &LineEvent { at: AT, kind });
            }
        });
        written(|file| push_batch(file, count, AT, &batch))
    }

    /// How many slices of one entry there are in a file.
    fn slices(stream: Stream, file: Vec<u8>) -> Option<usize> {
        let (log, recording) = (Log::with_capacity(10), Recording::with_capacity(10));
        let mut rebuild = Rebuild::new(log, recording, 0);
        rebuild.take(stream, file);
        (0..10).find(|_| rebuild.advance(1))
    }

    #[test]
    fn each_kind_of_entry_counts_and_a_block_is_read_to_its_end() {
        let note = written(|file| push_note(file, &Note::Exported));
        let state = written(|file| push_state(file, AT, &[]));
        for (stream, entry) in [
            (Stream::Packets, silences(1)),
            (Stream::Packets, silences(2)),
            (Stream::Recorded, silences(1)),
            (Stream::Packets, note),
            (Stream::Packets, state),
        ] {
            for entries in 0..3 {
                assert_eq!(slices(stream, entry.repeat(entries)), Some(entries));
            }
        }
    }
}
