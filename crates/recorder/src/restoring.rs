//! A kept session on its way into the recorder, a slice at a time.
//!
//! It is played into a log and a recording of its own, while the recorder goes on. Then what the recorder has
//! is copied behind it until nothing is left to copy, and the two change places.

use motorlink_messages::recorder::{Filter, FromRecorder, PAST_SAMPLES_MAX};

use crate::{
    kept::{Replay, Stream, Timeline},
    log::Log,
    recording::Recording,
    wall_clock::WallClock,
};

/// A session that is being restored.
#[derive(Debug)]
pub(crate) struct Restoring {
    replay: Replay,
    stage: Stage,
    /// The log was cleared meanwhile: nothing of it is to come back.
    cleared: bool,
}

#[derive(Debug)]
enum Stage {
    /// Another file is needed.
    NeedsFile,
    /// It was asked for.
    Waiting,
    /// A file is being played.
    Playing,
    /// What the recorder has is being copied: which number is next, of the log and of either kind of sample.
    Copying {
        log: u64,
        samples: [u64; 2],
        /// The number behind the last rolling sample that was restored.
        past_end: u64,
    },
}

/// Restored samples that the page has not been given yet.
#[derive(Debug)]
pub(crate) struct Past {
    /// How much later the zero of their times is than that of this session, in microseconds.
    zero_us: i64,
    /// The number behind the last of them.
    until: u64,
}

impl Past {
    /// The next part of them, from the newest on; `None` when all have been given.
    pub(crate) fn next(&mut self, recording: &Recording) -> Option<FromRecorder> {
        let samples = recording.rolling_before(self.until, PAST_SAMPLES_MAX);
        self.until = self.until.saturating_sub(PAST_SAMPLES_MAX.into());
        let zero_us = self.zero_us;
        (!samples.is_empty()).then_some(FromRecorder::Past { zero_us, samples })
    }
}

/// What it wants of the recorder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wants {
    /// The next file. It wants it once.
    File,
    /// To go on.
    Work,
    /// To be let alone.
    Nothing,
}

impl Restoring {
    /// Into a log and a recording as large as these, by the clock of the earliest run.
    pub(crate) fn new(clock: WallClock, log: &Log, recording: &Recording) -> Self {
        let mut restored = Log::with_capacity(log.capacity());
        restored.set_clock(clock);
        let recording = Recording::with_capacity(recording.capacity());
        Self {
            replay: Replay::new(restored, recording, clock.zero_us()),
            stage: Stage::NeedsFile,
            cleared: false,
        }
    }

    pub(crate) const fn wants(&mut self) -> Wants {
        match self.stage {
            Stage::NeedsFile => {
                self.stage = Stage::Waiting;
                Wants::File
            }
            Stage::Waiting => Wants::Nothing,
            Stage::Playing | Stage::Copying { .. } => Wants::Work,
        }
    }

    /// The file that was asked for, or the end of them.
    pub(crate) fn take(&mut self, file: Option<(Stream, Vec<u8>)>) {
        self.stage = if let Some((stream, bytes)) = file {
            self.replay.take(stream, bytes);
            Stage::Playing
        } else {
            // Whoever recorded then does not record now.
            self.replay.recording.record_on(false);
            Stage::Copying {
                log: 0,
                samples: [0; 2],
                past_end: self.replay.recording.rolling_end(),
            }
        };
    }

    /// Every entry of the log is to be forgotten.
    pub(crate) fn clear(&mut self) {
        self.replay.log.clear();
        self.cleared = true;
        if let Stage::Copying { log, .. } = &mut self.stage {
            *log = 0;
        }
    }

    /// Does so much. Says whether nothing is left to do: then [`Self::finish`] is due at once.
    #[inline(never)]
    pub(crate) fn advance(
        &mut self,
        log: &mut Log,
        recording: &Recording,
        epoch_us: Option<i64>,
        entries: u64,
    ) -> bool {
        let Self { replay, stage, .. } = self;
        let Stage::Copying {
            log: next, samples, ..
        } = stage
        else {
            if replay.advance(entries) {
                *stage = Stage::NeedsFile;
            }
            return false;
        };
        if self.cleared {
            replay.log.clear();
            self.cleared = false;
        }
        if let Some(epoch_us) = epoch_us {
            replay.timeline.begin(epoch_us);
        }
        // From now on a late entry cannot come before one that was copied.
        let settled = log.settle();
        *next = (*next).max(settled.start);
        let until = settled.end.min(*next + entries);
        while *next < until {
            let timeline = &mut replay.timeline;
            replay.log.copy(log, *next, |at| timeline.at(at));
            *next += 1;
        }
        let timeline = &mut replay.timeline;
        let samples_are_through = replay
            .recording
            .copy(recording, samples, entries, |at| timeline.at(at));
        samples_are_through && *next >= settled.end
    }

    /// The log, the recording and the timeline with which the recorder goes on, and what the page is told of
    /// the samples.
    pub(crate) fn finish(
        self,
        log: &mut Log,
        recording: &Recording,
        filter: &Filter,
    ) -> (Log, Recording, Timeline, Past) {
        let mut replay = self.replay;
        let until = match self.stage {
            Stage::Copying { past_end, .. } => past_end,
            Stage::NeedsFile | Stage::Waiting | Stage::Playing => 0,
        };
        replay.log.go_on_as(log, filter);
        let timeline = &mut replay.timeline;
        replay.recording.go_on_as(recording, |at| timeline.at(at));
        let past = Past {
            zero_us: timeline.zero_us().saturating_neg(),
            until,
        };
        (replay.log, replay.recording, replay.timeline, past)
    }
}
