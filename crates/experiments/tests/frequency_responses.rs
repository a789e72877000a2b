//! Frequency responses of a known system, and of the virtual motor.

use crate::measured;
use std::f64::consts::TAU;

use crate::analytic_systems::SecondOrder;
use crate::bench::Bench;
use motorlink_experiments::{
    analysis::{
        BodePoint, Invalid, Point, RPM_RESOLUTION, SineRun, bandwidth_hz, frequency_point,
        unwrap_phases,
    },
    sequence::{End, Quantity, Selection, Sequence, Shape, Step, Template, Wave},
};
use motorlink_simulator::MotorConfig;

/// A sine of whole rpm at 200 Hz through the system, and its replies in whole rpm.
struct Signals {
    command: Vec<Point>,
    response: Vec<Point>,
}

fn through(system: SecondOrder, wave: Wave, for_s: f64, lost: f64, seed: u64) -> Signals {
    let mut random = fastrand::Rng::with_seed(seed);
    let (mut command, mut response) = (Vec::new(), Vec::new());
    let omega = TAU * system.hz;
    let (mut y, mut dy, mut t_s) = (wave.centre, 0.0, 0.0);
    while t_s < for_s {
        let held = (wave.centre + wave.amplitude * (TAU * wave.hz * t_s).sin()).round();
        command.push(Point::new(t_s, held));
        // Up to a millisecond late, as the next tick of a busy worker.
        let next_s = (t_s / 5e-3 + 1.0).floor() * 5e-3 + 1e-3 * random.f64();
        let reply_s = t_s + 6e-4;
        let mut told = false;
        while t_s < next_s {
            if !told && t_s >= reply_s {
                told = true;
                if random.f64() >= lost {
                    response.push(Point::new(t_s, (y + 0.3 * (random.f64() - 0.5)).round()));
                }
            }
            let step_s = 5e-5;
            // Semi-implicit, in steps of a four-hundredth of a radian.
            dy += step_s * (omega * omega * (held - y) - 2.0 * system.damping * omega * dy);
            y += step_s * dy;
            t_s += step_s;
        }
    }
    Signals { command, response }
}

fn measure(signals: &Signals, wave: Wave, for_s: f64, amps: &[Point]) -> BodePoint {
    frequency_point(&SineRun {
        hz: wave.hz,
        amplitude: wave.amplitude,
        from_s: 0.5,
        to_s: for_s,
        command: &signals.command,
        response: &signals.response,
        amps,
        amps_max: Some(2.7),
        request_hz: 200.0,
        resolution: RPM_RESOLUTION,
    })
}

#[test]
fn a_second_order_system_has_its_bode_plot() {
    let system = SecondOrder {
        hz: 6.0,
        damping: 0.6,
    };
    let mut points = Vec::new();
    for step in Template::SineSweep.sequence().steps {
        let Step::Move(step) = step else { continue };
        let motorlink_experiments::sequence::Action::Follow {
            shape: Shape::Sine(wave),
            ..
        } = step.action
        else {
            continue;
        };
        let End::After(for_s) = step.end else {
            panic!("a sine without end")
        };
        let for_s = for_s + 0.5;
        let signals = through(system, wave, for_s, 0.05, 3);
        points.push(measure(&signals, wave, for_s, &[]));
    }
    unwrap_phases(&mut points);
    let mut judged = 0;
    for point in points.iter().filter(|point| point.hz < 10.1) {
        let (gain_db, phase_deg) = system.response(point.hz);
        assert_eq!(point.invalid, None, "{point:?}");
        assert!((point.gain_db - gain_db).abs() < 0.5, "{point:?} {gain_db}");
        assert!(
            (point.phase_deg - phase_deg).abs() < 5.0,
            "{point:?} {phase_deg}"
        );
        assert!(point.turn_is_known, "{point:?}");
        judged += 1;
    }
    assert_eq!(judged, 18);
}

