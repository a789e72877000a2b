//! Bytes in time: airtime, turnaround, collisions, and how motors find frames again.

use crate::fixture::{Fixture, ONE, id, ms, speed, us};
use motorlink_protocol::{Frame, Instant, Layout, Reply, Request, Setpoint};
use motorlink_simulator::{MotorConfig, Sender, WireFrame, WorldConfig};

/// 868 us for ten bytes, 600 us turnaround, 868 us for the reply (motor.md).
#[test]
fn a_reply_comes_whole_when_its_last_byte_has_passed() {
    let mut fixture = Fixture::with_one_motor();
    let start = fixture.now;
    fixture
        .world
        .transmit(start, Request::Query { id: ONE }.frame().bytes());
    assert_eq!(fixture.world.receive(start + us(2335)), None);
    let chunk = fixture.world.receive(start + us(2336)).expect("a reply");
    assert_eq!(chunk.at, start + us(2336));
    assert_eq!(chunk.bytes.len(), 10);
    assert_eq!(fixture.world.next_event(), None);
}

#[test]
fn following_next_event_delivers_a_reply_in_few_steps() {
    let mut fixture = Fixture::with_one_motor();
    let start = fixture.now;
    fixture
        .world
        .transmit(start, Request::Query { id: ONE }.frame().bytes());
    let mut steps = Vec::new();
    while let Some(at) = fixture.world.next_event() {
        steps.push(at.since(start));
        if fixture.world.receive(at).is_some() {
            break;
        }
    }
    assert_eq!(steps, [us(868), us(1468), us(2336)]);
}

#[test]
fn turnaround_is_a_setting() {
    let mut fixture = Fixture::new(WorldConfig {
        turnaround: us(3000),
        ..WorldConfig::default()
    });
    let start = fixture.now;
    fixture
        .world
        .transmit(start, Request::Query { id: ONE }.frame().bytes());
    fixture.wait(ms(1));
    assert_eq!(fixture.world.receive(start + us(4735)), None);
    assert!(fixture.world.receive(start + us(4736)).is_some());
}

#[test]
fn the_traffic_log_has_every_frame_with_its_start() {
    let mut fixture = Fixture::with_one_motor();
    let start = fixture.now;
    let query = Request::Query { id: ONE }.frame();
    let received: [u8; 10] = fixture.send(query).try_into().unwrap();
    let traffic: Vec<WireFrame> = fixture.world.drain_wire_frames().collect();
    let host = WireFrame {
        at: start,
        from: Sender::Host,
        frame: query,
    };
    let motor = WireFrame {
        at: start + us(1468),
        from: Sender::Motor(ONE),
        frame: Frame::new(received),
    };
    assert_eq!(traffic, [host, motor]);
    assert_eq!(fixture.world.drain_wire_frames().count(), 0);
}

/// motor.md: the ID query is answered by every motor at once; several collide.
#[test]
fn two_motors_answer_the_id_query_over_each_other() {
    let mut fixture = Fixture::with_ids(&[1, 2]);
    let received = fixture.send(Request::IdQuery.frame());
    assert_eq!(received.len(), 10, "one burst of garbage");
    let frame = Frame::new(received.try_into().unwrap());
    assert!(
        Reply::decode(&frame, Some(Layout::Drive)).is_err(),
        "{frame}"
    );

    fixture.world.motor_mut(id(2)).unwrap().power(false);
    assert!(
        fixture.ask(Request::IdQuery).is_some(),
        "one alone is heard"
    );
}

#[test]
fn two_motors_do_not_disturb_each_other_when_asked_in_turn() {
    let mut fixture = Fixture::with_ids(&[1, 2]);
    for address in [1, 2, 1, 2] {
        let reply = fixture.ask(Request::drive(id(address), speed(50)));
        assert_eq!(reply.expect("an answer").id, id(address));
    }
}

