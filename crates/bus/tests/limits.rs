//! Limits that a person sets: crossing one stops the motor, and the reason is told.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test fails by panicking, in its helpers too"
)]

mod bench;

use bench::{Bench, ID, Sent, amps, degrees, id, ms, rpm};
use motorlink_bus::{
    Activity, Command, Consent, Crossed, Event, Limits, RawInterval, Refusal, Repeat, Together,
    WithdrawReason,
};
use motorlink_protocol::{Mode, Request};
use motorlink_simulator::WorldConfig;

fn limited(speed_rpm: u16, current_ma: u16, temperature_c: u16) -> Bench {
    let mut bench = Bench::one_motor();
    let limits = Limits::new(speed_rpm, current_ma, temperature_c).unwrap();
    bench.command(Command::SetLimits(limits)).unwrap();
    bench
}

/// The limit that the motor was stopped for.
fn crossed(bench: &Bench) -> Option<Crossed> {
    bench.events.iter().find_map(|(_, event)| match event {
        Event::Withdrawn {
            id: ID,
            reason: WithdrawReason::Limit(crossed),
        } => Some(*crossed),
        _ => None,
    })
}

fn heat(bench: &mut Bench, steps_c: &[u8]) {
    for celsius in steps_c {
        let motor = bench.world.motor_mut(ID).unwrap();
        motor.set_temperature_c((*celsius).into());
        bench.run(ms(400));
    }
}

/// It was stopped for a limit, stands, and is driven by nobody.
fn assert_stopped_for_good(bench: &mut Bench) {
    bench.run(ms(3_500));
    assert!(bench.true_rpm().abs() < 1.0);
    assert_eq!(bench.status(ID).activity, Activity::Idle);
    bench.forget_the_past();
    bench.run(ms(2_000));
    assert!(bench.sent.iter().all(Sent::is_query));
}

#[test]
fn a_wheel_that_runs_away_in_the_current_loop_is_stopped_at_its_speed_limit() {
    let mut bench = limited(60, 2_700, 75);
    bench.switch(Mode::Current);
    bench.drive(amps(0.4)).unwrap();
    bench.run_until(ms(2_000), |bench| crossed(bench).is_some());
    assert!(matches!(
        crossed(&bench),
        Some(Crossed::Speed { limit: 60, .. })
    ));
    // Unloaded it gains some 50 rpm in a drive period, and its report lags; it would reach 200.
    let fastest = bench.true_rpm().abs();
    assert!(fastest < 150.0, "{fastest} rpm when it was stopped");
    assert_stopped_for_good(&mut bench);
}

#[test]
fn a_wheel_at_its_speed_limit_goes_on() {
    let mut bench = limited(100, 2_700, 75);
    bench.drive(rpm(-100)).unwrap();
    bench.run(ms(3_000));
    assert_eq!(crossed(&bench), None);
    assert!((bench.true_rpm() + 100.0).abs() < 3.0);
}

#[test]
fn more_than_the_speed_limit_is_not_asked_for_alone_or_together_or_by_a_slider() {
    let mut bench = limited(100, 2_700, 75);
    let above = Err(Refusal::AboveSpeedLimit(100));
    assert_eq!(bench.drive(rpm(101)), above);
    let parts = Together::new(&[(ID, rpm(-101))]).unwrap();
    let consent = Consent::None;
    let together = Command::DriveTogether { parts, consent };
    assert_eq!(bench.command(together), above);
    bench.drive(rpm(100)).unwrap();
    let setpoint = rpm(150);
    let adjust = Command::Adjust {
        id: ID,
        setpoint,
        consent,
    };
    assert_eq!(bench.command(adjust), above);
    bench.run(ms(1_000));
    assert!(
        (bench.true_rpm() - 100.0).abs() < 3.0,
        "as it was asked before"
    );
}

#[test]
fn a_limit_that_is_lowered_below_what_turns_stops_it() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(150)).unwrap();
    bench.run(ms(1_500));
    let limits = Limits::new(100, 2_700, 75).unwrap();
    bench.command(Command::SetLimits(limits)).unwrap();
    bench.run(ms(100));
    assert!(matches!(
        crossed(&bench),
        Some(Crossed::Speed { limit: 100, .. })
    ));
    assert_stopped_for_good(&mut bench);
}