#[test]
fn points_that_do_not_count_are_marked() {
    let system = SecondOrder {
        hz: 6.0,
        damping: 0.6,
    };
    let wave = Wave {
        centre: 80.0,
        amplitude: 20.0,
        hz: 1.0,
    };
    let good = through(system, wave, 4.5, 0.0, 1);
    assert_eq!(measure(&good, wave, 4.5, &[]).invalid, None);
    let of = |signals: &Signals, amps: &[Point]| measure(signals, wave, 4.5, amps).invalid;
    let lossy = through(system, wave, 4.5, 0.5, 1);
    assert_eq!(of(&lossy, &[]), Some(Invalid::RepliesLost));
    assert_eq!(
        of(&good, &[Point::new(2.0, -2.69)]),
        Some(Invalid::Saturated)
    );
    let mut clipped = through(system, wave, 4.5, 0.0, 1);
    for point in &mut clipped.command {
        point.value = point.value.clamp(65.0, 95.0);
    }
    assert_eq!(of(&clipped, &[]), Some(Invalid::Clipped));
    let mut noisy = through(system, wave, 4.5, 0.0, 1);
    let mut random = fastrand::Rng::with_seed(5);
    for point in &mut noisy.response {
        point.value += 80.0 * (random.f64() - 0.5);
    }
    assert_eq!(of(&noisy, &[]), Some(Invalid::Noisy));
    let mut still = through(system, wave, 4.5, 0.0, 1);
    for point in &mut still.response {
        point.value = 80.0;
    }
    assert_eq!(of(&still, &[]), Some(Invalid::TooSmall));
    assert_eq!(
        measure(&good, wave, 1.8, &[]).invalid,
        Some(Invalid::TooShort)
    );
    assert!(
        measure(&good, wave, 1.8, &[]).gain_db.is_nan(),
        "nothing is put in its place"
    );
}

/// A sine of this amplitude that rounding makes lower than it is, and its answer.
#[test]
fn a_rounded_sine_is_not_clipped_at_any_amplitude() {
    let system = SecondOrder {
        hz: 30.0,
        damping: 0.7,
    };
    for tenths in 30..=60 {
        for hz in [1.0, 5.0, 10.0] {
            let wave = Wave {
                centre: 80.0,
                amplitude: f64::from(tenths) / 10.0,
                hz,
            };
            let signals = through(system, wave, 6.5, 0.0, 1);
            assert_eq!(measure(&signals, wave, 6.5, &[]).invalid, None, "{wave:?}");
        }
    }
}

fn point(hz: f64, gain_db: f64, phase_deg: f64) -> BodePoint {
    BodePoint {
        hz,
        gain_db,
        phase_deg,
        turn_is_known: false,
        r_squared: 1.0,
        from_s: 0.0,
        to_s: 6.0,
        invalid: None,
    }
}

/// A dead time as it is measured: up to whole turns.
fn dead_time(seconds: f64, frequencies: &[f64]) -> Vec<BodePoint> {
    let measured = |hz: &f64| {
        let phase_deg = -360.0 * seconds * hz;
        point(*hz, 0.0, (phase_deg + 270.0).rem_euclid(360.0) - 270.0)
    };
    let mut points: Vec<BodePoint> = frequencies.iter().map(measured).collect();
    unwrap_phases(&mut points);
    points
}

#[test]
fn a_phase_has_its_turn_or_the_turn_is_unknown() {
    for milliseconds in 1..=100 {
        let seconds = f64::from(milliseconds) * 1e-3;
        for ratio in [1.1, 1.26, 2.0, 4.0, 10.0, 100.0] {
            let frequencies: Vec<f64> = (0..100)
                .map(|place| 0.2 * f64::powi(ratio, place))
                .take_while(|hz| *hz < 20.1)
                .collect();
            for point in dead_time(seconds, &frequencies) {
                let off = point.phase_deg + 360.0 * seconds * point.hz;
                assert!(
                    !point.turn_is_known || off.abs() < 1e-6,
                    "{ratio} {point:?}"
                );
            }
        }
    }
    // Evenly per octave as the study has them: 20 ms are known up to 20 Hz.
    let study: Vec<f64> = (0..21)
        .map(|place| 0.2 * 100.0_f64.powf(f64::from(place) / 20.0))
        .collect();
    let points = dead_time(0.02, &study);
    assert!(points.iter().all(|point| point.turn_is_known));
    // A full turn in ten times the frequency reads as none.
    let sparse = dead_time(0.05, &[2.0, 20.0]);
    assert!(sparse[0].turn_is_known && !sparse[1].turn_is_known);
    assert!(!dead_time(0.05, &[20.0])[0].turn_is_known);
}

