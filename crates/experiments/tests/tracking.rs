//! How well a motor follows its setpoints, and at which rate it got them.

use std::time::Duration;

use crate::{
    bench::{Bench, ONE, header},
    run_fixture::Fixture,
};
use motorlink_experiments::{
    analysis::{setpoint_rate, tracking},
    kept::figures_to_csv,
    runner::Options,
    sequence::{Quantity, Sequence},
    study::{Findings, Study},
};
use motorlink_protocol::{Mode, Setpoint};
use motorlink_simulator::MotorConfig;

/// A motor that reports 40 rpm for setpoints of 50, then 70, then a brake.
#[test]
fn errors_are_setpoint_less_report_and_a_brake_has_none() {
    let mut fixture = Fixture::started(
        r#"{ "rpm": 50, "for_s": 1 }, { "rpm": 70, "for_s": 1 }, { "brake": true, "for_s": 1 }"#,
    );
    fixture.rpm = 40;
    fixture.follow();
    let found = tracking(fixture.runner.record(), ONE, Duration::ZERO).unwrap();
    assert_eq!(found.quantity, Quantity::Rpm);
    assert!((found.worst - 30.0).abs() < 1e-9, "{found:?}");
    assert!((found.worst_s - 1.0).abs() < 0.011, "{found:?}");
    // Half of the replies are off by 10, half by 30.
    assert!((found.rms - 500.0_f64.sqrt()).abs() < 0.2, "{found:?}");
    assert!((390..=410).contains(&found.replies), "{found:?}");
    let mut sent = fixture.runner.record().sent_setpoints().iter();
    assert!(sent.any(|it| it.setpoint == Setpoint::Brake));
}

#[test]
fn an_angle_is_off_by_the_short_way_round() {
    let mut fixture = Fixture::armed(r#"{ "degrees": 300, "for_s": 1 }"#, Options::default());
    fixture.mode = Mode::Position;
    fixture.reply();
    fixture.runner.start(fixture.now).unwrap();
    fixture.follow();
    let found = tracking(fixture.runner.record(), ONE, Duration::ZERO).unwrap();
    assert_eq!(found.quantity, Quantity::Degrees);
    // The motors of the fixture report 90 degrees.
    assert!((found.worst + 150.0).abs() < 0.1, "{found:?}");
    assert!((found.rms - 150.0).abs() < 0.1, "{found:?}");
}

#[test]
fn the_figures_of_a_sequence_have_a_row_for_each_motor() {
    let text = r#"{ "motorlink_sequence": 1, "steps": [
        { "rpm": 60, "shape": "sine", "amplitude": 30, "hz": 0.5, "for_s": 4 }] }"#;
    let study = Study::Sequence(Sequence::from_json(text).unwrap());
    let mut bench = Bench::new(5, MotorConfig::default());
    bench.run_sequence(&study.sequence());
    let header = header(&study, &bench.record);
    let found = study.evaluate(&bench.record, &header.measured());
    let table = figures_to_csv(&header, &study, &found);
    assert_eq!(
        table.lines().next().unwrap(),
        "model,run,began_unix_ms,request_hz,motor,setpoint_unit,replies,rms_error,worst_error,worst_s"
    );
    assert_eq!(table.lines().count(), 2);
    let Findings::Sequence(motors) = found else {
        panic!("no sequence");
    };
    let rms = motors[0].tracking.unwrap().rms;
    assert!(table.contains(&format!(
        ",rpm,{},{},",
        motors[0].tracking.unwrap().replies,
        (rms * 1e6).round() / 1e6
    )));
}

#[test]
fn the_achieved_rate_and_the_lost_replies_are_those_of_the_line() {
    for lose in [0.0, 0.02, 0.1] {
        let mut bench = Bench::losing(3, MotorConfig::default(), lose);
        bench.run(r#"{ "rpm": 60, "for_s": 20 }"#);
        let found = setpoint_rate(&bench.record, ONE, 200.0).unwrap();
        assert!((found.achieved_hz / 200.0 - 1.0).abs() < 0.01, "{found:?}");
        // One setpoint of 200 is a query instead.
        assert!(
            (found.lost - lose - 0.005).abs() < 0.012,
            "{lose}: {found:?}"
        );
    }
}
