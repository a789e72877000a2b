//! A host with one virtual motor: it runs sequences at 200 Hz, in virtual time.
#![allow(dead_code, reason = "each test file uses its own part of the bench")]

use std::time::Duration;

use motorlink_experiments::{
    analysis::{Point, Trace},
    kept::{Outcome, RunHeader},
    plan::{Fleet, Plan},
    runner::{End, Options, Record, Runner, Telemetry, Tick},
    sequence::Sequence,
    study::Study,
};
use motorlink_protocol::{Frame, Instant, Layout, Mode, MotorId, Reply, Request};
use motorlink_simulator::{MotorConfig, WireFaults, World, WorldConfig};

pub const ONE: MotorId = MotorId::FIRST;

/// How often the temperature is asked for, in place of a setpoint.
const QUERY_EVERY: Duration = Duration::from_secs(1);
const PAUSE: Duration = Duration::from_secs(5);

pub struct Bench {
    pub world: World,
    now: Instant,
    random: fastrand::Rng,
    expect: Option<Layout>,
    /// Each run is paused this long after its start, for five seconds.
    pub pauses_after: Option<Duration>,
    /// The load in N.m by the time since the start of a run in seconds.
    pub load_nm: Option<Box<dyn Fn(f64) -> f32>>,
    /// The record of the last run.
    pub record: Record,
}

impl Bench {
    /// One motor; 2 % of the replies are lost, and ticks are up to a millisecond late.
    pub fn new(seed: u64, motor: MotorConfig) -> Self {
        Self::losing(seed, motor, 0.02)
    }

    /// The same with this part of the replies lost.
    pub fn losing(seed: u64, motor: MotorConfig, lose_reply: f64) -> Self {
        let now = Instant::from_millis(1_000);
        let mut world = World::new(WorldConfig {
            seed,
            motors: vec![motor],
            faults: WireFaults {
                lose_reply,
                ..WireFaults::default()
            },
            ..WorldConfig::default()
        });
        world.advance(now);
        Self {
            world,
            now,
            random: fastrand::Rng::with_seed(seed),
            expect: None,
            pauses_after: None,
            load_nm: None,
            record: Record::default(),
        }
    }

    /// Runs a sequence to its end.
    pub fn run(&mut self, steps: &str) -> Run {
        let text = format!(r#"{{ "motorlink_sequence": 1, "steps": [{steps}] }}"#);
        self.run_sequence(&Sequence::from_json(&text).unwrap())
    }

    pub fn run_sequence(&mut self, sequence: &Sequence) -> Run {
        let plan = Plan::new(sequence, &Fleet::of([ONE])).unwrap();
        let mode = plan.motors()[0].mode();
        let mut runner = Runner::arm(plan, Options::default(), self.now);
        self.switch(mode);
        while runner.start(self.now).is_err() {
            self.send(Request::Query { id: ONE });
            self.wait(&mut runner, self.now + Duration::from_millis(5));
        }
        let mut query_at = self.now;
        let pause_at = self.pauses_after.map(|after| self.now + after);
        let resume_at = pause_at.map(|at| at + PAUSE);
        let began = self.now;
        loop {
            if let (Some(load_nm), Some(motor)) = (&self.load_nm, self.world.motor_mut(ONE)) {
                motor.set_load_nm(load_nm(self.now.since(began).as_secs_f64()));
            }
            let is_due = |at: Option<Instant>| at.is_some_and(|at| at <= self.now);
            if is_due(resume_at) {
                runner.resume(self.now);
            } else if is_due(pause_at) {
                runner.pause(self.now);
            }
            match runner.tick(self.now) {
                Tick::Drive { setpoints, next } => {
                    for (id, setpoint) in setpoints {
                        if self.now >= query_at {
                            query_at = self.now + QUERY_EVERY;
                            self.send(Request::Query { id });
                            continue;
                        }
                        self.send(Request::drive(id, setpoint));
                        runner.sent(self.now, id, setpoint);
                    }
                    let late = Duration::from_micros(self.random.u64(0..1_000));
                    self.wait(&mut runner, next + late);
                }
                Tick::Stop(end) => {
                    self.record = runner.record().clone();
                    let began = runner.record().began_at().unwrap();
                    let seconds = |at: Instant| at.since(began).as_secs_f64();
                    return Run {
                        trace: Trace::of(runner.record(), ONE),
                        marks: runner
                            .record()
                            .marks()
                            .iter()
                            .map(|mark| (seconds(mark.at), mark.step))
                            .collect(),
                        ended_s: seconds(self.now),
                        end,
                    };
                }
                Tick::Idle | Tick::Withhold { .. } => panic!("no setpoints"),
            }
        }
    }

    fn switch(&mut self, mode: Mode) {
        for _ in 0..5 {
            let request = Request::SwitchMode { id: ONE, mode };
            self.world.transmit(self.now, request.frame().bytes());
            self.now = self.now + Duration::from_millis(20);
            while self.world.receive(self.now).is_some() {}
        }
    }

    fn send(&mut self, request: Request) {
        self.world.transmit(self.now, request.frame().bytes());
        self.expect = request.reply_layout();
    }

    /// Lets time pass; replies reach the run when they come.
    fn wait(&mut self, runner: &mut Runner, until: Instant) {
        while let Some(chunk) = self.world.receive(until) {
            if let Ok(bytes) = <[u8; 10]>::try_from(chunk.bytes)
                && let Ok(reply) = Reply::decode(&Frame::new(bytes), self.expect)
            {
                runner.telemetry(Telemetry::of(chunk.at, &reply));
            }
        }
        self.now = until;
    }
}

/// What came of a run.
pub struct Run {
    pub trace: Trace,
    /// The beginning of each step, in seconds, and its instruction.
    pub marks: Vec<(f64, usize)>,
    pub ended_s: f64,
    pub end: End,
}

impl Run {
    /// The time of each step that is instruction `step`, up to the next step.
    pub fn times(&self, step: usize) -> Vec<(f64, f64)> {
        let ends = self.marks.iter().skip(1).map(|(at, _)| *at);
        let ends = ends.chain([self.ended_s]);
        let pairs = self.marks.iter().zip(ends);
        pairs
            .filter(|((_, of), _)| *of == step)
            .map(|((from, _), to)| (*from, to))
            .collect()
    }

    pub fn rpm(&self, (from, to): (f64, f64)) -> &[Point] {
        Trace::between(&self.trace.rpm, from, to)
    }

    pub fn amps(&self, (from, to): (f64, f64)) -> &[Point] {
        Trace::between(&self.trace.amps, from, to)
    }
}

/// The header of a run of this study on the bench.
pub fn header(study: &Study, record: &Record) -> RunHeader {
    RunHeader {
        number: 1,
        name: String::new(),
        study: study.to_json(),
        motors: vec![(ONE, String::new())],
        model: "DDSM115".to_owned(),
        setup: String::new(),
        page_version: String::new(),
        began_unix_ms: 0.0,
        began: record.began_at(),
        request_hz: 200.0,
        outcome: Outcome::Running,
        bytes: 0,
    }
}
