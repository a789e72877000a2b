//! Restores a saved session in slices.
//!
//! The saved session is read into a separate log and recording, while the recorder works as usual. Then
//! the entries of the recorder are appended to them, and they replace those of the recorder.

use motorlink_messages::recorder::{Filter, FromRecorder, PAST_SAMPLES_MAX};

use crate::{
    log::Log,
    recording::Recording,
    saved::{Rebuild, Stream, Timeline},
    wall_clock::WallClock,
};

/// A session that is being restored.
#[derive(Debug)]
pub(crate) struct Restoring {
    rebuild: Rebuild,
    stage: Stage,
    /// The log was cleared meanwhile: no restored entry may appear.
    cleared: bool,
}

#[derive(Debug)]
enum Stage {
    /// The next file is needed.
    NeedsFile,
    /// The next file was requested.
    Waiting,
    /// A file is being read.
    Playing,
    /// The recorder's entries are being copied. The numbers are the next ones to copy.
    Copying {
        log: u64,
        samples: [u64; 2],
        /// The number after the last restored rolling sample.
        past_end: u64,
    },
}

/// Restored samples that have not been posted to the page yet.
#[derive(Debug)]
pub(crate) struct Past {
    /// How much later the zero of their times is than that of this session, in microseconds.
    zero_us: i64,
    /// The number after the last of them.
    until: u64,
}

impl Past {
    /// The next part, the newest first; `None` when all have been posted.
    pub(crate) fn next(&mut self, recording: &Recording) -> Option<FromRecorder> {
        let samples = recording.rolling_before(self.until, PAST_SAMPLES_MAX);
        self.until = self.until.saturating_sub(PAST_SAMPLES_MAX.into());
        let zero_us = self.zero_us;
        (!samples.is_empty()).then_some(FromRecorder::Past { zero_us, samples })
    }
}

/// What restoring needs next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Need {
    /// The next file. It is requested once.
    File,
    /// A call of [`Restoring::advance`].
    Work,
    /// Nothing at the moment.
    Nothing,
}

impl Restoring {
    /// Restores into a log and a recording of the same capacity, with the clock of the earliest run.
    pub(crate) fn new(clock: WallClock, log: &Log, recording: &Recording) -> Self {
        let mut restored = Log::with_capacity(log.capacity());
        restored.set_clock(clock);
        let recording = Recording::with_capacity(recording.capacity());
        Self {
            rebuild: Rebuild::new(restored, recording, clock.zero_us()),
            stage: Stage::NeedsFile,
            cleared: false,
        }
    }

    pub(crate) const fn need(&mut self) -> Need {
        match self.stage {
            Stage::NeedsFile => {
                self.stage = Stage::Waiting;
                Need::File
            }
            Stage::Waiting => Need::Nothing,
            Stage::Playing | Stage::Copying { .. } => Need::Work,
        }
    }

    /// The requested file, or `None` after the last one.
    pub(crate) fn take(&mut self, file: Option<(Stream, Vec<u8>)>) {
        self.stage = if let Some((stream, bytes)) = file {
            self.rebuild.take(stream, bytes);
            Stage::Playing
        } else {
            // A recording that was on then is not on now.
            self.rebuild.recording.record_on(false);
            Stage::Copying {
                log: 0,
                samples: [0; 2],
                past_end: self.rebuild.recording.rolling_end(),
            }
        };
    }

    /// The log has been cleared.
    pub(crate) fn clear(&mut self) {
        self.rebuild.log.clear();
        self.cleared = true;
        if let Stage::Copying { log, .. } = &mut self.stage {
            *log = 0;
        }
    }

    /// Processes this number of entries. Returns true when done: then call [`Self::finish`] at once.
    #[inline(never)]
    pub(crate) fn advance(
        &mut self,
        log: &mut Log,
        recording: &Recording,
        epoch_us: Option<i64>,
        entries: u64,
    ) -> bool {
        let Self { rebuild, stage, .. } = self;
        let Stage::Copying {
            log: next, samples, ..
        } = stage
        else {
            if rebuild.advance(entries) {
                *stage = Stage::NeedsFile;
            }
            return false;
        };
        if self.cleared {
            rebuild.log.clear();
            self.cleared = false;
        }
        if let Some(epoch_us) = epoch_us {
            rebuild.timeline.begin(epoch_us);
        }
        // From now on a late entry cannot be inserted before a copied one.
        let settled = log.settle();
        *next = (*next).max(settled.start);
        let until = settled.end.min(*next + entries);
        while *next < until {
            let timeline = &mut rebuild.timeline;
            rebuild.log.copy(log, *next, |at| timeline.at(at));
            *next += 1;
        }
        let timeline = &mut rebuild.timeline;
        let samples_are_through = rebuild
            .recording
            .copy(recording, samples, entries, |at| timeline.at(at));
        samples_are_through && *next >= settled.end
    }

    /// The log, the recording and the timeline with which the recorder continues, and the samples for the
    /// page.
    pub(crate) fn finish(
        self,
        log: &mut Log,
        recording: &Recording,
        filter: &Filter,
    ) -> (Log, Recording, Timeline, Past) {
        let mut rebuild = self.rebuild;
        rebuild.log.forget_cleared();
        let until = match self.stage {
            Stage::Copying { past_end, .. } => past_end,
            Stage::NeedsFile | Stage::Waiting | Stage::Playing => 0,
        };
        let timeline = &mut rebuild.timeline;
        rebuild.log.continue_from(log, filter, |at| timeline.at(at));
        rebuild
            .recording
            .continue_from(recording, |at| timeline.at(at));
        let past = Past {
            zero_us: timeline.zero_us().saturating_neg(),
            until,
        };
        (rebuild.log, rebuild.recording, rebuild.timeline, past)
    }
}
