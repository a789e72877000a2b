//! What the virtual motor's experiments measure, beside what it was built with. For the tests and for the
//! figures of `cargo xtask experiments`.
#![allow(dead_code, reason = "each user takes its own part")]

use motorlink_experiments::{
    analysis::{
        BodePoint, CoastDown, Heating, Inertia, Point, Push, SineRun, StepFigures, StepRun,
        StepSummary, TORQUE_NM_PER_A, Trace, coast_down, frequency_point, heating, inertia,
        step_figures, step_summary, unwrap_phases,
    },
    sequence::{Action, Move, Sequence, Shape, Step, Wave},
};
use motorlink_simulator::MotorConfig;

use crate::bench::{Bench, Run};

/// Moment of inertia of the virtual wheel (`crates/simulator/src/physics/wheel.rs`).
pub const INERTIA: f64 = 1.0e-3;
/// Its dry friction without load.
pub const DRY: f64 = 1.0e-3;
/// Its viscous friction.
pub const VISCOUS: f64 = 1.0e-4;
/// Time constant of its winding (`physics/heat.rs`).
pub const HEATING_S: f64 = 300.0;

/// Friction and inertia as a user measures them: the current loop pushes the wheel and lets it coast.
pub fn friction_and_inertia(seed: u64) -> (CoastDown, Inertia, f64) {
    // Each seed is another wheel: up to five times the friction of a bearing.
    let load_nm = f64::from(u32::try_from(seed % 5).unwrap()) * 1e-3;
    let motor = MotorConfig {
        load_nm: format!("{load_nm}").parse().unwrap(),
        ..MotorConfig::default()
    };
    let mut bench = Bench::new(seed, motor);
    let run = bench.run(
        r#"{ "repeat": 2, "steps": [
             { "amps": 0.1, "until": { "rpm_above": 120 }, "within_s": 5 },
             { "amps": 0, "until": { "rpm_below": 2 }, "within_s": 30 },
             { "amps": -0.1, "until": { "rpm_above": 120 }, "within_s": 5 },
             { "amps": 0, "until": { "rpm_below": 2 }, "within_s": 30 }] },
           { "repeat": 6, "steps": [
             { "amps": 0.1, "for_s": 0.16 },
             { "amps": -0.1, "for_s": 0.16 }] }"#,
    );
    let coasts = [2, 4].into_iter().flat_map(|step| run.times(step));
    let coasts: Vec<&[Point]> = coasts.map(|times| run.rpm(later(times, 0.02))).collect();
    let coast = coast_down(&coasts).expect("a coast-down");
    let pushes: Vec<Push> = [7, 8]
        .into_iter()
        .flat_map(|step| run.times(step))
        .map(|times| Push {
            torque_nm: commanded(&run, times) * TORQUE_NM_PER_A,
            speed: run.rpm(later(times, 0.01)),
        })
        .collect();
    let found = inertia(&pushes, &coast).expect("pushes");
    (coast, found, DRY + load_nm)
}

/// The current that was sent: the wire carries steps of 0.24 mA.
fn commanded(run: &Run, (_, to_s): (f64, f64)) -> f64 {
    let mut command = run.trace.command.iter().rev();
    let last = command.find(|point| point.t_s < to_s);
    last.expect("a setpoint").value
}

fn later((from, to): (f64, f64), by: f64) -> (f64, f64) {
    (from + by, to)
}

/// Steps from 0 to 100 rpm and back.
pub fn steps(seed: u64, acceleration: u8) -> (StepSummary, Vec<StepFigures>) {
    let mut bench = Bench::new(seed, MotorConfig::default());
    let run = bench.run(&format!(
        r#"{{ "repeat": 7, "steps": [
             {{ "rpm": 0, "for_s": 1.2 }},
             {{ "rpm": 100, "acceleration": {acceleration}, "for_s": 3 }}] }}"#
    ));
    let figures: Vec<StepFigures> = run
        .times(2)
        .into_iter()
        .filter_map(|(from, to)| {
            let mut command = run.trace.command.iter();
            let heard = command.find(|point| point.t_s >= from)?;
            Some(step_figures(&StepRun {
                at_s: heard.t_s,
                from: 0.0,
                to: 100.0,
                response: run.rpm((heard.t_s, to)),
                amps: run.amps((heard.t_s, to)),
                resolution: 1.0,
            }))
        })
        .collect();
    (step_summary(&figures), figures)
}

/// A sine sweep of a sequence, as Bode points.
pub fn sweep(bench: &mut Bench, sequence: &Sequence, settle_s: f64) -> Vec<BodePoint> {
    let run = bench.run_sequence(sequence);
    let sines = sequence.steps.iter().enumerate();
    let sines = sines.filter_map(|(number, step)| match step {
        Step::Move(Move {
            action:
                Action::Follow {
                    shape: Shape::Sine(wave),
                    ..
                },
            ..
        }) => Some((number, *wave)),
        _ => None,
    });
    let mut points: Vec<BodePoint> = sines
        .flat_map(|(number, wave)| run.times(number).into_iter().map(move |it| (wave, it)))
        .map(|(wave, times)| bode(&run, wave, times, settle_s))
        .collect();
    unwrap_phases(&mut points);
    points
}

fn bode(run: &Run, wave: Wave, (from_s, to_s): (f64, f64), settle_s: f64) -> BodePoint {
    frequency_point(&SineRun {
        hz: wave.hz,
        amplitude: wave.amplitude,
        from_s: from_s + settle_s,
        to_s,
        command: &run.trace.command,
        response: &run.trace.rpm,
        amps: &run.trace.amps,
        amps_max: Some(2.7),
        request_hz: 200.0,
        resolution: 1.0,
    })
}

/// The winding at an even current: 1 N.m at 50 rpm for half an hour.
pub fn warm_up(seed: u64) -> Heating {
    let motor = MotorConfig {
        load_nm: 1.0,
        ..MotorConfig::default()
    };
    let run = Bench::new(seed, motor).run(r#"{ "rpm": 50, "for_s": 1500 }"#);
    let celsius: &[Point] = Trace::between(&run.trace.celsius, 0.0, f64::INFINITY);
    heating(celsius).expect("it warms up")
}
