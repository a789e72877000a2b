//! The angle of an odometry reply is not the angle of position setpoints.

use crate::run_fixture::ONE;
use motorlink_experiments::{
    plan::{Fleet, Plan},
    runner::{Options, Runner, StartRefusal, Telemetry},
    sequence::Sequence,
};
use motorlink_protocol::{Current, Faults, Instant, Mode};

/// A DDSM210 at 142 degrees by its odometry, just switched to the position loop, is at 0 degrees of its setpoints: a run
/// that ramps to 0 from there would turn it at once.
#[test]
fn a_position_run_does_not_start_at_an_angle_of_the_odometry() {
    let text = r#"{ "motorlink_sequence": 1, "steps": [
        { "degrees": 0, "shape": "ramp", "for_s": 20 }] }"#;
    let plan = Plan::new(&Sequence::from_json(text).unwrap(), &Fleet::of([ONE])).unwrap();
    let now = Instant::from_millis(1_000);
    let mut runner = Runner::arm(plan, Options::default(), now);
    let odometry = Telemetry {
        id: ONE,
        at: now,
        mode: Mode::Position,
        rpm: Some(0),
        current: None,
        degrees: Some(142.0),
        celsius: None,
        faults: Faults::NONE,
    };
    assert_eq!(runner.start(now), Err(StartRefusal::NotAnswering(ONE)));
    let degrees = None;
    runner.telemetry(Telemetry {
        degrees,
        ..odometry
    });
    assert_eq!(runner.start(now), Err(StartRefusal::NoAngle(ONE)));
    runner.telemetry(odometry);
    assert_eq!(runner.start(now), Err(StartRefusal::OtherAngle(ONE)));
    let current = Some(Current::from_raw(0));
    runner.telemetry(Telemetry {
        current,
        ..odometry
    });
    assert_eq!(runner.start(now), Ok(()), "of a DDSM115");
}
