//! Models of known systems: order, values and intervals.

use std::f64::consts::TAU;

use motorlink_experiments::analysis::{
    BodePoint, Estimate, FittedModel, Lag, Point, bode_model, step_model,
};

/// A lag with this dead time, in seconds: its answer to a step of 1, and gain and phase in rad.
struct System {
    dead_s: f64,
    step: fn(f64) -> f64,
    response: fn(f64) -> (f64, f64),
}

const FIRST: System = System {
    dead_s: 0.06,
    step: |t_s| 0.95 * (1.0 - (-t_s / 0.15).exp()),
    response: |omega| (0.95 / (omega * 0.15).hypot(1.0), -(omega * 0.15).atan()),
};

/// 2 Hz, damping 0.4.
const SECOND: System = System {
    dead_s: 0.03,
    step: |t_s| {
        let (natural, damping) = (TAU * 2.0, 0.4_f64);
        let turn = (1.0 - damping * damping).sqrt();
        let angle = natural * t_s;
        1.0 - (-damping * angle).exp()
            * ((turn * angle).cos() + damping / turn * (turn * angle).sin())
    },
    response: |omega| {
        let part = omega / (TAU * 2.0);
        let (re, im) = (1.0 - part * part, 0.8 * part);
        (1.0 / re.hypot(im), -im.atan2(re))
    },
};

/// Five steps of 100 rpm, reported at 200 Hz in whole rpm, with correlated noise of 0.5 rpm.
fn steps(system: &System, seed: u64) -> Vec<Vec<Point>> {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut noise = 0.0;
    let mut repeat = |_| {
        let shift = random.f64() * 0.005;
        let points = (0..400).map(|place| {
            let t_s = f64::from(place) * 0.005 + shift;
            let done = if t_s > system.dead_s {
                (system.step)(t_s - system.dead_s)
            } else {
                0.0
            };
            // Uniform noise of this width has the deviation of the rest of an autoregression.
            noise = 0.9 * noise + (random.f64() - 0.5) * 0.5 * (12.0 * 0.19_f64).sqrt();
            Point::new(t_s, (100.0 * done + noise).round() / 100.0)
        });
        points.collect()
    };
    (0..5).map(&mut repeat).collect()
}

fn bode(system: &System) -> Vec<BodePoint> {
    let points = (0..21).map(|place| {
        let hz = 0.2 * 100_f64.powf(f64::from(place) / 20.0);
        let (gain, phase) = (system.response)(TAU * hz);
        // A repeatable error of 1 %.
        let off = 1.0 + 0.01 * (f64::from(place) * 2.4).sin();
        BodePoint {
            hz,
            gain_db: 20.0 * (gain * off).log10(),
            phase_deg: (phase - TAU * hz * system.dead_s).to_degrees() * off,
            turn_is_known: true,
            r_squared: 1.0,
            from_s: 0.0,
            to_s: 1.0,
            invalid: None,
        }
    });
    points.collect()
}

fn is_near(found: Estimate, truth: f64, part: f64) -> bool {
    (found.value / truth - 1.0).abs() < part
}

fn is_first(model: &FittedModel, part: f64) -> bool {
    let Lag::First { time_constant_s } = model.lag else {
        return false;
    };
    is_near(time_constant_s, 0.15, part)
        && is_near(model.dead_time_s, 0.06, part)
        && is_near(model.gain, 0.95, part)
}

fn is_second(model: &FittedModel, part: f64) -> bool {
    let Lag::Second {
        natural_hz,
        damping,
    } = model.lag
    else {
        return false;
    };
    is_near(natural_hz, 2.0, part)
        && is_near(damping, 0.4, part)
        && is_near(model.dead_time_s, 0.03, 5.0 * part)
        && is_near(model.gain, 1.0, part)
}

#[test]
fn known_systems_are_found_from_their_steps() {
    for seed in 0..20 {
        let first = step_model(&steps(&FIRST, seed)).unwrap();
        assert!(is_first(&first, 0.05), "{seed}: {first:?}");
        let second = step_model(&steps(&SECOND, seed)).unwrap();
        assert!(is_second(&second, 0.05), "{seed}: {second:?}");
    }
}

#[test]
fn known_systems_are_found_from_their_bode_plots() {
    let first = bode_model(&bode(&FIRST)).unwrap();
    assert!(is_first(&first, 0.05), "{first:?}");
    let second = bode_model(&bode(&SECOND)).unwrap();
    assert!(is_second(&second, 0.05), "{second:?}");
    // What is drawn is the model.
    let (gain_db, phase_deg) = second.response(2.0);
    assert!((gain_db - 20.0 * 1.25_f64.log10()).abs() < 0.3, "{gain_db}");
    assert!((phase_deg + 90.0 + 21.6).abs() < 3.0, "{phase_deg}");
}

/// 99 of 100 intervals hold the truth: of 400 at least 97 %.
#[test]
fn intervals_of_a_step_model_hold_the_truth() {
    let (mut held, mut all) = ([0_u32; 3], 0_u32);
    for seed in 100..500 {
        let model = step_model(&steps(&FIRST, seed)).unwrap();
        let Lag::First { time_constant_s } = model.lag else {
            continue;
        };
        all += 1;
        let found = [
            (model.gain, 0.95),
            (model.dead_time_s, 0.06),
            (time_constant_s, 0.15),
        ];
        for (held, (estimate, truth)) in held.iter_mut().zip(found) {
            *held += u32::from(estimate.holds(truth));
        }
    }
    println!("held {held:?} of {all}, out of 400");
    assert!(all >= 380, "{all} of first order");
    assert!(
        held.iter().all(|held| held * 100 >= all * 97),
        "{held:?} of {all}"
    );
}

#[test]
fn fewer_than_three_repeats_have_no_interval_and_none_has_no_model() {
    let two = &steps(&FIRST, 1)[..2];
    let model = step_model(two).unwrap();
    assert!(!model.gain.is_measurable() && (model.gain.value - 0.95).abs() < 0.02);
    assert!(step_model(&[]).is_none());
    assert!(bode_model(&[]).is_none());
}
