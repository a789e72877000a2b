//! Runs of motors with known constants, whose replies have noise that is white or remembers its past.
#![allow(dead_code, reason = "each user takes its own part")]

use std::{f64::consts::TAU, time::Duration};

use motorlink_experiments::{
    analysis::Estimate,
    runner::{End, Mark, Record, RecordPart, Sample, SentSetpoint},
    study::{
        CoastDownStudy, Findings, FrictionStudy, HeatingStudy, Measured, Study, StudyKind,
        TorqueSpeedStudy,
    },
};
use motorlink_protocol::{Current, CurrentTarget, FRAME_AIRTIME, Instant, MotorId, Setpoint};

pub const ONE: MotorId = MotorId::FIRST;
const RAD_S_PER_RPM: f64 = TAU / 60.0;
/// A reply each 10 ms, up to 1 ms late, and a temperature each second.
const REPLY_S: f64 = 0.01;
const LATE_S: f64 = 0.001;
const CELSIUS_S: f64 = 1.0;
/// The noise of the virtual motor's current (`crates/simulator/src/motor.rs`).
const AMPS_NOISE: f64 = 0.086;
/// Of speed and temperature, before they are rounded to whole numbers.
const RPM_NOISE: f64 = 0.4;
const CELSIUS_NOISE: f64 = 0.4;

/// A figure, what it is in truth, and what the study says.
pub type Figure = (&'static str, f64, Option<Estimate>);

/// What a motor does at a time since the start of a step.
#[derive(Clone, Copy)]
pub struct State {
    pub rpm: f64,
    pub amps: f64,
    pub celsius: f64,
}

impl Default for State {
    fn default() -> Self {
        let (rpm, amps, celsius) = (0.0, 0.0, 25.0);
        Self { rpm, amps, celsius }
    }
}

/// Noise of the standard deviation 1, of which each value remembers a part of the one before.
struct Noise {
    memory: f64,
    last: f64,
}

impl Noise {
    fn new(memory: f64, random: &mut fastrand::Rng) -> Self {
        let last = normal(random);
        Self { memory, last }
    }

    fn next(&mut self, random: &mut fastrand::Rng) -> f64 {
        let fresh = (1.0 - self.memory * self.memory).sqrt() * normal(random);
        self.last = self.memory * self.last + fresh;
        self.last
    }
}

/// Box and Muller (1958).
fn normal(random: &mut fastrand::Rng) -> f64 {
    let radius = (-2.0 * (1.0 - random.f64()).ln()).sqrt();
    radius * (TAU * random.f64()).cos()
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "a report is a small number"
)]
fn whole(value: f64) -> i16 {
    value.round() as i16
}

#[allow(clippy::cast_possible_truncation, reason = "a report has fewer digits")]
const fn narrow(value: f64) -> f32 {
    value as f32
}

/// A run that is written down as the page writes it.
pub struct NoisyRun {
    random: fastrand::Rng,
    rpm: Noise,
    amps: Noise,
    celsius: Noise,
    part: RecordPart,
    reply_s: f64,
    now_s: f64,
    asks_celsius_s: f64,
}

impl NoisyRun {
    /// `memory` is the correlation of two replies that follow each other: 0 for white noise.
    pub fn new(seed: u64, memory: f64) -> Self {
        let mut random = fastrand::Rng::with_seed(seed);
        Self {
            rpm: Noise::new(memory, &mut random),
            amps: Noise::new(memory, &mut random),
            celsius: Noise::new(memory, &mut random),
            random,
            part: RecordPart::default(),
            reply_s: REPLY_S,
            now_s: 0.0,
            asks_celsius_s: 0.0,
        }
    }

    /// A constant of the motor, evenly distributed.
    pub fn constant(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.random.f64()
    }

    fn at(t_s: f64) -> Instant {
        Instant::from_millis(1_000) + Duration::from_secs_f64(t_s)
    }

