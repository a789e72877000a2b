//! Limits hold for what a person writes byte by byte to one motor.

use crate::fixture;
use crate::fixture::raw_commands::{ABOVE, limited, value, withdrawn};
use crate::fixture::{
    Fixture, ID, amps, drive_frame, every, id, is_set_id, ms, raw, rpm, scan_report, status, two,
};
use motorlink_bus::{Activity, BusSettings, Command, Limits, Refusal, Repeat, WithdrawReason};
use motorlink_protocol::{CurrentTarget, Frame, Mode, MotorId, Request, family::Model};
use motorlink_simulator::WorldConfig;

fn switch(motor: MotorId, mode: Mode) -> Command {
    raw(
        Request::SwitchMode { id: motor, mode }.frame(),
        every(5, 20),
    )
}

#[test]
fn a_raw_speed_above_the_limit_is_refused_however_large_it_is() {
    let refused = Err(Refusal::AboveSpeedLimit(20));
    for above in ABOVE {
        let mut fixture = Fixture::one_motor();
        limited(&mut fixture, 20);
        assert_eq!(fixture.command(value(1, above)), refused, "{above}");
        fixture.run(ms(200));
        assert!(fixture.true_rpm().abs() < 1.0);
        // Of one that has not answered, the loop is not known.
        assert_eq!(fixture.command(value(9, above)), refused, "{above} unknown");
    }
    for within in [20, -20] {
        let mut fixture = Fixture::one_motor();
        limited(&mut fixture, 20);
        assert_eq!(fixture.command(value(1, within)), Ok(()), "{within}");
    }
}

#[test]
fn a_raw_value_in_a_loop_without_a_speed_limit_is_sent() {
    for mode in [Mode::Current, Mode::Position] {
        let mut fixture = Fixture::one_motor();
        limited(&mut fixture, 20);
        fixture.switch(mode);
        assert_eq!(fixture.command(value(1, 5_000)), Ok(()), "{mode}");
    }
}

#[test]
fn a_raw_value_is_a_speed_while_the_loop_is_in_the_air() {
    let mut fixture = Fixture::one_motor();
    fixture.switch(Mode::Current);
    fixture.command(switch(ID, Mode::Velocity)).unwrap();
    fixture.run_until(ms(300), |fixture| fixture.bus.raw().unwrap().sent == 5);
    assert_eq!(
        fixture.command(value(1, 5_000)),
        Err(Refusal::AboveSpeedLimit(330))
    );
}

#[test]
fn a_limit_that_is_lowered_ends_raw_frames_above_it() {
    let mut fixture = Fixture::one_motor();
    fixture.command(value(1, 100)).unwrap();
    fixture.run(ms(500));
    fixture.forget_the_past();
    limited(&mut fixture, 95);
    fixture.run(ms(500));
    assert!(!status(&fixture).running);
    let drives = |sent: &fixture::Sent| sent.drive_of(ID).is_some_and(|drive| !drive.brakes());
    assert!(!fixture.sent.iter().any(drives));
    assert!(fixture.true_rpm().abs() < 1.0, "{}", fixture.true_rpm());
}

#[test]
fn an_id_that_no_scan_would_find_is_never_set() {
    for new in [0x00, 0xFF, 0xC8] {
        for last in [0x00, 0x01] {
            let mut fixture = Fixture::new(WorldConfig::default());
            assert_eq!(scan_report(&mut fixture).found, [ID]);
            let frame = Frame::new([0xAA, 0x55, 0x53, new, 0, 0, 0, 0, 0, last]);
            let refused = fixture.command(raw(frame, every(5, 20)));
            assert_eq!(refused, Err(Refusal::NotAssignable(new)));
            fixture.run(ms(500));
            assert!(!fixture.sent.iter().any(is_set_id));
            // The proof is not used up by it.
            let frame = Request::SetId { id: fixture::to(5) }.frame();
            assert_eq!(fixture.command(raw(frame, every(5, 20))), Ok(()));
        }
    }
}

#[test]
fn a_frame_for_one_motor_leaves_the_others_alone() {
    let mut fixture = two();
    fixture
        .command(raw(drive_frame(ID, rpm(100)), every(0, 20)))
        .unwrap();
    fixture.run(ms(300));
    fixture.world.motor_mut(id(2)).unwrap().mute(true);
    fixture.run(ms(700));
    assert!(status(&fixture).running);
    assert_eq!(fixture.status(id(2)).activity, Activity::Idle);
}

#[test]
fn a_raw_frame_does_not_reverse_a_current_that_may_be_followed() {
    let mut fixture = Fixture::one_motor();
    fixture.switch(Mode::Current);
    let frame = |value| drive_frame(ID, amps(value));
    fixture.command(raw(frame(1.0), Repeat::Once)).unwrap();
    fixture.run(ms(50));
    let reversed = fixture.command(raw(frame(-1.0), Repeat::Once));
    assert_eq!(reversed, Err(Refusal::ReversesTorque(ID)));
    fixture.command(raw(frame(0.0), Repeat::Once)).unwrap();
    fixture.run(ms(50));
    fixture.command(raw(frame(-1.0), Repeat::Once)).unwrap();
}

