//! The state of the bus by its frames and the events between them, for records without states.

use motorlink_bus::{Activity, LineEvent, LineEventKind, MotorStatus, Observer, Sample};
use motorlink_messages::{Connection, Update};
use motorlink_protocol::{Instant, MotorId, family::Model};

use crate::record::{EventKind, What};

/// The state of the line after the records so far. What no frame tells is unknown: limits, a raw frame, a scan.
#[derive(Debug)]
pub(super) struct Inferred {
    observer: Observer,
    /// The model of the line before it was disconnected.
    model: Model,
    is_connected: bool,
}

impl Inferred {
    pub(super) fn new(at: Instant) -> Self {
        let model = Model::default();
        Self {
            observer: Observer::new(at, model),
            model,
            is_connected: false,
        }
    }

    /// Takes what happened, and adds the replies. Times must not decrease.
    pub(super) fn add(&mut self, at: Instant, what: &What, samples: &mut Vec<Sample>) {
        match what {
            What::Line(kind) => {
                if let LineEventKind::ModelSelected(model) = kind {
                    self.model = *model;
                }
                self.is_connected = true;
                let event = LineEvent { at, kind: *kind };
                self.observer.add_event(&event, samples);
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
            What::State(_) => {}
        }
    }

    /// What every motor does.
    pub(super) fn activities(&self) -> impl Iterator<Item = (MotorId, Activity)> {
        self.observer.activities()
    }

    /// The state at this time, which is not before the last record.
    pub(super) fn update(&mut self, now: Instant) -> Update {
        let line = self.observer.line_status(now);
        // In one order, wherever the replay has begun to read.
        let mut motors: Vec<MotorStatus> = self.observer.motors(now).collect();
        motors.sort_unstable_by_key(|motor| motor.id);
        Update {
            now,
            connection: Connection::Disconnected,
            halted: false,
            motors,
            job: None,
            raw: None,
            line: self.is_connected.then_some(line),
            samples: Vec::new(),
            notices: Vec::new(),
        }
    }
}