    /// A step of the sequence that lasts as long as `state` has a value.
    pub fn step(&mut self, step: usize, setpoint: Setpoint, state: impl Fn(f64) -> Option<State>) {
        let (began_s, id) = (self.now_s, ONE);
        let at = Self::at(began_s);
        self.part.marks.push(Mark { at, step });
        self.part.sent.push(SentSetpoint { at, id, setpoint });
        let mut number = 0.0;
        loop {
            number += 1.0;
            let t_s = (number - 0.5) * self.reply_s + LATE_S * self.random.f64();
            let Some(state) = state(t_s) else { break };
            let random = &mut self.random;
            let rpm = state.rpm + RPM_NOISE * self.rpm.next(random);
            let amps = state.amps + AMPS_NOISE * self.amps.next(random);
            let asks = began_s + t_s >= self.asks_celsius_s;
            let celsius = asks.then(|| {
                self.asks_celsius_s += CELSIUS_S;
                state.celsius + CELSIUS_NOISE * self.celsius.next(random)
            });
            self.part.samples.push(Sample {
                id,
                at: Self::at(began_s + t_s) + FRAME_AIRTIME,
                rpm: Some(whole(rpm)),
                current: Some(Current::from_amps(narrow(amps))),
                degrees: None,
                celsius: celsius.map(|it| u8::try_from(whole(it)).unwrap()),
            });
            self.now_s = began_s + number * self.reply_s;
        }
    }

    pub fn record(self) -> Record {
        let mut record = Record::default();
        record.began(Self::at(0.0));
        record.ended(End::Finished {
            at: Self::at(self.now_s),
        });
        record.add_part(self.part);
        record
    }
}

fn for_s(seconds: f64, state: impl Fn(f64) -> State) -> impl Fn(f64) -> Option<State> {
    move |t_s| (t_s < seconds).then(|| state(t_s))
}

/// The run of this study and its figures.
pub fn figures(kind: StudyKind, seed: u64, memory: f64) -> (Study, Record, Vec<Figure>) {
    let run = NoisyRun::new(seed, memory);
    let (study, record, truths) = match kind {
        StudyKind::Friction => friction(run),
        StudyKind::CoastDown => coast_down(run),
        StudyKind::Heating => heating(run),
        StudyKind::TorqueSpeed => torque_speed(run),
        other => panic!("{other:?} has no intervals"),
    };
    let found = study.evaluate(&record, &Measured::default());
    let estimates = estimates(&found);
    let figures = truths.into_iter().zip(estimates);
    let figures = figures.map(|((name, truth), found)| (name, truth, found));
    let figures = figures.collect();
    (study, record, figures)
}

/// The intervals of findings, in the order of the truths below.
pub fn estimates(found: &Findings) -> Vec<Option<Estimate>> {
    match found {
        Findings::Friction(found) => {
            let fit = found.friction;
            vec![
                fit.map(|it| it.coulomb_a),
                fit.map(|it| it.viscous_a_per_rpm),
            ]
        }
        Findings::CoastDown(found) => {
            let (coast, fit) = (found.coast, found.inertia);
            vec![
                coast.map(|it| it.dry_rad_s2),
                coast.map(|it| it.viscous_per_s),
                fit.map(|it| it.inertia_kg_m2),
                fit.map(|it| it.dry_nm),
                fit.map(|it| it.viscous_nm_s),
            ]
        }
        Findings::Heating(found) => {
            let fit = found.heating;
            vec![
                fit.map(|it| it.final_c),
                fit.map(|it| it.rise_k),
                fit.map(|it| it.time_constant_s),
            ]
        }
        Findings::TorqueSpeed(found) => {
            let line = found.line;
            vec![
                line.map(|it| it.no_load_rpm),
                line.and_then(|it| it.droop).map(|it| it.rpm_per_nm),
            ]
        }
        other => panic!("{other:?} has no intervals"),
    }
}

