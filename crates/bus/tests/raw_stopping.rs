//! What ends raw frames: stops, a silent page, and the reasons that withdraw any setpoint.

use crate::fixture::{Fixture, ID, amps, drive_frame, every, id, ms, raw, rpm, status};
use motorlink_bus::{
    Activity, Command, Event, RawAnswer, Refusal, Repeat, StopReason, WithdrawReason,
};
use motorlink_protocol::{Frame, Mode, Request};
use motorlink_simulator::{WireFaults, WorldConfig};

fn drive_100() -> Frame {
    drive_frame(ID, rpm(100))
}

fn switch_frame(mode: Mode) -> Frame {
    Request::SwitchMode { id: ID, mode }.frame()
}

fn times_sent(fixture: &Fixture, frame: Frame) -> usize {
    let sent = fixture.sent.iter().filter(|sent| sent.frame == frame);
    sent.count()
}

fn withdrawn(fixture: &Fixture) -> Option<WithdrawReason> {
    fixture.events.iter().find_map(|(_, event)| match event {
        Event::Withdrawn { reason, .. } => Some(*reason),
        _ => None,
    })
}

/// A wheel at 100 rpm, driven by raw frames until they are stopped.
fn driven_by_raw_frames() -> Fixture {
    let mut fixture = Fixture::one_motor();
    fixture.command(raw(drive_100(), every(0, 20))).unwrap();
    fixture.run(ms(1_000));
    assert!(fixture.true_rpm() > 90.0, "{}", fixture.true_rpm());
    assert!(status(&fixture).running);
    fixture.forget_the_past();
    fixture
}

/// A wheel that still turns after the last of 50 raw frames.
fn coasting_after_raw_frames() -> Fixture {
    let mut fixture = Fixture::one_motor();
    fixture.command(raw(drive_100(), every(50, 20))).unwrap();
    fixture.run(ms(1_050));
    assert!(!status(&fixture).running, "all were sent");
    assert!(fixture.true_rpm() > 50.0, "{}", fixture.true_rpm());
    fixture
}

#[test]
fn wheel_driven_by_raw_frames_is_braked_by_every_stop() {
    let stops = [
        Command::StopAll(StopReason::Operator),
        Command::StopAll(StopReason::PageGone),
        Command::Stop(ID),
        Command::StopRaw,
        Command::FullScan,
    ];
    for stop in stops {
        let mut fixture = driven_by_raw_frames();
        assert!(fixture.bus.is_active(fixture.now));
        assert_eq!(fixture.activity(), Activity::DrivenRaw);
        fixture.command(stop).unwrap();
        assert!(!status(&fixture).running);
        fixture.run(ms(500));
        assert_eq!(times_sent(&fixture, drive_100()), 0, "{stop:?}");
        let rpm = fixture.true_rpm();
        assert!(rpm.abs() < 1.0, "{stop:?}: {rpm} rpm, it coasts");
    }
}

#[test]
fn wheel_coasting_after_raw_frames_is_braked_by_every_stop() {
    let stops = [
        Command::StopAll(StopReason::Operator),
        Command::StopRaw,
        Command::FullScan,
    ];
    for stop in stops {
        let mut fixture = coasting_after_raw_frames();
        assert!(fixture.bus.is_active(fixture.now), "the port stays open");
        fixture.command(stop).unwrap();
        fixture.run(ms(500));
        let rpm = fixture.true_rpm();
        assert!(rpm.abs() < 1.0, "{stop:?}: {rpm} rpm");
    }
}

#[test]
fn silent_page_stops_raw_frames() {
    let mut fixture = driven_by_raw_frames();
    fixture.page_lives = false;
    fixture.run(ms(1_500));
    assert!(fixture.bus.is_halted() && !status(&fixture).running);
    assert!(fixture.true_rpm().abs() < 1.0);
}

#[test]
fn raw_query_during_raw_driving_is_refused_and_the_wheel_keeps_its_speed() {
    let mut fixture = driven_by_raw_frames();
    let query = Request::Query { id: ID }.frame();
    let refused = fixture.command(raw(query, Repeat::Once));
    assert_eq!(refused, Err(Refusal::RawRunning));
    fixture.run(ms(800));
    assert!(status(&fixture).running);
    assert!(fixture.true_rpm() > 90.0, "{}", fixture.true_rpm());
}

