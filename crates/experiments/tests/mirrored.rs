//! Motors that are mounted mirrored: the frames have the opposite sign, the sequence and the record do not.

use crate::run_fixture::{ONE, ms, two};
use motorlink_experiments::{
    plan::{Fleet, Plan},
    runner::{Options, Runner, Telemetry, Tick},
    sequence::Sequence,
};
use motorlink_protocol::{Current, Faults, Instant, Mode, Setpoint};

#[test]
fn one_step_turns_both_wheels_of_a_vehicle_forward() {
    let text = r#"{ "motorlink_sequence": 1, "steps": [
        { "rpm": 100, "shape": "ramp", "for_s": 1 }, { "rpm": 100, "for_s": 1 }] }"#;
    let fleet = Fleet {
        mirrored: vec![two()],
        ..Fleet::of([ONE, two()])
    };
    let plan = Plan::new(&Sequence::from_json(text).unwrap(), &fleet).unwrap();
    let mut now = Instant::from_millis(1_000);
    let mut runner = Runner::arm(plan, Options::default(), now);
    let reply = |at, id, rpm, amps| Telemetry {
        id,
        at,
        mode: Mode::Velocity,
        rpm: Some(rpm),
        current: Some(Current::from_amps(amps)),
        // It falls at positive speed.
        degrees: Some(if rpm < 0 { 60.0 } else { 300.0 }),
        celsius: None,
        faults: Faults::NONE,
    };
    runner.telemetry(reply(now, ONE, 0, 0.0));
    runner.telemetry(reply(now, two(), 0, 0.0));
    runner.start(now).unwrap();
    let mut last = Vec::new();
    for _ in 0..300 {
        if let Tick::Drive { setpoints, .. } = runner.tick(now) {
            for (id, setpoint) in &setpoints {
                runner.sent(now, *id, *setpoint);
            }
            last = setpoints;
        }
        now = now + ms(5);
        runner.telemetry(reply(now, ONE, 99, 0.5));
        runner.telemetry(reply(now, two(), -99, -0.5));
    }
    let rpm = |setpoint: &Setpoint| match setpoint {
        Setpoint::Velocity { speed, .. } => speed.rpm(),
        other => panic!("{other:?}"),
    };
    let on_the_wire: Vec<i16> = last.iter().map(|(_, setpoint)| rpm(setpoint)).collect();
    assert_eq!(on_the_wire, [100, -100]);
    let record = runner.record();
    assert!(record.samples().iter().all(|sample| sample.rpm == Some(99)));
    let amps = Current::from_amps(0.5);
    assert!(
        record
            .samples()
            .iter()
            .all(|sample| sample.current == Some(amps))
    );
    assert!(
        record
            .samples()
            .iter()
            .all(|sample| sample.degrees == Some(300.0))
    );
    let of_both = [ONE, two()].map(|id| {
        let mut sent = record.sent_setpoints().iter().rev();
        rpm(&sent.find(|sent| sent.id == id).unwrap().setpoint)
    });
    assert_eq!(of_both, [100, 100]);
}

#[test]
fn a_position_run_has_the_motors_own_signs() {
    let text = r#"{ "motorlink_sequence": 1, "steps": [{ "degrees": 90, "for_s": 1 }] }"#;
    let fleet = Fleet {
        mirrored: vec![ONE],
        ..Fleet::of([ONE])
    };
    let plan = Plan::new(&Sequence::from_json(text).unwrap(), &fleet).unwrap();
    let now = Instant::from_millis(1_000);
    let mut runner = Runner::arm(plan, Options::default(), now);
    let reply = Telemetry {
        id: ONE,
        at: now,
        mode: Mode::Position,
        rpm: Some(-9),
        current: Some(Current::from_raw(0)),
        degrees: Some(80.0),
        celsius: None,
        faults: Faults::NONE,
    };
    runner.telemetry(reply);
    runner.start(now).unwrap();
    runner.telemetry(reply);
    let sample = runner.record().samples()[0];
    assert_eq!((sample.rpm, sample.degrees), (Some(-9), Some(80.0)));
}
