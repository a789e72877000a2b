//! What the page shows: the states in the file, or where it has none, what the frames tell.

use std::{collections::VecDeque, time::Duration};

use motorlink_bus::{Activity, Sample};
use motorlink_messages::{Adapter, Connection, Update, sessions::ActivityChange};
use motorlink_protocol::{Instant, MotorId};

use super::of_frames::OfFrames;
use crate::record::{STATE_HOLDS, What};

/// Replies are in an update after at most 50 ms.
const UPDATE_WITHIN: Duration = Duration::from_millis(60);

/// Changes that are kept: as many as the frames of a minute with a ramp, of which each has another setpoint.
const ACTIVITIES_MAX: usize = 36_000;

/// The state after the records so far.
#[derive(Debug)]
pub(super) struct State {
    /// The last state in the file. Files of earlier versions have none, nor has the packet log as CSV.
    stored: Option<Box<Update>>,
    has_stored_samples: bool,
    /// What the frames tell of the motors, before the first state.
    of_frames: OfFrames,
    /// The time of the last record.
    last: Instant,
    /// The replies since they were taken.
    pub(super) samples: Vec<Sample>,
    /// What the motors do, if its changes are kept.
    activities: Option<Activities>,
}

/// What every motor does, and since when.
#[derive(Debug, Default)]
struct Activities {
    changes: VecDeque<ActivityChange>,
    last: Vec<(MotorId, Activity)>,
}

impl Activities {
    /// What every motor does now. One that is not among them is not driven any more.
    fn note_all(&mut self, at: Instant, now: &[(MotorId, Activity)]) {
        for (id, activity) in now {
            self.note(at, *id, *activity);
        }
        for (id, _) in self.last.clone() {
            if !now.iter().any(|(of, _)| *of == id) {
                self.note(at, id, Activity::Idle);
            }
        }
    }

    fn note(&mut self, at: Instant, id: MotorId, activity: Activity) {
        match self.last.iter_mut().find(|(of, _)| *of == id) {
            Some((_, last)) if *last == activity => return,
            Some((_, last)) => *last = activity,
            None => self.last.push((id, activity)),
        }
        if self.changes.len() == ACTIVITIES_MAX {
            self.changes.pop_front();
        }
        self.changes.push_back(ActivityChange { at, id, activity });
    }
}

impl State {
    pub(super) fn new() -> Self {
        Self {
            stored: None,
            has_stored_samples: false,
            of_frames: OfFrames::default(),
            last: Instant::ZERO,
            samples: Vec::new(),
            activities: None,
        }
    }

    /// Keeps every change of what the motors do from now on.
    pub(super) fn keep_activities(&mut self) {
        self.activities.get_or_insert_default();
    }

    /// The changes since [`keep_activities`](Self::keep_activities), oldest first. None are kept any more.
    pub(super) fn take_activities(&mut self) -> Vec<ActivityChange> {
        let activities = self.activities.take().unwrap_or_default();
        activities.changes.into()
    }

    /// Takes what happened. Times must not decrease.
    pub(super) fn add(&mut self, at: Instant, what: &What) {
        self.pass_gap(at);
        self.last = at;
        match (what, &self.stored) {
            (What::State(update), _) => self.show(update),
            (_, None) => self.of_frames.add(at, what, &mut self.samples),
            (_, Some(_)) => return,
        }
        if let Some(kept) = &mut self.activities {
            let motors = self.stored.iter().flat_map(|update| &update.motors);
            let mut now: Vec<_> = motors.map(|motor| (motor.id, motor.activity)).collect();
            if self.stored.is_none() {
                now.extend(self.of_frames.activities(at));
            }
            kept.note_all(at, &now);
        }
    }

    fn show(&mut self, update: &Update) {
        if self.stored.is_none() {
            // The first states have the replies of this time too, and only those that the bus took.
            let before = update.now - UPDATE_WITHIN;
            self.samples.retain(|sample| sample.at < before);
        }
        if let Some(first) = update.samples.first()
            && !std::mem::replace(&mut self.has_stored_samples, true)
        {
            // The same replies as their frames told before.
            self.samples.retain(|sample| sample.at < first.at);
        }
        self.samples.extend(&update.samples);
        let samples = Vec::new();
        let state = update.clone();
        self.stored = Some(Box::new(Update { samples, ..state }));
    }

    /// Without records the line is closed, and nothing is known of its motors.
    fn pass_gap(&mut self, now: Instant) {
        let Some(stored) = &mut self.stored else {
            return;
        };
        if now.since(self.last) > STATE_HOLDS {
            stored.motors.clear();
            (stored.job, stored.raw, stored.line) = (None, None, None);
            if let Some(kept) = &mut self.activities {
                kept.note_all(self.last + STATE_HOLDS, &[]);
            }
        }
    }

    /// The time of the state that is shown at this time. One without motors holds: nothing is known of any.
    pub(super) fn shown_at(&self, now: Instant) -> Instant {
        let stored = self.stored.as_ref();
        let stored = stored.filter(|update| !update.motors.is_empty());
        stored.map_or(now, |update| update.now)
    }

    /// The state at this time, which is not before the last record, and the replies since the last update.
    pub(super) fn update(&mut self, now: Instant) -> Update {
        self.pass_gap(now);
        let stored = self.stored.as_deref();
        let shown = stored.map_or_else(|| self.of_frames.update(now), Clone::clone);
        Update {
            now,
            connection: Connection::Connected(Adapter::Recording),
            samples: std::mem::take(&mut self.samples),
            ..shown
        }
    }
}
