//! How an address is given: five frames in a row, heard by all, once per power cycle, kept in flash.

use crate::fixture::{Fixture, ONE, id, ms, speed};
use motorlink_protocol::{AssignableId, Frame, MotorId, Request};
use motorlink_simulator::{MotorConfig, WorldConfig};

fn set_id(address: u8) -> Frame {
    let id = AssignableId::new(id(address)).unwrap();
    Request::SetId { id }.frame()
}

fn send_times(fixture: &mut Fixture, frame: Frame, times: usize) {
    for _ in 0..times {
        assert_eq!(fixture.send(frame), [], "set ID is never answered");
    }
}

fn ids(fixture: &Fixture) -> Vec<u8> {
    fixture
        .world
        .motors()
        .map(|motor| motor.id().get())
        .collect()
}

#[test]
fn five_in_a_row_give_a_new_id() {
    let mut fixture = Fixture::with_one_motor();
    send_times(&mut fixture, set_id(7), 4);
    assert_eq!(ids(&fixture), [1]);
    send_times(&mut fixture, set_id(7), 1);
    assert_eq!(ids(&fixture), [7]);
    assert!(fixture.ask(Request::Query { id: id(7) }).is_some());
    assert!(fixture.ask(Request::Query { id: ONE }).is_none());
}

/// The maker's samples end the frame with 00, DFRobot's table with its CRC.
#[test]
fn both_published_endings_are_taken() {
    for text in [
        "AA 55 53 09 00 00 00 00 00 00",
        "AA 55 53 01 00 00 00 00 00 CB",
    ] {
        let frame: Frame = text.parse().unwrap();
        let mut fixture = Fixture::with_ids(&[3]);
        send_times(&mut fixture, frame, 5);
        assert_eq!(ids(&fixture), [frame.bytes()[3]], "{text}");
    }
}

#[test]
fn another_frame_in_between_restarts_the_count() {
    let mut fixture = Fixture::with_one_motor();
    send_times(&mut fixture, set_id(7), 4);
    fixture.drive(speed(0)).expect("an answer");
    send_times(&mut fixture, set_id(7), 4);
    assert_eq!(ids(&fixture), [1]);
    send_times(&mut fixture, set_id(7), 1);
    assert_eq!(ids(&fixture), [7]);
}

#[test]
fn another_id_in_between_restarts_the_count() {
    let mut fixture = Fixture::with_one_motor();
    send_times(&mut fixture, set_id(7), 4);
    send_times(&mut fixture, set_id(8), 4);
    assert_eq!(ids(&fixture), [1]);
    send_times(&mut fixture, set_id(8), 1);
    assert_eq!(ids(&fixture), [8]);
}

#[test]
fn it_works_once_per_power_cycle_and_is_kept() {
    let mut fixture = Fixture::with_one_motor();
    send_times(&mut fixture, set_id(7), 5);
    send_times(&mut fixture, set_id(8), 10);
    assert_eq!(ids(&fixture), [7]);

    let motor = fixture.world.motor_mut(id(7)).unwrap();
    motor.power(false);
    assert_eq!(motor.id(), id(7));
    fixture.wait(ms(100));
    fixture.world.motor_mut(id(7)).unwrap().power(true);
    assert_eq!(ids(&fixture), [7]);

    send_times(&mut fixture, set_id(8), 5);
    assert_eq!(ids(&fixture), [8]);
}

#[test]
fn all_motors_on_the_wire_take_it() {
    let mut fixture = Fixture::with_ids(&[1, 2]);
    send_times(&mut fixture, set_id(9), 5);
    assert_eq!(ids(&fixture), [9, 9]);
}

/// 0xC8 starts the ID query.
#[test]
fn c8_is_not_taken() {
    let mut fixture = Fixture::with_one_motor();
    let frame: Frame = "AA 55 53 C8 00 00 00 00 00 00".parse().unwrap();
    send_times(&mut fixture, frame, 10);
    assert_eq!(ids(&fixture), [MotorId::FIRST.get()]);
}

/// M0601 units are reported to take more than five.
#[test]
fn how_many_it_takes_can_be_set() {
    let mut fixture = Fixture::new(WorldConfig {
        motors: vec![MotorConfig {
            set_id_frames: 8,
            ..MotorConfig::default()
        }],
        ..WorldConfig::default()
    });
    send_times(&mut fixture, set_id(7), 7);
    assert_eq!(ids(&fixture), [1]);
    send_times(&mut fixture, set_id(7), 1);
    assert_eq!(ids(&fixture), [7]);
}
