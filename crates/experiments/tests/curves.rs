//! Shapes over time, and the curves that a table is drawn as.

use motorlink_experiments::{
    plan::{Fleet, Plan},
    sequence::{Sequence, Shape, Template, Wave},
};
use motorlink_protocol::MotorId;

fn id(address: u8) -> MotorId {
    MotorId::new(address).unwrap()
}

fn fleet() -> Fleet {
    Fleet::of([id(1), id(2)])
}

#[test]
fn a_curve_shows_the_shape_of_each_step() {
    let text = r#"{ "motorlink_sequence": 1, "steps": [
           { "rpm": 100, "shape": "ramp", "for_s": 2 },
           { "rpm": 100, "motor": 1, "shape": "sine", "amplitude": 20, "hz": 1, "for_s": 1 },
           { "repeat": 2, "steps": [{ "rpm": -50, "for_s": 1 }] }] }"#;
    let plan = Plan::new(&Sequence::from_json(text).unwrap(), &fleet()).unwrap();
    let curves = plan.curves();
    let [first, second] = curves.as_slice() else {
        panic!("two motors");
    };
    assert_eq!((first.motor.least, first.motor.greatest), (-50.0, 120.0));
    assert_eq!((second.motor.least, second.motor.greatest), (-50.0, 100.0));
    let top = first.points.iter().map(|point| point.value);
    assert!((top.fold(0.0, f64::max) - 120.0).abs() < 1.0);
    let last = second.points.last().unwrap();
    assert_eq!((last.t_s, last.value), (5.0, -50.0));
    assert!(first.points.is_sorted_by(|one, next| one.t_s <= next.t_s));
}

/// The times at which a curve jumps to another setpoint, with the setpoint.
fn jumps(plan: &Plan, begun: &[(f64, usize)]) -> Vec<(f64, f64)> {
    let curves = plan.curves_of_run(begun);
    let pairs = curves[0].points.windows(2);
    let jumps = pairs.filter(|pair| (pair[0].value - pair[1].value).abs() > 1e-9);
    jumps.map(|pair| (pair[1].t_s, pair[1].value)).collect()
}

#[test]
fn what_follows_a_condition_is_drawn_where_it_happened() {
    let text = r#"{ "motorlink_sequence": 1, "steps": [
           { "rpm": 50, "until": { "rpm_above": 45 }, "within_s": 20 },
           { "rpm": 20, "for_s": 1 },
           { "rpm": 60, "for_s": 1 }] }"#;
    let plan = Plan::new(&Sequence::from_json(text).unwrap(), &fleet()).unwrap();
    assert_eq!(jumps(&plan, &[]), [(0.0, 50.0), (20.0, 20.0), (21.0, 60.0)]);
    assert_eq!(
        jumps(&plan, &[(0.0, 0), (0.4, 1)]),
        [(0.0, 50.0), (0.4, 20.0), (1.4, 60.0)]
    );
    // The second step was paused for 5 s.
    assert_eq!(
        jumps(&plan, &[(0.0, 0), (0.4, 1), (6.4, 2)]),
        [(0.0, 50.0), (0.4, 20.0), (6.4, 60.0)]
    );
}

#[test]
fn a_loop_that_a_condition_has_ended_is_drawn_as_often_as_it_ran() {
    let text = r#"{ "motorlink_sequence": 1, "steps": [
           { "repeat": 9, "until": { "rpm_above": 50 }, "steps": [
               { "rpm": 60, "for_s": 1 }, { "rpm": 10, "for_s": 1 }] },
           { "rpm": 30, "for_s": 1 }] }"#;
    let plan = Plan::new(&Sequence::from_json(text).unwrap(), &fleet()).unwrap();
    let ran = [(0.0, 1), (1.0, 2), (2.0, 1), (3.0, 2), (4.0, 4)];
    let expected = [
        (0.0, 60.0),
        (1.0, 10.0),
        (2.0, 60.0),
        (3.0, 10.0),
        (4.0, 30.0),
    ];
    assert_eq!(jumps(&plan, &ran), expected);
    assert_eq!(
        jumps(&plan, &ran[..2]).len(),
        19,
        "the passes that are left"
    );
}

#[test]
fn a_long_curve_is_cut_and_says_so() {
    let plan = Plan::new(&Template::Endurance.sequence(), &fleet()).unwrap();
    for curve in plan.curves() {
        assert!(curve.cut && curve.points.len() <= 20_001);
    }
}

#[test]
fn shapes_have_their_values() {
    let wave = Wave {
        centre: 10.0,
        amplitude: 4.0,
        hz: 0.5,
    };
    let table = [
        (Shape::Step { to: 3.0 }, 0.0, 3.0),
        (Shape::Ramp { to: 3.0 }, 5.0, 2.0),
        (Shape::Ramp { to: 3.0 }, 99.0, 3.0),
        (Shape::Sine(wave), 0.5, 14.0),
        (Shape::Triangle(wave), 0.0, 10.0),
        (Shape::Triangle(wave), 0.25, 12.0),
        (Shape::Triangle(wave), 0.5, 14.0),
        (Shape::Triangle(wave), 1.5, 6.0),
        // From 1 to 4 Hz in 10 s: (4 - 1) * 10 / ln 4 periods are 21.64, so its sine is -0.7722.
        (
            Shape::Chirp {
                wave: Wave { hz: 1.0, ..wave },
                to_hz: 4.0,
            },
            10.0,
            6.911,
        ),
    ];
    for (shape, t_s, expected) in table {
        let value = shape.value(1.0, t_s, 10.0);
        assert!((value - expected).abs() < 1e-3, "{shape:?}: {value}");
    }
}
