//! Finds out what the page shows at another place: first by the last seconds before it, then by all that is near it.

use std::{collections::VecDeque, time::Duration};

use motorlink_bus::Sample;
use motorlink_messages::sessions::ActivityChange;
use motorlink_protocol::Instant;
use motorlink_recorder::WallClock;

use super::{
    look_back::LookBack,
    times::Times,
    track::{Progress, Track},
};
use crate::reader::Session;

/// Samples that are kept for the graph: more than a line carries in a minute.
const SAMPLES_MAX: usize = 40_000;

/// The first look for the frame before a place. If there is none, each next one goes further back by [`FURTHER`].
const FRAME_WITHIN: Duration = Duration::from_secs(3);
const FURTHER: u32 = 8;

/// What the page does not have of the time before a jump.
#[derive(Debug, Default)]
pub(super) struct Past {
    /// The replies.
    pub(super) samples: VecDeque<Sample>,
    /// The changes of what the motors did.
    pub(super) activities: Vec<ActivityChange>,
}

/// A search.
#[derive(Debug)]
pub(super) struct Search {
    stage: Stage,
    track: Track,
}

#[derive(Debug)]
enum Stage {
    /// Reads the last seconds before this place.
    Picture { target: Instant },
    /// Reads all that is near the place. The page does not have the samples between these times.
    Near {
        past: Past,
        from: Instant,
        until: Instant,
    },
    /// Looks for the last frame before this time.
    FrameBefore { before: Instant, within: Duration },
}

/// What a search has found.
#[derive(Debug)]
pub(super) enum Found {
    /// Nothing yet.
    Progress(Progress),
    /// The state at this place, by the last seconds before it.
    Picture(Instant, Track),
    /// The state at the place by all that is near it, and what was before the picture.
    Near(Track, Past),
    /// The time of the frame.
    Frame(Instant),
}

/// What a search needs to know of the session.
#[derive(Clone, Copy, Debug)]
pub(super) struct Context<'a> {
    pub(super) session: &'a Session,
    pub(super) times: Times,
    pub(super) clock: WallClock,
    pub(super) look_back: LookBack,
}

impl Context<'_> {
    /// The records from this long before a place.
    fn track(self, place: Instant, before: Duration) -> Track {
        let from = place - before;
        let from_ns = if from > self.times.first {
            self.times.utc_ns(from)
        } else {
            0
        };
        Track::at(self.session, self.times, from_ns, self.clock)
    }
}

impl Search {
    pub(super) fn picture(context: Context<'_>, target: Instant) -> Self {
        let track = context.track(target, context.look_back.picture);
        let stage = Stage::Picture { target };
        Self { stage, track }
    }

    /// `until` is the time of the first record of the picture.
    pub(super) fn near(context: Context<'_>, place: Instant, until: Instant) -> Self {
        let LookBack { past, bytes, .. } = context.look_back;
        let from_ns = context
            .session
            .look_back(context.times.utc_ns(place), past, bytes);
        let from = place - past;
        let mut track = Track::at(context.session, context.times, from_ns, context.clock);
        track.state.keep_activities();
        let past = Past::default();
        let stage = Stage::Near { past, from, until };
        Self { stage, track }
    }

    pub(super) fn frame_before(context: Context<'_>, before: Instant) -> Self {
        let within = FRAME_WITHIN;
        let stage = Stage::FrameBefore { before, within };
        let track = context.track(before, within);
        Self { stage, track }
    }

    /// Whether a new search may take its place at once. A picture is completed first: otherwise a page that seeks at
    /// every move of the pointer would get none.
    pub(super) const fn is_replaceable(&self) -> bool {
        !matches!(self.stage, Stage::Picture { .. })
    }

    /// The place that it goes to.
    pub(super) const fn target(&self) -> Option<Instant> {
        match self.stage {
            Stage::Picture { target } => Some(target),
            Stage::Near { .. } | Stage::FrameBefore { .. } => None,
        }
    }

    pub(super) fn supply(&mut self, range: &std::ops::Range<u64>, bytes: &[u8]) -> bool {
        self.track.supply(range, bytes)
    }

    /// Reads on; `place` is the present one.
    pub(super) fn step(mut self, context: Context<'_>, place: Instant) -> (Found, Option<Self>) {
        let until = match self.stage {
            Stage::Picture { target } => target,
            Stage::Near { .. } => place,
            Stage::FrameBefore { before, .. } => before - Duration::from_micros(1),
        };
        let progress = self.track.advance(context.session, until);
        if let Stage::Near { past, from, until } = &mut self.stage {
            let told = self.track.state.samples.drain(..);
            let samples = &mut past.samples;
            samples.extend(told.filter(|sample| (*from..*until).contains(&sample.at)));
            let too_many = samples.len().saturating_sub(SAMPLES_MAX);
            samples.drain(..too_many);
        }
        if progress != Progress::Reached {
            return (Found::Progress(progress), Some(self));
        }
        match self.stage {
            Stage::Picture { target } => (Found::Picture(target, self.track), None),
            Stage::Near { mut past, .. } => {
                past.activities = self.track.state.take_activities();
                (Found::Near(self.track, past), None)
            }
            Stage::FrameBefore { before, within } => {
                let is_whole = before - within <= context.times.first;
                if let Some(frame) = self.track.frame_before(before) {
                    (Found::Frame(frame), None)
                } else if is_whole {
                    (Found::Frame(context.times.first), None)
                } else {
                    let within = within * FURTHER;
                    let stage = Stage::FrameBefore { before, within };
                    let track = context.track(before, within);
                    let next = Self { stage, track };
                    (Found::Progress(Progress::More), Some(next))
                }
            }
        }
    }
}