#[test]
fn raw_current_during_another_is_refused_and_the_first_continues() {
    let mut fixture = Fixture::one_motor();
    fixture.switch(Mode::Current);
    let forward = drive_frame(ID, amps(2.0));
    fixture.command(raw(forward, every(0, 20))).unwrap();
    fixture.run(ms(100));
    fixture.forget_the_past();
    let refused = fixture.command(raw(drive_frame(ID, amps(-2.0)), every(0, 20)));
    assert_eq!(refused, Err(Refusal::RawRunning));
    fixture.run(ms(60));
    let drives = fixture
        .sent
        .iter()
        .filter(|sent| sent.drive_of(ID).is_some());
    let frames: Vec<Frame> = drives.map(|sent| sent.frame).collect();
    assert!(frames.len() >= 2, "{frames:?}");
    assert!(frames.iter().all(|frame| *frame == forward), "{frames:?}");
}

#[test]
fn raw_frames_are_withdrawn_for_the_reasons_of_any_setpoint() {
    let mut silent = driven_by_raw_frames();
    silent.world.set_faults(WireFaults {
        lose_reply: 1.0,
        ..WireFaults::default()
    });
    silent.run(ms(500));
    assert_eq!(withdrawn(&silent), Some(WithdrawReason::Silent));
    assert!(!status(&silent).running);

    let mut hot = driven_by_raw_frames();
    hot.world.motor_mut(ID).unwrap().set_temperature_c(90.0);
    hot.run(ms(500));
    assert!(matches!(withdrawn(&hot), Some(WithdrawReason::Fault(_))));
    assert!(!status(&hot).running);
}

/// A raw current of 2,000 would be a speed to a motor that lost power and came back.
#[test]
fn raw_currents_end_when_the_motor_restarts_in_the_velocity_loop() {
    for loop_is_known in [true, false] {
        let mut fixture = Fixture::one_motor();
        if loop_is_known {
            fixture.switch(Mode::Current);
        } else {
            let switch = switch_frame(Mode::Current);
            fixture.command(raw(switch, every(5, 20))).unwrap();
            fixture.run_until(ms(300), |fixture| status(fixture).sent == 5);
        }
        let current = drive_frame(ID, amps(0.05));
        fixture.command(raw(current, every(0, 20))).unwrap();
        fixture.run(ms(300));
        assert!(status(&fixture).running, "loop known: {loop_is_known}");
        fixture.world.motor_mut(ID).unwrap().power(false);
        fixture.run(ms(100));
        fixture.world.motor_mut(ID).unwrap().power(true);
        fixture.run(ms(2_000));
        let motor = fixture.world.motor(ID).unwrap();
        assert_eq!(motor.mode(), Mode::Velocity);
        assert!(!status(&fixture).running, "loop known: {loop_is_known}");
        assert!(fixture.true_rpm().abs() < 1.0);
    }
}

#[test]
fn raw_frames_to_a_motor_without_power_are_withdrawn_and_do_not_start_it_later() {
    let mut fixture = Fixture::new(WorldConfig::default());
    fixture.world.motor_mut(ID).unwrap().power(false);
    fixture.command(raw(drive_100(), every(0, 20))).unwrap();
    fixture.run(ms(60_000));
    assert!(times_sent(&fixture, drive_100()) > 0);
    assert_eq!(withdrawn(&fixture), Some(WithdrawReason::Silent));
    assert!(!status(&fixture).running);
    fixture.world.motor_mut(ID).unwrap().power(true);
    fixture.run(ms(1_000));
    assert!(fixture.true_rpm().abs() < 1.0, "{}", fixture.true_rpm());
}

/// Byte 8 is reserved; a firmware may ignore it.
#[test]
fn stop_after_a_malformed_switch_to_the_position_loop_switches_back_first() {
    let switch: Frame = "01 A0 00 00 00 00 00 00 01 03".parse().unwrap();
    let mut fixture = Fixture::one_motor();
    fixture.command(raw(switch, every(5, 20))).unwrap();
    fixture.run_until(ms(300), |fixture| status(fixture).sent == 5);
    fixture.forget_the_past();
    fixture.command(Command::Stop(ID)).unwrap();
    fixture.run(ms(10));
    assert_eq!(fixture.sent[0].frame, switch_frame(Mode::Velocity));
}

#[test]
fn silent_motor_can_be_forgotten_after_a_raw_frame() {
    let mut fixture = Fixture::one_motor();
    let frame = drive_frame(id(9), rpm(10));
    fixture.command(raw(frame, Repeat::Once)).unwrap();
    fixture.run(ms(3_000));
    assert!(matches!(
        status(&fixture).last,
        Some(RawAnswer::Silence { .. })
    ));
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    fixture.run(ms(4_000));
    assert_eq!(fixture.command(Command::Forget(id(9))), Ok(()));
    let left: Vec<_> = fixture
        .bus
        .motors(fixture.now)
        .map(|motor| motor.id)
        .collect();
    assert_eq!(left, [ID]);
}