type Truths = Vec<(&'static str, f64)>;

fn friction(mut run: NoisyRun) -> (Study, Record, Truths) {
    let study = FrictionStudy::of(ONE);
    let (coulomb, viscous) = (run.constant(0.05, 0.4), run.constant(0.2e-3, 2e-3));
    let mut step = 0;
    for side in [1.0, -1.0] {
        for number in 1..=study.speeds {
            let rpm = side * study.highest_rpm * f64::from(number) / f64::from(study.speeds);
            let amps = coulomb * side + viscous * rpm;
            let state = State {
                rpm,
                amps,
                ..State::default()
            };
            run.step(step, Setpoint::Brake, for_s(study.hold_s, |_| state));
            step += 1;
        }
        run.step(step, Setpoint::Brake, for_s(2.0, |_| State::default()));
        step += 1;
    }
    let truths = vec![("Coulomb part", coulomb), ("viscous part", viscous)];
    (Study::Friction(study), run.record(), truths)
}

fn coast_down(mut run: NoisyRun) -> (Study, Record, Truths) {
    let study = CoastDownStudy::of(ONE);
    let inertia = run.constant(0.5e-3, 2e-3);
    let (dry, viscous) = (run.constant(1e-3, 5e-3), run.constant(0.5e-4, 2e-4));
    let rate = viscous / inertia;
    let amps = |amps: f64| Setpoint::Current(CurrentTarget::from_amps(narrow(amps)));
    let push = amps(study.push_amps);
    let Setpoint::Current(target) = push else {
        panic!()
    };
    let torque = 0.75 * f64::from(target.amps());
    // J dw/dt = torque - dry - viscous w, in closed form.
    let from = |w: f64, torque: f64, t_s: f64| {
        let ends = (torque - dry) / viscous;
        ends + (w - ends) * (-rate * t_s).exp()
    };
    let reached = study.speed_rpm * RAD_S_PER_RPM;
    let mut step = 0;
    for _ in 0..study.repeats {
        for side in [1.0, -1.0] {
            let state = |w: f64, amps: f64| State {
                rpm: side * w / RAD_S_PER_RPM,
                amps: side * amps,
                ..State::default()
            };
            let mut fastest = 0.0;
            while from(0.0, torque, fastest) < reached {
                fastest += REPLY_S;
            }
            let pushed = for_s(fastest, |t_s| {
                state(from(0.0, torque, t_s), study.push_amps)
            });
            run.step(step, amps(side * study.push_amps), pushed);
            let w = from(0.0, torque, fastest);
            let coasting = |t_s| {
                let w = from(w, 0.0, t_s);
                (w > 2.0 * RAD_S_PER_RPM).then(|| state(w, 0.0))
            };
            run.step(step + 1, amps(0.0), coasting);
            step += 2;
        }
    }
    let truths = vec![
        ("dry friction over inertia", dry / inertia),
        ("viscous friction over inertia", rate),
        ("inertia", inertia),
        ("dry friction", dry),
        ("viscous friction", viscous),
    ];
    (Study::CoastDown(study), run.record(), truths)
}

fn heating(mut run: NoisyRun) -> (Study, Record, Truths) {
    let study = HeatingStudy::of(ONE);
    let (air, rise) = (run.constant(18.0, 30.0), run.constant(15.0, 45.0));
    let constant = run.constant(150.0, 500.0);
    // Only the temperatures count.
    run.reply_s = 0.5;
    let mut passes = 0.0;
    while passes < study.for_s {
        let state = for_s(1.0, |t_s| State {
            celsius: air + rise * (1.0 - (-(passes + t_s) / constant).exp()),
            amps: study.amps,
            rpm: 20.0,
        });
        run.step(0, Setpoint::Brake, state);
        passes += 1.0;
    }
    let truths = vec![
        ("final temperature", air + rise),
        ("rise", rise),
        ("time constant", constant),
    ];
    (Study::Heating(study), run.record(), truths)
}

fn torque_speed(mut run: NoisyRun) -> (Study, Record, Truths) {
    let study = TorqueSpeedStudy::of(ONE);
    let (no_load, droop) = (run.constant(150.0, 210.0), run.constant(60.0, 120.0));
    // The idle current adds to the torque current at any angle, and the person brakes at will.
    let (idle, angle) = (run.constant(0.0, 0.3), run.constant(0.0, TAU / 4.0));
    let (brake_nm, bends) = (run.constant(0.4, 1.2), run.constant(0.5, 2.0));
    let rise = for_s(3.0, |t_s| State {
        rpm: no_load * t_s / 3.0,
        ..State::default()
    });
    run.step(0, Setpoint::Brake, rise);
    let state = |t_s: f64| {
        let part = ((t_s - 5.5) / (study.for_s - 6.0)).clamp(0.0, 1.0);
        let torque = brake_nm * part.powf(bends);
        let amps = torque / 0.75;
        State {
            rpm: no_load - droop * torque,
            amps: (amps + idle * angle.cos()).hypot(idle * angle.sin()),
            ..State::default()
        }
    };
    run.step(1, Setpoint::Brake, for_s(study.for_s, state));
    run.step(2, Setpoint::Brake, for_s(1.0, |_| State::default()));
    let truths = vec![("speed without load", no_load), ("droop", droop)];
    (Study::TorqueSpeed(study), run.record(), truths)
}