/// -32768 has no positive counterpart.
#[test]
fn lowest_raw_current_needs_consent() {
    let mut fixture = Fixture::one_motor();
    fixture.switch(Mode::Current);
    let lowest = CurrentTarget::new(CurrentTarget::MIN).unwrap();
    let refused = fixture.command(value(1, i16::MIN.into()));
    assert_eq!(refused, Err(Refusal::NeedsConsent(lowest)));
    assert_eq!(fixture.bus.raw(), None);
}

/// Full scale of a DDSM400 is 4 A, that of the bus 8 A.
#[test]
fn raw_current_of_a_ddsm400_is_asked_about_in_its_own_amps() {
    let mut fixture = Fixture::watching(WorldConfig::of(Model::Ddsm400, [ID]), &[ID]);
    fixture.run(ms(700));
    fixture.switch(Mode::Current);
    // 3.2 A, and 4 A is all there is.
    for within in [26_000, -26_000, 32_767, -32_768] {
        assert_eq!(fixture.command(value(1, within)), Ok(()), "{within}");
        fixture.command(Command::Stop(ID)).unwrap();
        fixture.run(ms(1_500));
        fixture.switch(Mode::Current);
    }
}

/// Byte 8 is reserved; a firmware may ignore it.
#[test]
fn malformed_drive_frame_with_a_high_current_needs_consent() {
    let mut fixture = Fixture::one_motor();
    fixture.switch(Mode::Current);
    let frame = Frame::with_crc([1, 0x64, 0x7F, 0xFF, 0, 0, 0, 0, 1]);
    let highest = CurrentTarget::new(CurrentTarget::MAX).unwrap();
    let refused = fixture.command(raw(frame, Repeat::Once));
    assert_eq!(refused, Err(Refusal::NeedsConsent(highest)));
    assert_eq!(fixture.bus.raw(), None);
}

/// Byte 8 is reserved; a firmware may ignore it.
#[test]
fn malformed_switch_to_the_position_loop_needs_a_slow_wheel() {
    let switch: Frame = "01 A0 00 00 00 00 00 00 01 03".parse().unwrap();
    let mut fixture = Fixture::one_motor();
    fixture
        .command(raw(drive_frame(ID, rpm(100)), every(40, 20)))
        .unwrap();
    fixture.run(ms(850));
    assert!(!status(&fixture).running);
    let refused = fixture.command(raw(switch, Repeat::Once));
    assert!(matches!(refused, Err(Refusal::TooFast(_))), "{refused:?}");
}

/// By its last byte it switches a DDSM115 to the position loop, which the motor refuses while it turns. By byte 2 it
/// disables a DDSM400.
#[test]
fn a_frame_that_disables_another_model_is_not_too_fast() {
    let mut fixture = Fixture::one_motor();
    fixture
        .command(raw(drive_frame(ID, rpm(100)), every(40, 20)))
        .unwrap();
    fixture.run(ms(850));
    assert!(fixture.true_rpm() > 50.0);
    let disable: Frame = "01 A0 09 00 00 00 00 00 00 03".parse().unwrap();
    let outcome = fixture.command(raw(disable, Repeat::Once));
    assert_eq!(outcome, Ok(()));
}

#[test]
fn refused_raw_frame_adds_no_motor_and_sends_nothing() {
    let mut fixture = Fixture::one_motor();
    let refused = fixture.command(raw(drive_frame(id(9), amps(7.0)), Repeat::Once));
    assert_eq!(refused, Err(Refusal::AboveSpeedLimit(330)));
    fixture.run(ms(300));
    assert_eq!(fixture.bus.motors(fixture.now).count(), 1);
    assert_eq!(fixture.bus.raw(), None);
    let to_nine = |sent: &fixture::Sent| sent.frame.bytes().starts_with(&[9]);
    assert!(!fixture.sent.iter().any(to_nine));
}

/// Between the drive replies of a DDSM210 come odometry replies, which tell no current.
#[test]
fn a_raw_overcurrent_of_separate_frames_is_stopped() {
    let mut fixture = Fixture::watching(WorldConfig::of(Model::Ddsm210, [ID]), &[ID]);
    let limits = Limits::new(210, 300, 75).unwrap();
    fixture
        .command(Command::Configure(BusSettings {
            limits,
            ..BusSettings::default()
        }))
        .unwrap();
    fixture.world.motor_mut(ID).unwrap().block(true);
    // 60 rpm.
    fixture.command(value(1, 600)).unwrap();
    fixture.run(ms(2_000));
    assert!(!status(&fixture).running);
    let reasons = withdrawn(&fixture);
    assert!(
        matches!(reasons[..], [(ID, WithdrawReason::Limit(_))]),
        "{reasons:?}"
    );
}
