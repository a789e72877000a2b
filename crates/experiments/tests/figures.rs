//! The figures of `cargo xtask experiments`, as lines of a table.

use std::f64::consts::TAU;

use crate::analytic_systems::{VelocityLoop, exact_figures};
use crate::bench::Bench;
use crate::measured::{INERTIA, VISCOUS, friction_and_inertia, steps, sweep};
use motorlink_experiments::sequence::{End, Quantity, Selection, Sequence, Shape, Step, Wave};
use motorlink_simulator::MotorConfig;

#[test]
#[ignore = "prints figures; cargo xtask experiments runs it"]
fn figures() {
    step_response();
    bode();
    friction();
}

fn step_response() {
    let mut worst = [0.0_f64; 3];
    for acceleration in [1, 3] {
        let exact = VelocityLoop::of_100_rpm(acceleration);
        let exact = exact_figures(|t_s| exact.step(t_s), 3.0);
        let (found, _) = steps(1, acceleration);
        let times = [
            (found.latency_s, exact.latency_s),
            (found.rise_s, exact.rise_s),
            (found.settling_s, exact.settling_s),
        ];
        for (worst, (found, exact)) in worst.iter_mut().zip(times) {
            let (found, exact) = (found.unwrap().median, exact.unwrap());
            *worst = worst.max((found / exact - 1.0).abs() * 100.0);
        }
    }
    let [latency, rise, settling] = worst;
    println!(
        "| step response of the virtual motor, off the analytic answer | latency {latency:.1} %, rise {rise:.1} %, settling {settling:.1} % |"
    );
}

fn bode() {
    let frequencies = [1.0, 2.0, 4.0, 6.0, 8.0, 10.0];
    let step = |hz: f64| {
        let amplitude = 40.0 * TAU / 60.0 * TAU * hz * INERTIA / 0.75;
        let wave = Wave {
            centre: 0.0,
            amplitude,
            hz,
        };
        let end = End::After((3.0 * hz).ceil() / hz + 1.0);
        Step::follow(Selection::All, Quantity::Amps, Shape::Sine(wave), end)
    };
    let sequence = Sequence {
        steps: frequencies.map(step).into(),
        ..Sequence::default()
    };
    let points = sweep(&mut Bench::new(3, MotorConfig::default()), &sequence, 1.0);
    let (mut gain, mut phase) = (0.0_f64, 0.0_f64);
    for point in points.iter().filter(|point| point.invalid.is_none()) {
        let (re, im) = (VISCOUS, TAU * point.hz * INERTIA);
        let gain_db = 20.0 * (0.75 * 60.0 / TAU / im.hypot(re)).log10();
        gain = gain.max((point.gain_db - gain_db).abs());
        phase = phase.max((point.phase_deg + im.atan2(re).to_degrees()).abs());
    }
    let count = points.iter().filter(|it| it.invalid.is_none()).count();
    println!(
        "| Bode plot of the virtual wheel, {count} of 6 points valid, up to 10 Hz | gain {gain:.2} dB, phase {phase:.1} degrees |"
    );
}

fn friction() {
    let (mut worst, mut inside) = ([0.0_f64; 3], [0_u32; 3]);
    for seed in 0..100 {
        let (_, found, dry) = friction_and_inertia(seed);
        let pairs = [
            (found.inertia_kg_m2, INERTIA),
            (found.dry_nm, dry),
            (found.viscous_nm_s, VISCOUS),
        ];
        for (place, (estimate, truth)) in pairs.into_iter().enumerate() {
            worst[place] = worst[place].max((estimate.value / truth - 1.0).abs() * 100.0);
            inside[place] += u32::from(estimate.holds(truth));
        }
    }
    for (place, name) in ["inertia", "dry friction", "viscous friction"]
        .into_iter()
        .enumerate()
    {
        let (worst, inside) = (worst[place], inside[place]);
        println!(
            "| {name} of the virtual motor, 100 seeds | off by {worst:.1} % at most, inside its confidence in {inside} of 100 |"
        );
    }
}