/// motor.md: two frames back to back collide, and the same motor is lost in every cycle.
#[test]
fn a_request_right_after_another_collides_with_the_reply() {
    let mut fixture = Fixture::with_ids(&[1, 2]);
    for _ in 0..20 {
        let start = fixture.now;
        for address in [1, 2] {
            let frame = Request::drive(id(address), speed(50)).frame();
            fixture.world.transmit(start, frame.bytes());
        }
        fixture.wait(ms(20));
    }
    assert!(fixture.world.motor(id(1)).unwrap().is_driven());
    assert!(
        !fixture.world.motor(id(2)).unwrap().is_driven(),
        "lost in every cycle"
    );
}

#[test]
fn after_a_stray_byte_motors_find_frames_again_at_the_next_pause() {
    let mut fixture = Fixture::with_one_motor();
    let query = Request::Query { id: ONE };
    fixture.world.transmit(fixture.now, &[0x55]);
    assert_eq!(fixture.send(query.frame()), [], "one byte off");
    assert!(fixture.ask(query).is_some(), "after a pause of 1 ms");
}

#[test]
fn a_frame_in_two_halves_is_a_frame_if_the_pause_is_short() {
    for (pause, received) in [(us(900), true), (us(1100), false)] {
        let mut fixture = Fixture::with_one_motor();
        let frame = Request::Query { id: ONE }.frame();
        let (front, back) = frame.bytes().split_at(4);
        fixture.world.transmit(fixture.now, front);
        // Four bytes take 347 us.
        fixture.world.transmit(fixture.now + us(347) + pause, back);
        fixture.now = fixture.now + ms(10);
        assert_eq!(
            fixture.world.receive(fixture.now).is_some(),
            received,
            "{pause:?}"
        );
    }
}

#[test]
fn a_host_that_floods_the_wire_loses_what_it_cannot_carry() {
    let mut fixture = Fixture::with_one_motor();
    fixture.world.transmit(fixture.now, &vec![0; 1_000_000]);
    fixture.wait(ms(1000));
    assert!(fixture.ask(Request::Query { id: ONE }).is_some());
}

#[test]
fn motors_come_and_go() {
    let mut fixture = Fixture::with_one_motor();
    fixture.world.add_motor(MotorConfig::new(id(5)));
    let five = Request::Query { id: id(5) };
    assert!(fixture.ask(five).is_some());
    assert!(fixture.world.remove_motor(id(5)).is_some());
    assert!(fixture.ask(five).is_none());
    assert!(fixture.world.remove_motor(id(5)).is_none());
}

#[test]
fn a_motor_that_goes_while_it_is_asked_does_not_answer() {
    let mut fixture = Fixture::with_one_motor();
    fixture
        .world
        .transmit(fixture.now, Request::Query { id: ONE }.frame().bytes());
    fixture.wait(ms(1));
    fixture.world.remove_motor(ONE);
    fixture.now = fixture.now + ms(10);
    assert_eq!(fixture.world.receive(fixture.now), None);
}

#[test]
fn time_that_goes_back_counts_as_the_latest() {
    let mut fixture = Fixture::with_one_motor();
    let latest = fixture.now + ms(100);
    fixture.world.advance(latest);
    fixture
        .world
        .transmit(Instant::ZERO, Request::Query { id: ONE }.frame().bytes());
    let chunk = fixture.world.receive(latest + ms(10)).expect("a reply");
    assert_eq!(chunk.at, latest + us(2336));
}

/// A laptop that slept for a day must not have to integrate it while the page waits.
#[test]
fn a_day_at_rest_passes_at_once() {
    let mut fixture = Fixture::with_one_motor();
    fixture.drive_for(speed(100), ms(1000));
    // As a host leaves it: braked.
    fixture.drive_for(Setpoint::Brake, ms(1000));
    let began = std::time::Instant::now();
    fixture.wait(ms(24 * 3_600_000));
    assert!(began.elapsed() < ms(2000), "{:?}", began.elapsed());
    assert!(fixture.ask(Request::Query { id: ONE }).is_some());
}