#[test]
fn a_lead_is_positive_and_a_lag_negative() {
    let system = SecondOrder {
        hz: 30.0,
        damping: 0.7,
    };
    let wave = Wave {
        centre: 80.0,
        amplitude: 20.0,
        hz: 2.0,
    };
    let mut signals = through(system, wave, 6.5, 0.0, 1);
    assert!((-25.0..0.0).contains(&measure(&signals, wave, 6.5, &[]).phase_deg));
    // As if every reply were older than it is.
    for reply in &mut signals.response {
        reply.t_s -= 0.1;
    }
    let lead = measure(&signals, wave, 6.5, &[]).phase_deg;
    assert!((50.0..72.0).contains(&lead), "{lead}");
}

#[test]
fn a_bandwidth_is_interpolated_between_neighbouring_valid_points() {
    // A first-order lag with its corner at 2.5 Hz.
    let lag = |hz: f64| point(hz, -10.0 * (1.0 + (hz / 2.5).powi(2)).log10(), 0.0);
    let mut points: Vec<BodePoint> = [0.01, 2.0, 2.4, 3.0, 5.0].map(lag).to_vec();
    let found = bandwidth_hz(&points).unwrap();
    assert!((found / 2.5 - 1.0).abs() < 0.01, "{found}");
    points[2].invalid = Some(Invalid::Saturated);
    assert_eq!(bandwidth_hz(&points), None);
    assert_eq!(bandwidth_hz(&points[..2]), None);
    assert_eq!(bandwidth_hz(&[]), None);
}

/// Torque current to speed: `Kt / (J s + b)`, which the virtual motor has without a controller.
#[test]
fn the_virtual_motor_has_the_bode_plot_of_its_wheel() {
    let mut steps = vec![];
    for hz in [1.0, 2.0, 4.0, 7.0, 10.0] {
        // 40 rpm to either side, at any frequency.
        let amplitude = 40.0 * TAU / 60.0 * TAU * hz * 1e-3 / 0.75;
        let wave = Wave {
            centre: 0.0,
            amplitude,
            hz,
        };
        let shape = Shape::Sine(wave);
        steps.push(Step::follow(
            Selection::All,
            Quantity::Amps,
            shape,
            End::After((3.0 * hz).ceil() / hz + 1.0),
        ));
    }
    let sequence = Sequence {
        steps,
        ..Sequence::default()
    };
    let mut bench = Bench::new(3, MotorConfig::default());
    let points = measured::sweep(&mut bench, &sequence, 1.0);
    assert_eq!(points.len(), 5);
    for point in points {
        let omega = TAU * point.hz;
        let (re, im) = (1e-4, omega * 1e-3);
        let gain_db = 20.0 * (0.75 * 60.0 / TAU / im.hypot(re)).log10();
        let phase_deg = -im.atan2(re).to_degrees();
        assert_eq!(point.invalid, None);
        assert!((point.gain_db - gain_db).abs() < 0.5, "{point:?} {gain_db}");
        assert!(
            (point.phase_deg - phase_deg).abs() < 5.0,
            "{point:?} {phase_deg}"
        );
    }
}

#[test]
fn the_sweep_template_measures_the_virtual_motors_velocity_loop() {
    let mut bench = Bench::new(4, MotorConfig::default());
    let points = measured::sweep(&mut bench, &Template::SineSweep.sequence(), 0.5);
    assert_eq!(points.len(), 21);
    // Its lag of 58 ms is most of it: -3 dB at 2.7 Hz. Beyond 10 Hz the answer is below the steps of the report.
    let lag = |hz: f64| -20.0 * (TAU * hz * 0.058).hypot(1.0).log10();
    for point in points {
        assert_eq!(point.invalid.is_none(), point.hz < 10.1, "{point:?}");
        let is_slow = point.hz < 2.6;
        assert!(
            !is_slow || (point.gain_db - lag(point.hz)).abs() < 0.8,
            "{point:?}"
        );
    }
}
