//! Raw set-ID frames: the same proof and the same check as the command.

use crate::fixture::{Fixture, ID, every, id, is_set_id, ms, raw, scan_report, status, to};
use motorlink_bus::{Command, Refusal, Repeat, SetIdFrames, StopReason};
use motorlink_protocol::{Frame, Request};
use motorlink_simulator::{MotorConfig, WorldConfig};

fn set_id_frame() -> Frame {
    Request::SetId { id: to(5) }.frame()
}

/// A bus on which a full scan has just found motor 1 alone.
fn scanned() -> Fixture {
    let mut fixture = Fixture::new(WorldConfig::default());
    assert_eq!(scan_report(&mut fixture).found, [ID]);
    fixture
}

fn set_ids_sent(fixture: &Fixture) -> usize {
    fixture.sent.iter().filter(|sent| is_set_id(sent)).count()
}

fn ids(fixture: &Fixture) -> Vec<u8> {
    let motors = fixture.world.motors();
    motors.map(|motor| motor.id().get()).collect()
}

#[test]
fn raw_set_id_without_a_proof_is_refused() {
    let mut fixture = Fixture::one_motor();
    let set_id = raw(set_id_frame(), Repeat::Once);
    assert_eq!(fixture.command(set_id), Err(Refusal::NotProvedAlone));
    let mut fixture = scanned();
    fixture.command(set_id).unwrap();
    fixture.run(ms(100)); // after the ID query
    assert_eq!(set_ids_sent(&fixture), 1);
}

#[test]
fn raw_set_id_repeated_until_stopped_ends_before_another_motor_comes() {
    let mut fixture = scanned();
    fixture.command(raw(set_id_frame(), every(0, 2))).unwrap();
    fixture.run(ms(120_000));
    assert!(set_ids_sent(&fixture) >= 5);
    assert!(!status(&fixture).running);
    assert_eq!(ids(&fixture), [5]);
    fixture.world.add_motor(MotorConfig::new(id(7)));
    fixture.run(ms(2_000));
    assert_eq!(ids(&fixture), [5, 7]);
}

/// A proof lasts a minute, for any number of frames at any interval.
#[test]
fn raw_set_id_at_a_long_interval_ends_with_its_proof() {
    let mut fixture = scanned();
    let began = fixture.now;
    fixture
        .command(raw(set_id_frame(), every(0, 9_000)))
        .unwrap();
    fixture.run(ms(300_000));
    let sent: Vec<_> = fixture.sent.iter().filter(|sent| is_set_id(sent)).collect();
    assert_eq!(sent.len(), 7);
    assert!(sent.iter().all(|sent| sent.at.since(began) <= ms(60_000)));
    assert!(!status(&fixture).running);
}

#[test]
fn raw_set_id_after_another_motor_came_is_not_sent() {
    let mut fixture = scanned();
    fixture.world.add_motor(MotorConfig::new(id(7)));
    fixture.run(ms(20_000));
    fixture.command(raw(set_id_frame(), every(5, 5))).unwrap();
    fixture.run(ms(2_000));
    assert_eq!(set_ids_sent(&fixture), 0);
    assert!(!status(&fixture).running);
    assert_eq!(ids(&fixture), [1, 7]);
}

#[test]
fn stop_of_a_motor_ends_raw_set_id() {
    let mut fixture = scanned();
    fixture.command(raw(set_id_frame(), every(0, 100))).unwrap();
    fixture.run(ms(150));
    assert!(status(&fixture).running);
    let sent = set_ids_sent(&fixture);
    assert!(sent >= 1);
    fixture.command(Command::Stop(ID)).unwrap();
    assert!(!status(&fixture).running, "{:?}", status(&fixture));
    fixture.run(ms(1_000));
    assert_eq!(set_ids_sent(&fixture), sent);
}

/// A query between them would break the row of five that a motor needs.
#[test]
fn five_raw_set_id_frames_are_sent_in_a_row_at_any_phase_of_the_polling() {
    for phase in 0..20 {
        let mut fixture = scanned();
        fixture.run(ms(200 + phase * 5));
        fixture.command(raw(set_id_frame(), every(5, 20))).unwrap();
        fixture.run(ms(500));
        assert_eq!(ids(&fixture), [5], "phase {phase}");
    }
}

#[test]
fn set_id_while_halted_is_refused() {
    let mut fixture = scanned();
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    fixture.run(ms(500));
    let by_hand = fixture.command(raw(set_id_frame(), Repeat::Once));
    assert_eq!(by_hand, Err(Refusal::Halted));
    let command = Command::SetId {
        from: ID,
        to: to(5),
        frames: SetIdFrames::Five,
    };
    assert_eq!(fixture.command(command), Err(Refusal::Halted));
}
