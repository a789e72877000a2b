//! What frames tell of the motors, for records without states: packet logs as CSV, and files of earlier versions.

use std::time::Duration;

use motorlink_bus::{
    Activity, Answer, LineEvent, LineEventKind, LineSamples, LineStatus, MotorStatus, Sample,
    TurnCounter, commanded, commanded_setpoint,
};
use motorlink_messages::{Connection, Update};
use motorlink_protocol::{Instant, MotorId};

use crate::record::{EventKind, SILENT_AFTER, What};

/// A drive frame counts for so long: such frames come at least twice a second.
const DRIVEN_FOR: Duration = Duration::from_millis(1_500);

/// The last replies and setpoints of the motors. What no frame tells is not known: limits, stops, a raw frame, a scan.
#[derive(Debug, Default)]
pub(super) struct OfFrames {
    samples: LineSamples,
    /// In the order of their IDs, wherever the replay has begun to read.
    motors: Vec<Motor>,
    is_connected: bool,
}

#[derive(Debug)]
struct Motor {
    status: MotorStatus,
    turns: TurnCounter,
    drove: Instant,
}

impl OfFrames {
    /// Takes what happened, and adds the replies. Times must not decrease.
    pub(super) fn add(&mut self, at: Instant, what: &What, samples: &mut Vec<Sample>) {
        match what {
            What::Line(kind) => {
                self.is_connected = true;
                self.line(at, *kind, samples);
            }
            What::Event(event) if event.kind == EventKind::Connected => self.is_connected = true,
            What::Event(event) if event.kind == EventKind::Disconnected => {
                *self = Self {
                    samples: LineSamples::of(self.samples.model()),
                    ..Self::default()
                };
            }
            What::Event(_) | What::State(_) => {}
        }
    }

    fn line(&mut self, at: Instant, kind: LineEventKind, samples: &mut Vec<Sample>) {
        if let Some(sample) = self.samples.add_event(&LineEvent { at, kind }) {
            self.motor(sample.reply.id).replied(sample);
            samples.push(sample);
        }
        let model = self.samples.model();
        if let Some((id, told)) = commanded(model, &kind) {
            let driven = told.map(|(drive, mode)| Activity::Driven {
                setpoint: commanded_setpoint(model, drive, mode),
            });
            let motor = self.motor(id);
            motor.status.activity = driven.unwrap_or(Activity::Idle);
            motor.drove = at;
        }
        if let LineEventKind::Silence { id, .. } = kind {
            self.motor(id).missed(at);
        }
    }

    fn motor(&mut self, id: MotorId) -> &mut Motor {
        let known = self
            .motors
            .binary_search_by_key(&id, |motor| motor.status.id);
        let place = known.unwrap_or_else(|place| {
            self.motors.insert(place, Motor::new(id));
            place
        });
        #[allow(
            clippy::indexing_slicing,
            reason = "the place was found or made just above"
        )]
        &mut self.motors[place]
    }

    /// What every motor does at this time.
    pub(super) fn activities(&self, at: Instant) -> impl Iterator<Item = (MotorId, Activity)> {
        let motors = self.motors.iter();
        motors.map(move |motor| (motor.status.id, motor.activity(at)))
    }

    /// The state at this time, which is not before the last record.
    pub(super) fn update(&self, now: Instant) -> Update {
        let motors: Vec<MotorStatus> = self
            .motors
            .iter()
            .map(|motor| MotorStatus {
                activity: motor.activity(now),
                turns: motor.turns.turns(),
                ..motor.status
            })
            .collect();
        let line = LineStatus {
            model: self.samples.model(),
            model_known: true,
            ..LineStatus::default()
        };
        Update {
            motors,
            line: self.is_connected.then_some(line),
            ..Update::without_motors(now, Connection::Disconnected)
        }
    }
}

impl Motor {
    fn new(id: MotorId) -> Self {
        Self {
            status: MotorStatus::unknown(id),
            turns: TurnCounter::default(),
            drove: Instant::ZERO,
        }
    }

    fn replied(&mut self, sample: Sample) {
        let Sample { at, reply } = sample;
        self.turns.record(at, &reply);
        let status = &mut self.status;
        status.last = Some(sample);
        status.answer = Answer::Comes;
        status.counters.requests += 1;
        status.counters.replies += 1;
        status.speed = reply.speed.map(|speed| (at, speed)).or(status.speed);
        status.current = reply
            .current
            .map(|current| (at, current))
            .or(status.current);
        let detail = reply.detail;
        let (position, temperature) = (detail.fine(), detail.temperature());
        status.position = position.map(|position| (at, position)).or(status.position);
        status.temperature = temperature
            .map(|temperature| (at, temperature))
            .or(status.temperature);
    }

    fn missed(&mut self, at: Instant) {
        let status = &mut self.status;
        status.counters.requests += 1;
        status.counters.silences += 1;
        let last = status.last.map_or(Instant::ZERO, |last| last.at);
        if at.since(last) >= SILENT_AFTER {
            status.answer = Answer::Missing;
        }
    }

    fn activity(&self, at: Instant) -> Activity {
        if at.since(self.drove) <= DRIVEN_FOR {
            self.status.activity
        } else {
            Activity::Idle
        }
    }
}
