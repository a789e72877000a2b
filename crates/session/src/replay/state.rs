//! What the page shows, from records.

use std::collections::VecDeque;

use motorlink_bus::{Activity, LineEvent, LineEventKind, MotorStatus, Observer, Sample};
use motorlink_messages::{Adapter, Connection, Update, sessions::ActivityChange};
use motorlink_protocol::{Instant, MotorId, family::Model};

use crate::record::{EventKind, What};

/// Changes that are kept: as many as the frames of a minute with a ramp, of which each has another setpoint.
const ACTIVITIES_MAX: usize = 36_000;

/// The state of the line after the records so far.
#[derive(Debug)]
pub(super) struct State {
    observer: Observer,
    /// The model of the line before it was disconnected.
    model: Model,
    is_connected: bool,
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
    pub(super) fn new(at: Instant) -> Self {
        let model = Model::default();
        Self {
            observer: Observer::new(at, model),
            model,
            is_connected: false,
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

    fn note_activities(&mut self, at: Instant) {
        if let Some(kept) = &mut self.activities {
            for (id, activity) in self.observer.activities() {
                kept.note(at, id, activity);
            }
        }
    }

    /// The line is closed: nothing drives.
    fn all_idle(&mut self, at: Instant) {
        if let Some(kept) = &mut self.activities {
            for (id, _) in kept.last.clone() {
                kept.note(at, id, Activity::Idle);
            }
        }
    }

    /// Takes what happened. Times must not decrease.
    pub(super) fn add(&mut self, at: Instant, what: &What) {
        match what {
            What::Line(kind) => {
                if let LineEventKind::ModelSelected(model) = kind {
                    self.model = *model;
                }
                self.is_connected = true;
                let event = LineEvent { at, kind: *kind };
                self.observer.add_event(&event, &mut self.samples);
            }
            What::Event(event) => match event.kind {
                EventKind::Connected => self.is_connected = true,
                EventKind::Disconnected => {
                    self.is_connected = false;
                    self.all_idle(at);
                    self.observer = Observer::new(at, self.model);
                }
                EventKind::StopBegan => self.observer.stop_began(at),
                EventKind::StopEnded => self.observer.stop_ended(at),
                EventKind::Limit
                | EventKind::Fault
                | EventKind::Run
                | EventKind::Bookmark
                | EventKind::Notice => {}
            },
        }
        self.note_activities(at);
    }

    /// The state at this time, which is not before the last record, and the replies since the last update.
    pub(super) fn update(&mut self, now: Instant) -> Update {
        let line = self.observer.line_status(now);
        // In one order, wherever the replay has begun to read.
        let mut motors: Vec<MotorStatus> = self.observer.motors(now).collect();
        motors.sort_unstable_by_key(|motor| motor.id);
        Update {
            now,
            connection: Connection::Connected(Adapter::Recording),
            halted: false,
            motors,
            job: None,
            raw: None,
            line: self.is_connected.then_some(line),
            samples: std::mem::take(&mut self.samples),
            notices: Vec::new(),
        }
    }
}
