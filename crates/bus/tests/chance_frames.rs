//! Bytes that pass the CRC by chance: across two replies, and where several motors answer at once.

use crate::fixture;
use crate::fixture::{Fixture, ID, drive_frame, id, ms, raw, rpm};
use motorlink_bus::{Command, Event, IdQueryOutcome, RawAnswer, Repeat, StopReason};
use motorlink_protocol::{Frame, Reply, Request, Rpm};
use motorlink_simulator::WorldConfig;

fn bytes(text: &str) -> [u8; 10] {
    *text.parse::<Frame>().unwrap().bytes()
}

fn told(fixture: &Fixture) -> Vec<Reply> {
    let told = fixture.events.iter().filter_map(|(_, event)| match event {
        Event::Telemetry(sample) => Some(sample.reply),
        _ => None,
    });
    told.collect()
}

/// Both owe a reply, and an adapter that stalled hands out both at once.
#[test]
fn two_replies_in_one_chunk_are_read_as_the_two_that_they_are() {
    let mut fixture = Fixture::new(WorldConfig::with_ids([]));
    for motor in [1, 2] {
        fixture.command(Command::Watch(id(motor))).unwrap();
    }
    fixture.run_until(ms(1_000), |fixture| {
        let last = fixture.sent.last().map(|sent| sent.frame.bytes()[0]);
        fixture.sent.len() > 2 && last == Some(2)
    });
    fixture.run(ms(2));
    let chunk = [
        bytes("02 02 00 08 00 00 75 7F 00 02"),
        bytes("01 01 00 08 00 00 58 00 10 85"),
    ]
    .concat();
    fixture.bus.receive(fixture.now, &chunk);
    fixture.run(ms(50));
    let read = told(&fixture);
    assert!(read.iter().any(|reply| reply.id == id(2)), "{read:?}");
    assert!(
        read.iter().all(|reply| reply.speed == Some(Rpm::new(0))),
        "{read:?}"
    );
}

/// Waits for this request, and gives these bytes as the answer to it.
fn answer(fixture: &mut Fixture, request: Request, with: &[u8]) {
    fixture.run_until(ms(5_000), |fixture| {
        fixture.sent.last().map(|sent| sent.frame) == Some(request.frame())
    });
    fixture.run(ms(2));
    fixture.bus.receive(fixture.now, with);
}

const FROM_1: &str = "01 02 00 0A 00 00 20 F6 00 4A";
const FROM_2: &str = "02 02 00 09 00 00 1C 00 00 B0";
/// Four motors at once, in a world that failed: motor 2 at 329 degrees, with three faults.
const COLLIDED: &str = "02 02 00 ED 00 00 75 08 55 FC";

/// A fixture on which these motors have answered by these frames.
fn known(replies: &[&str]) -> Fixture {
    let mut fixture = Fixture::new(WorldConfig::with_ids([]));
    for reply in replies {
        let motor = id(bytes(reply)[0]);
        fixture.command(Command::Watch(motor)).unwrap();
        answer(&mut fixture, Request::Query { id: motor }, &bytes(reply));
    }
    fixture.run(ms(1));
    fixture
}

fn asked_all(fixture: &mut Fixture, with: &[u8]) -> IdQueryOutcome {
    fixture.command(Command::IdQuery).unwrap();
    answer(fixture, Request::IdQuery, with);
    fixture.forget_the_past();
    fixture.run(ms(100));
    let outcome = fixture.events.iter().find_map(|(_, event)| match event {
        Event::IdQueryEnded(outcome) => Some(*outcome),
        _ => None,
    });
    outcome.unwrap()
}

#[test]
fn answers_that_collide_into_a_good_frame_are_no_telemetry_of_a_known_motor() {
    let mut fixture = known(&[FROM_1, FROM_2]);
    let outcome = asked_all(&mut fixture, &bytes(COLLIDED));
    assert_eq!(told(&fixture), []);
    assert_eq!(outcome, IdQueryOutcome::Garbled, "two motors are there");
}

#[test]
fn two_good_frames_behind_an_id_query_are_no_telemetry() {
    let mut fixture = known(&[FROM_1]);
    let frames = [bytes(FROM_1), bytes(COLLIDED)].concat();
    assert_eq!(asked_all(&mut fixture, &frames), IdQueryOutcome::Garbled);
    assert_eq!(told(&fixture), []);
    assert_eq!(
        fixture.bus.motors(fixture.now).count(),
        1,
        "none is invented"
    );
}

/// Whether it was alone is not known; what it says next is.
#[test]
fn a_motor_that_answers_alone_is_found_and_asked_at_once() {
    let mut fixture = known(&[]);
    let outcome = asked_all(&mut fixture, &bytes(FROM_2));
    assert_eq!(outcome, IdQueryOutcome::One(id(2)));
    let query = Request::Query { id: id(2) };
    assert_eq!(fixture.sent[0].request(), query);
    answer(&mut fixture, query, &bytes(FROM_2));
    fixture.run(ms(1));
    assert_eq!(told(&fixture).len(), 1);
}

/// A malformed frame that one motor may obey is answered by that motor.
#[test]
fn the_answer_to_a_raw_frame_with_one_addressee_is_telemetry_of_that_motor_only() {
    for (reply, kept) in [(FROM_1, 1), (FROM_2, 0)] {
        let mut fixture = known(&[FROM_1, FROM_2]);
        let [body @ .., _, _] = *drive_frame(ID, rpm(10)).bytes();
        let [b0, b1, b2, b3, b4, b5, b6, b7] = body;
        let lookalike = Frame::with_crc([b0, b1, b2, b3, b4, b5, b6, b7, 1]);
        fixture.forget_the_past();
        fixture.command(raw(lookalike, Repeat::Once)).unwrap();
        fixture.run_until(ms(100), |fixture| {
            fixture.sent.last().map(|sent| sent.frame) == Some(lookalike)
        });
        fixture.run(ms(2));
        fixture.forget_the_past();
        fixture.bus.receive(fixture.now, &bytes(reply));
        fixture.run(ms(25));
        assert_eq!(told(&fixture).len(), kept, "{reply}");
        let last = fixture.bus.raw().unwrap().last;
        let is_answer = matches!(last, Some(RawAnswer::Reply { .. }));
        assert_eq!(is_answer, kept == 1, "{last:?}");
    }
}

/// A stop cuts the ID query short, and an adapter hands out what it had held.
#[test]
fn answers_that_collide_are_no_telemetry_when_they_come_late() {
    for late in [1, 5, 12, 25, 35] {
        let mut fixture = known(&[FROM_1, FROM_2]);
        fixture.command(Command::IdQuery).unwrap();
        fixture.run_until(ms(5_000), |fixture| {
            fixture.sent.last().map(fixture::Sent::request) == Some(Request::IdQuery)
        });
        fixture.run(ms(2));
        fixture
            .command(Command::StopAll(StopReason::Operator))
            .unwrap();
        fixture.run(ms(8 + late));
        fixture.bus.receive(fixture.now, &bytes(COLLIDED));
        fixture.run(ms(100));
        let faulty = told(&fixture)
            .into_iter()
            .find(|reply| reply.faults.any_named());
        assert_eq!(faulty, None, "{late} ms behind the window");
    }
}
