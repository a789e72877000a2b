//! What the page shows, from records.

use motorlink_bus::{LineEvent, LineEventKind, MotorStatus, Observer, Sample};
use motorlink_messages::{Adapter, Connection, Update};
use motorlink_protocol::{Instant, family::Model};

use crate::record::{EventKind, What};

/// The state of the line after the records so far.
#[derive(Debug)]
pub(super) struct State {
    observer: Observer,
    /// The model of the line before it was disconnected.
    model: Model,
    is_connected: bool,
    /// The replies since they were taken.
    pub(super) samples: Vec<Sample>,
}

impl State {
    pub(super) fn new(at: Instant) -> Self {
        let model = Model::default();
        Self {
            observer: Observer::new(at, model),
            model,
            is_connected: false,
            samples: Vec::new(),
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
