//! The fixture of runs: two motors that reply, in virtual time.
#![allow(dead_code, reason = "each test file uses its own part of the fixture")]

use std::time::Duration;

use motorlink_experiments::{
    plan::{Fleet, Plan},
    runner::{End, Options, Runner, Telemetry, Tick},
    sequence::Sequence,
};
use motorlink_protocol::{Current, Faults, Instant, Mode, MotorId, Setpoint};

pub const ONE: MotorId = MotorId::FIRST;

pub fn two() -> MotorId {
    MotorId::new(2).unwrap()
}

pub fn ms(millis: u64) -> Duration {
    Duration::from_millis(millis)
}

pub fn plan(steps: &str) -> Plan {
    let text = format!(
        r#"{{ "motorlink_sequence": 1, "limits": {{ "rpm": 200, "amps": 2, "celsius": 60 }},
             "steps": [{steps}] }}"#
    );
    let sequence = Sequence::from_json(&text).unwrap();
    Plan::new(&sequence, &Fleet::of([ONE, two()])).unwrap()
}

/// A run with motors that reply every 10 ms with what the test sets.
pub struct Fixture {
    pub runner: Runner,
    pub now: Instant,
    pub rpm: i16,
    pub amps: f32,
    pub celsius: u8,
    pub faults: Faults,
    pub mode: Mode,
    pub silent: Option<MotorId>,
    pub sent: Vec<(Instant, MotorId, Setpoint)>,
    pub stops: Vec<End>,
}

impl Fixture {
    pub fn armed(steps: &str, options: Options) -> Self {
        let now = Instant::from_millis(5_000);
        let mut fixture = Self {
            runner: Runner::arm(plan(steps), options, now),
            now,
            rpm: 0,
            amps: 0.2,
            celsius: 30,
            faults: Faults::NONE,
            mode: Mode::Velocity,
            silent: None,
            sent: Vec::new(),
            stops: Vec::new(),
        };
        fixture.reply();
        fixture
    }

    pub fn started(steps: &str) -> Self {
        let mut fixture = Self::armed(steps, Options::default());
        fixture.runner.start(fixture.now).unwrap();
        fixture
    }

    pub fn reply(&mut self) {
        for id in [ONE, two()] {
            if self.silent != Some(id) {
                self.runner.telemetry(Telemetry {
                    id,
                    at: self.now,
                    mode: self.mode,
                    rpm: Some(self.rpm),
                    current: Some(Current::from_amps(self.amps)),
                    degrees: Some(90.0),
                    celsius: Some(self.celsius),
                    faults: self.faults,
                });
            }
        }
    }

    /// Lets time pass in steps of 5 ms.
    pub fn run(&mut self, time: Duration) {
        let until = self.now + time;
        while self.now < until {
            self.tick();
            self.now = self.now + ms(5);
            self.reply();
        }
    }

    /// Runs to the end. The port takes each setpoint.
    pub fn follow(&mut self) {
        while self.stops.is_empty() {
            self.tick();
            for (at, id, setpoint) in std::mem::take(&mut self.sent) {
                self.runner.sent(at, id, setpoint);
            }
            self.now = self.now + ms(5);
            self.reply();
        }
    }

    pub fn tick(&mut self) {
        match self.runner.tick(self.now) {
            Tick::Idle | Tick::Withhold { .. } => {}
            Tick::Drive { setpoints, .. } => {
                let now = self.now;
                self.sent
                    .extend(setpoints.into_iter().map(|(id, it)| (now, id, it)));
            }
            Tick::Stop(end) => self.stops.push(end),
        }
    }

    pub fn last_rpm(&self, of: MotorId) -> i16 {
        let last = self.sent.iter().rev().find(|(_, id, _)| *id == of);
        let Some((_, _, Setpoint::Velocity { speed, .. })) = last else {
            panic!("no speed: {last:?}");
        };
        speed.rpm()
    }
}
