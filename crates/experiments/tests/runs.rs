//! Runs over virtual time: what is sent when.

use std::time::Duration;

use crate::run_fixture::{Fixture, ONE, ms, two};
use motorlink_experiments::runner::{Cause, End, Options, Phase, Tick};
use motorlink_protocol::{Mode, Setpoint};

#[test]
fn steps_follow_each_other_and_the_run_stops_at_the_end() {
    let mut fixture = Fixture::started(
        r#"{ "rpm": 50, "for_s": 1 }, { "rpm": 80, "motor": 1, "for_s": 1 }, { "brake": true, "for_s": 0.5 }"#,
    );
    fixture.run(ms(500));
    assert_eq!((fixture.last_rpm(ONE), fixture.last_rpm(two())), (50, 50));
    fixture.run(ms(1_000));
    assert_eq!((fixture.last_rpm(ONE), fixture.last_rpm(two())), (80, 50));
    fixture.run(ms(700));
    assert_eq!(fixture.sent.last().unwrap().2, Setpoint::Brake);
    fixture.run(ms(500));
    assert!(matches!(
        fixture.runner.phase(),
        Phase::Ended(End::Finished { .. })
    ));
    assert_eq!(fixture.stops.len(), 1);
    assert_eq!(fixture.runner.record().marks().len(), 3);
}

#[test]
fn setpoints_keep_their_times_for_a_minute_however_late_the_ticks_are() {
    let steps = r#"{ "rpm": 0, "shape": "triangle", "amplitude": 100, "hz": 0.5, "for_s": 60 }"#;
    let mut fixture = Fixture::started(steps);
    let began = fixture.now;
    let mut random = fastrand::Rng::with_seed(7);
    let (mut ticks, mut late_most) = (0_u32, Duration::ZERO);
    while let Tick::Drive { setpoints, next } = fixture.runner.tick(fixture.now) {
        let t_s = fixture.now.since(began).as_secs_f64();
        let turn = (0.5 * t_s + 0.25).rem_euclid(1.0);
        let expected = 100.0 * (1.0 - 4.0 * (turn - 0.5).abs());
        let (_, Setpoint::Velocity { speed, .. }) = setpoints[0] else {
            panic!("no speed");
        };
        assert!((f64::from(speed.rpm()) - expected).abs() <= 0.51, "{t_s}");
        // The grid is that of the plan, whatever the lateness was.
        assert_eq!(next.since(began).as_micros() % 5_000, 0);
        late_most = late_most.max(fixture.now.since(began).saturating_sub(ms(5) * ticks));
        ticks += 1;
        fixture.now = next + Duration::from_micros(random.u64(0..3_000));
        fixture.reply();
    }
    assert_eq!(ticks, 12_000, "200 a second for 60 s");
    assert!(late_most < ms(3), "no drift: {late_most:?}");
}

#[test]
fn a_loop_ends_after_its_passes_or_by_its_condition() {
    let steps = r#"{ "repeat": 100, "until": { "celsius_above": 50 },
                     "steps": [{ "rpm": 10, "for_s": 0.1 }, { "rpm": -10, "for_s": 0.1 }] }"#;
    let mut fixture = Fixture::started(steps);
    fixture.run(ms(1_050));
    assert_eq!(fixture.runner.phase(), Phase::Running);
    fixture.celsius = 55;
    fixture.run(ms(300));
    assert!(matches!(
        fixture.runner.phase(),
        Phase::Ended(End::Finished { .. })
    ));
    let mut fixture = Fixture::started(&steps.replace("100", "3"));
    fixture.run(ms(700));
    assert_eq!(fixture.runner.record().marks().len(), 6);
    assert!(matches!(
        fixture.runner.phase(),
        Phase::Ended(End::Finished { .. })
    ));
}

#[test]
fn a_wait_goes_on_when_it_holds_for_every_motor_and_ends_the_run_otherwise() {
    let steps =
        r#"{ "rpm": 90, "until": { "rpm_above": 85 }, "within_s": 2 }, { "rpm": 10, "for_s": 9 }"#;
    let mut fixture = Fixture::started(steps);
    fixture.run(ms(1_000));
    fixture.rpm = 88;
    fixture.run(ms(50));
    assert_eq!(fixture.last_rpm(ONE), 10);
    let mut fixture = Fixture::started(steps);
    fixture.run(ms(2_100));
    let Phase::Ended(End::Aborted { cause, .. }) = fixture.runner.phase() else {
        panic!("it waits on");
    };
    assert_eq!(cause, Cause::WaitTimedOut { step: 0 });
    assert_eq!(fixture.runner.plan().place(0), "steps[0]");
}

#[test]
fn a_pause_holds_the_wheel_and_the_plan_goes_on_where_it_was() {
    let mut fixture = Fixture::started(r#"{ "rpm": 100, "shape": "ramp", "for_s": 10 }"#);
    fixture.run(ms(4_000));
    fixture.runner.pause(fixture.now);
    fixture.run(ms(3_000));
    assert_eq!(fixture.last_rpm(ONE), 0);
    fixture.runner.resume(fixture.now);
    fixture.tick();
    assert_eq!(fixture.last_rpm(ONE), 40);
    fixture.run(ms(5_900));
    assert_eq!(fixture.runner.phase(), Phase::Running);
    fixture.runner.pause(fixture.now);
    fixture.run(ms(600_100));
    assert!(matches!(
        fixture.runner.phase(),
        Phase::Ended(End::Aborted {
            cause: Cause::PausedTooLong,
            ..
        })
    ));
}

#[test]
fn a_position_run_begins_at_the_angle_that_the_wheel_has() {
    let steps = r#"{ "degrees": 180, "motor": 1, "shape": "ramp", "for_s": 2 }"#;
    let mut fixture = Fixture::armed(steps, Options::default());
    fixture.mode = Mode::Position;
    fixture.reply();
    fixture.runner.start(fixture.now).unwrap();
    fixture.run(ms(1_005));
    let (_, _, Setpoint::Position(half)) = fixture.sent.last().unwrap() else {
        panic!("no angle");
    };
    assert!((half.degrees() - 135.0).abs() < 0.5, "{half}");
}