#[test]
fn a_current_above_its_limit_stops_after_half_a_second_and_not_before() {
    let mut bench = limited(330, 1_000, 75);
    bench.drive(rpm(60)).unwrap();
    bench.run(ms(1_000));
    assert_eq!(crossed(&bench), None, "what a start takes is let pass");
    bench.world.motor_mut(ID).unwrap().set_load_nm(1.2);
    let overloaded = |bench: &Bench| bench.status(ID).last.unwrap().reply.current.amps() > 1.0;
    bench.run_until(ms(500), overloaded);
    bench.run(ms(400));
    assert_eq!(crossed(&bench), None);
    bench.run(ms(150));
    assert!(matches!(
        crossed(&bench),
        Some(Crossed::Current { limit: 1_000, .. })
    ));
    bench.world.motor_mut(ID).unwrap().set_load_nm(0.0);
    assert_stopped_for_good(&mut bench);
}

#[test]
fn a_hot_motor_is_stopped_before_it_protects_itself_and_not_started_before_it_is_cooler() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(60)).unwrap();
    bench.run(ms(500));
    heat(&mut bench, &[72, 74, 76]);
    assert!(matches!(
        crossed(&bench),
        Some(Crossed::Temperature { limit: 75, .. })
    ));
    assert_stopped_for_good(&mut bench);
    heat(&mut bench, &[77, 77]);
    assert!(matches!(
        bench.drive(rpm(60)),
        Err(Refusal::TooHot { id: ID, .. })
    ));
    heat(&mut bench, &[73, 71]);
    bench.drive(rpm(60)).unwrap();
}

#[test]
fn the_other_motors_of_a_group_stop_too() {
    let config = WorldConfig::with_ids([ID, id(2)]);
    let mut bench = Bench::watching(config, &[ID, id(2)]);
    let limits = Limits::new(330, 1_000, 75).unwrap();
    bench.command(Command::SetLimits(limits)).unwrap();
    let parts = Together::new(&[(ID, rpm(60)), (id(2), rpm(60))]).unwrap();
    let consent = Consent::None;
    bench
        .command(Command::DriveTogether { parts, consent })
        .unwrap();
    bench.run(ms(1_000));
    bench.world.motor_mut(ID).unwrap().set_load_nm(1.2);
    bench.run(ms(3_000));
    assert!(matches!(crossed(&bench), Some(Crossed::Current { .. })));
    assert_eq!(bench.status(id(2)).activity, Activity::Idle);
}

#[test]
fn raw_frames_are_held_to_the_limits_as_any_driving_is() {
    let interval = RawInterval::new(20).unwrap();
    let consent = Consent::None;
    let send = |setpoint| Command::SendRaw {
        frame: Request::drive(ID, setpoint).frame(),
        repeat: Repeat::Times { count: 0, interval },
        consent,
    };
    let mut bench = limited(50, 2_700, 75);
    assert_eq!(
        bench.command(send(rpm(100))),
        Err(Refusal::AboveSpeedLimit(50))
    );
    bench.switch(Mode::Current);
    bench.command(send(amps(0.4))).unwrap();
    bench.run(ms(2_000));
    assert!(matches!(
        crossed(&bench),
        Some(Crossed::Speed { limit: 50, .. })
    ));
    assert_stopped_for_good(&mut bench);
    heat(&mut bench, &[72, 74, 76]);
    assert!(matches!(
        bench.command(send(rpm(10))),
        Err(Refusal::TooHot { id: ID, .. })
    ));
}

#[test]
fn an_angle_is_gone_to_within_the_limits() {
    let mut bench = Bench::one_motor();
    bench.switch(Mode::Position);
    bench.drive(degrees(180.0)).unwrap();
    bench.run(ms(2_000));
    assert_eq!(crossed(&bench), None);
}

#[test]
fn a_speed_limit_that_is_set_below_what_is_driven_stops_it_before_the_next_frame() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(1_000));
    bench.forget_the_past();
    let limits = Limits::new(60, 2_700, 75).unwrap();
    bench.command(Command::SetLimits(limits)).unwrap();
    bench.run(ms(1_000));
    let fast = |sent: &Sent| sent.drive_of(ID).is_some_and(|drive| drive.signed() > 60);
    assert!(!bench.sent.iter().any(fast));
    assert!(bench.happened(|event| matches!(
        event,
        Event::Withdrawn {
            reason: WithdrawReason::Limit(Crossed::Speed { limit: 60, .. }),
            ..
        }
    )));
    assert!(bench.true_rpm().abs() < 1.0);
}
