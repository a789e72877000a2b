//! When the bus enables a DDSM400, which obeys no drive frame before.

use std::time::Duration;

use motorlink_bus::{Activity, Bus, Command, Event, Refusal};
use motorlink_protocol::{Mode, PositionTarget, Setpoint, family::Model};
use motorlink_simulator::WorldConfig;

use crate::fixture::{Fixture, ID, drive_frame, ms, rpm};

fn with(bus: impl FnOnce(Bus) -> Bus) -> Fixture {
    let mut fixture = Fixture::new(WorldConfig::of(Model::Ddsm400, [ID]));
    fixture.bus = bus(Bus::with_model(fixture.now, Model::Ddsm400));
    fixture.command(Command::Watch(ID)).unwrap();
    fixture
}

/// Whether the bus sent a frame that enables a motor or switches its loop.
fn changes_a_motor(fixture: &Fixture) -> bool {
    let mut sent = fixture.sent.iter();
    sent.any(|sent| matches!(sent.frame.bytes(), [_, 0xA0, ..]))
}

fn drives_a_motor(fixture: &Fixture) -> bool {
    let mut sent = fixture.sent.iter();
    sent.any(|sent| matches!(sent.frame.bytes(), [1, 0x64, ..]))
}

fn answers(fixture: &Fixture) -> bool {
    fixture.status(ID).counters.replies > 0
}

fn is_enabled(fixture: &Fixture) -> bool {
    fixture.world.motor(ID).unwrap().active_mode().is_some()
}

/// Another host drives the motor to 180 degrees for this long. In the velocity loop that would be 1,638 rpm.
fn another_host_drives(fixture: &mut Fixture, duration: Duration) {
    let half = Setpoint::Position(PositionTarget::from_degrees(180.0));
    let end = fixture.now + duration;
    while fixture.now < end {
        fixture.run(ms(20));
        let frame = drive_frame(ID, half);
        fixture.bus.receive(fixture.now, frame.bytes());
    }
}

#[test]
fn a_ddsm400_is_enabled_after_the_trial_of_its_port_and_not_before() {
    let mut fixture = with(Bus::on_trial);
    fixture.run(ms(3_000));
    assert!(answers(&fixture) && !is_enabled(&fixture));
    assert!(!changes_a_motor(&fixture), "on trial");
    let now = fixture.now;
    fixture.bus.end_trial(now);
    fixture.run(ms(90));
    assert!(!changes_a_motor(&fixture), "it listens first");
    fixture.run(ms(500));
    assert!(is_enabled(&fixture));
    assert!(!drives_a_motor(&fixture), "enabling moves nothing");
}

#[test]
fn a_ddsm400_is_not_enabled_while_another_host_drives() {
    let mut fixture = with(Bus::on_trial);
    another_host_drives(&mut fixture, ms(500));
    let now = fixture.now;
    fixture.bus.end_trial(now);
    another_host_drives(&mut fixture, ms(3_000));
    assert!(answers(&fixture));
    assert!(!changes_a_motor(&fixture));
    fixture.run(ms(900));
    assert!(!changes_a_motor(&fixture), "it may be in a pause");
    fixture.run(ms(600));
    assert!(is_enabled(&fixture));
}

/// The notice of a motor that lost power says: press Start.
#[test]
fn start_enables_a_ddsm400_and_then_drives_it() {
    let mut fixture = with(|bus| bus);
    another_host_drives(&mut fixture, ms(1_000));
    assert!(!is_enabled(&fixture));
    let half = Setpoint::Position(PositionTarget::from_degrees(180.0));
    assert_eq!(fixture.drive(half), Err(Refusal::NotAnswering(ID)));
    fixture.start(rpm(60)).unwrap();
    assert_eq!(
        fixture.activity(),
        Activity::Switching { to: Mode::Velocity }
    );
    fixture.run(ms(1_500));
    assert!((fixture.true_rpm() - 60.0).abs() < 3.0);
}

/// The motor does not obey: the bus drops the setpoint, and reports that the switch failed.
#[test]
fn a_ddsm400_that_cannot_be_enabled_is_reported() {
    let mut fixture = with(|bus| bus);
    fixture.run(ms(50));
    assert!(answers(&fixture));
    another_host_drives(&mut fixture, ms(200));
    fixture.start(rpm(60)).unwrap();
    fixture.world.motor_mut(ID).unwrap().mute(true);
    fixture.run(ms(1_000));
    let reported = |event: &Event| matches!(event, Event::ModeSwitchFailed { id: ID, .. });
    assert!(fixture.happened(reported), "{:?}", fixture.events);
    assert_eq!(fixture.activity(), Activity::Idle);
    fixture.world.motor_mut(ID).unwrap().mute(false);
    fixture.run(ms(3_000));
    assert!(fixture.true_rpm().abs() < 1.0);
}

/// After power-up a DDSM400 ignores drive frames until the bus enables it. Enabling starts no motion.
#[test]
fn a_ddsm400_is_enabled_again_after_a_power_cut_and_driven_only_when_asked() {
    let mut fixture = with(|bus| bus);
    fixture.run(ms(1_000));
    fixture.start(rpm(60)).unwrap();
    fixture.run(ms(1_000));
    fixture.world.motor_mut(ID).unwrap().power(false);
    fixture.run(ms(400));
    assert!(fixture.happened(|event| matches!(event, Event::Withdrawn { .. })));
    fixture.world.motor_mut(ID).unwrap().power(true);
    fixture.forget_the_past();
    fixture.run(ms(6_000));
    assert_eq!(fixture.activity(), Activity::Idle);
    assert!(is_enabled(&fixture));
    assert!(!fixture.happened(|event| matches!(event, Event::ModeSwitched { .. })));
    assert!(fixture.true_rpm().abs() < 1.0);
    fixture.start(rpm(60)).unwrap();
    fixture.run(ms(1_500));
    assert!((fixture.true_rpm().abs() - 60.0).abs() < 3.0);
}

/// The bus enables and switches it just when a person may press Start.
#[test]
fn start_at_any_time_around_the_enabling_of_a_ddsm400_drives_it() {
    for delay in 0..300 {
        let mut fixture = with(Bus::on_trial);
        fixture.run(ms(300));
        let now = fixture.now;
        fixture.bus.end_trial(now);
        fixture.run(ms(delay));
        assert_eq!(fixture.start(rpm(60)), Ok(()), "{delay} ms");
        fixture.run(ms(1_500));
        assert!((fixture.true_rpm() - 60.0).abs() < 3.0, "{delay} ms");
    }
}
