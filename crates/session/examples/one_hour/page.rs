//! What the page shows of the line: an update of the port worker every 50 ms.

use std::time::Duration;

use motorlink_bus::{Activity, LineEvent, LineSamples, LineStatus, MotorStatus, TurnCounter};
use motorlink_messages::{Adapter, Connection, ToPage, Update, encode};
use motorlink_protocol::{Instant, MotorId, Setpoint, SpeedTarget};

const PERIOD: Duration = Duration::from_millis(50);

/// Makes the updates.
pub struct Page {
    samples: LineSamples,
    turns: TurnCounter,
    update: Update,
    motor: MotorStatus,
}

impl Page {
    pub fn new() -> Self {
        let update = Update::without_motors(Instant::ZERO, Connection::Connected(Adapter::VIRTUAL));
        Self {
            samples: LineSamples::default(),
            turns: TurnCounter::default(),
            update,
            motor: MotorStatus {
                activity: Activity::Driven {
                    setpoint: Setpoint::velocity(SpeedTarget::ZERO),
                },
                may_turn: true,
                ..MotorStatus::unknown(MotorId::FIRST)
            },
        }
    }

    /// Takes an event. Returns the bytes of an update that is due.
    pub fn add(&mut self, event: &LineEvent) -> Option<Vec<u8>> {
        let at = event.at;
        if let Some(sample) = self.samples.add_event(event) {
            let reply = sample.reply;
            self.turns.record(at, &reply);
            let motor = &mut self.motor;
            motor.last = Some(sample);
            motor.speed = reply.speed.map(|speed| (at, speed));
            motor.current = reply.current.map(|current| (at, current));
            motor.turns = self.turns.turns();
            motor.counters.requests += 1;
            motor.counters.replies += 1;
            self.update.samples.push(sample);
        }
        if at.since(self.update.now) < PERIOD {
            return None;
        }
        self.update.now = at;
        let update = Update {
            motors: vec![self.motor],
            line: Some(LineStatus::default()),
            samples: std::mem::take(&mut self.update.samples),
            ..self.update.clone()
        };
        encode(&ToPage::Update(update)).ok()
    }
}
