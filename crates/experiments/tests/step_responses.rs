//! Step responses of systems with known answers, and of the virtual motor.

use crate::analytic_systems::{SecondOrder, VelocityLoop, exact_figures, first_order, replies};
use crate::measured;
use motorlink_experiments::analysis::{
    Point, StepFigures, StepRun, spread, step_figures, step_summary,
};

/// Each time within 3 %, each value within 1 % of the step. A latency is no better known than half of the time
/// between two replies.
fn agree(found: &StepFigures, exact: &StepFigures, step: f64, what: &str) {
    let times = [
        ("latency", found.latency_s, exact.latency_s, 2.5e-3),
        ("rise", found.rise_s, exact.rise_s, 0.0),
        ("settling", found.settling_s, exact.settling_s, 0.0),
    ];
    for (name, found, exact, tick_s) in times {
        let (found, exact) = (found.expect(name), exact.expect(name));
        let off = (found - exact).abs();
        assert!(
            off <= 0.03 * exact + tick_s,
            "{what}: {name} {found} {exact}"
        );
    }
    let over = found.overshoot.unwrap() - exact.overshoot.unwrap();
    assert!(over.abs() <= 0.01, "{what}: overshoot {over}");
    assert!(found.steady_error.unwrap().abs() <= 0.01 * step, "{what}");
}

/// The medians of some repeats.
fn medians(repeats: &[StepFigures]) -> StepFigures {
    let all = step_summary(repeats);
    StepFigures {
        latency_s: all.latency_s.map(|it| it.median),
        rise_s: all.rise_s.map(|it| it.median),
        overshoot: all.overshoot.map(|it| it.median),
        settling_s: all.settling_s.map(|it| it.median),
        steady_error: all.steady_error.map(|it| it.median),
        peak_amps: all.peak_amps.map(|it| it.median),
        ..StepFigures::default()
    }
}

fn measure(answer: &dyn Fn(f64) -> f64, noise: f64, seed: u64) -> StepFigures {
    let mut random = fastrand::Rng::with_seed(seed);
    let repeats: Vec<StepFigures> = (0..9)
        .map(|_| {
            let response = replies(|t_s| 100.0 * answer(t_s), 4.0, noise, &mut random);
            step_figures(&StepRun {
                at_s: 0.0,
                from: 0.0,
                to: 100.0,
                response: &response,
                amps: &[],
                resolution: 1.0,
            })
        })
        .collect();
    medians(&repeats)
}

#[test]
fn a_first_order_system_has_the_figures_of_the_textbook() {
    let found = measure(&|t_s| first_order(t_s, 0.2), 0.0, 1);
    let exact = StepFigures {
        latency_s: Some(0.2 * 0.010_05),
        rise_s: Some(0.2 * 9.0_f64.ln()),
        overshoot: Some(0.0),
        settling_s: Some(0.2 * 50.0_f64.ln()),
        steady_error: Some(0.0),
        ..StepFigures::default()
    };
    agree(&found, &exact, 100.0, "first order");
    agree(
        &exact_figures(|t_s| first_order(t_s, 0.2), 4.0),
        &exact,
        100.0,
        "evaluation",
    );
}

#[test]
fn second_order_systems_have_theirs_with_rounding_noise_and_lost_replies() {
    for (hz, damping) in [(2.0, 0.3), (3.0, 0.5), (1.5, 0.7), (4.0, 0.9)] {
        let system = SecondOrder { hz, damping };
        let exact = exact_figures(|t_s| system.step(t_s), 4.0);
        let overshoot = (-std::f64::consts::PI * damping / (1.0 - damping * damping).sqrt()).exp();
        assert!((exact.overshoot.unwrap() - overshoot).abs() < 1e-4);
        for noise in [0.0, 0.2] {
            let found = measure(&|t_s| system.step(t_s), noise, 7);
            agree(
                &found,
                &exact,
                100.0,
                &format!("{hz} Hz, {damping}, noise {noise}"),
            );
        }
    }
}

#[test]
fn the_virtual_motor_has_the_step_response_of_its_model() {
    for acceleration in [1, 3] {
        let exact = VelocityLoop::of_100_rpm(acceleration);
        let exact = exact_figures(|t_s| exact.step(t_s), 3.0);
        let (_, figures) = measured::steps(1, acceleration);
        assert_eq!(figures.len(), 7);
        let found = medians(&figures);
        agree(
            &found,
            &exact,
            100.0,
            &format!("acceleration {acceleration}"),
        );
        // The virtual motor's noise is 0.21 A to either side, and at no load it reports 0.24 A.
        let peak = found.peak_amps.unwrap();
        assert!((0.3..0.5).contains(&peak), "{peak}");
    }
}

#[test]
fn what_the_replies_do_not_show_has_no_figure() {
    let points = |values: &[f64]| -> Vec<Point> {
        let times = (0_u32..).map(|tick| f64::from(tick) * 0.1);
        times
            .zip(values)
            .map(|(t_s, value)| Point::new(t_s, *value))
            .collect()
    };
    let run = |response: &[Point]| {
        step_figures(&StepRun {
            at_s: 0.0,
            from: 0.0,
            to: 100.0,
            response,
            amps: &[],
            resolution: 1.0,
        })
    };
    // A blocked wheel.
    let found = run(&points(&[0.0; 20]));
    assert!(!found.settled);
    assert_eq!((found.rise_s, found.steady_error), (None, None));
    // Too few replies.
    assert_eq!(run(&points(&[0.0, 100.0])).steady_error, None);
    // One that swings on does not settle.
    let swings: Vec<f64> = (0..40)
        .map(|tick| if tick % 2 == 0 { 80.0 } else { 120.0 })
        .collect();
    assert_eq!(run(&points(&swings)).settling_s, None);
}

#[test]
fn spreads_are_those_of_published_quartiles() {
    // Hyndman and Fan's type 7, as R's default quantile gives it for these.
    let found = spread([
        6.0, 7.0, 15.0, 36.0, 39.0, 40.0, 41.0, 42.0, 43.0, 47.0, 49.0,
    ])
    .unwrap();
    assert_eq!((found.low, found.median, found.high), (25.5, 40.0, 42.5));
    assert_eq!(spread([]), None);
}
