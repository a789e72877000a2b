//! Bytes that pass the CRC by chance: across two replies, and where several motors answer at once.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    reason = "a test that cannot go on fails"
)]

mod bench;

use bench::{Bench, ID, drive_frame, id, ms, raw, rpm};
use motorlink_bus::{Command, Event, IdQueryOutcome, RawAnswer, Repeat};
use motorlink_protocol::{Frame, Reply, Request};
use motorlink_simulator::WorldConfig;

fn bytes(text: &str) -> [u8; 10] {
    *text.parse::<Frame>().unwrap().bytes()
}

fn told(bench: &Bench) -> Vec<Reply> {
    let told = bench.events.iter().filter_map(|(_, event)| match event {
        Event::Telemetry(sample) => Some(sample.reply),
        _ => None,
    });
    told.collect()
}

/// Both owe a reply, and an adapter that stalled hands out both at once.
#[test]
fn two_replies_in_one_chunk_are_read_as_the_two_that_they_are() {
    let mut bench = Bench::new(WorldConfig::with_ids([]));
    for motor in [1, 2] {
        bench.command(Command::Watch(id(motor))).unwrap();
    }
    bench.run_until(ms(1_000), |bench| {
        let last = bench.sent.last().map(|sent| sent.frame.bytes()[0]);
        bench.sent.len() > 2 && last == Some(2)
    });
    bench.run(ms(2));
    let chunk = [
        bytes("02 02 00 08 00 00 75 7F 00 02"),
        bytes("01 01 00 08 00 00 58 00 10 85"),
    ]
    .concat();
    bench.bus.receive(bench.now, &chunk);
    bench.run(ms(50));
    let read = told(&bench);
    assert!(read.iter().any(|reply| reply.id == id(2)), "{read:?}");
    assert!(
        read.iter().all(|reply| reply.speed.magnitude() == 0),
        "{read:?}"
    );
}

/// Waits for this request, and gives these bytes as the answer to it.
fn answer(bench: &mut Bench, request: Request, with: &[u8]) {
    bench.run_until(ms(5_000), |bench| {
        bench.sent.last().map(|sent| sent.frame) == Some(request.frame())
    });
    bench.run(ms(2));
    bench.bus.receive(bench.now, with);
}

const FROM_1: &str = "01 02 00 0A 00 00 20 F6 00 4A";
const FROM_2: &str = "02 02 00 09 00 00 1C 00 00 B0";
/// Four motors at once, in a world that failed: motor 2 at 329 degrees, with three faults.
const COLLIDED: &str = "02 02 00 ED 00 00 75 08 55 FC";

/// A bench on which these motors have answered by these frames.
fn known(replies: &[&str]) -> Bench {
    let mut bench = Bench::new(WorldConfig::with_ids([]));
    for reply in replies {
        let motor = id(bytes(reply)[0]);
        bench.command(Command::Watch(motor)).unwrap();
        answer(&mut bench, Request::Query { id: motor }, &bytes(reply));
    }
    bench.run(ms(1));
    bench
}

fn asked_all(bench: &mut Bench, with: &[u8]) -> IdQueryOutcome {
    bench.command(Command::IdQuery).unwrap();
    answer(bench, Request::IdQuery, with);
    bench.forget_the_past();
    bench.run(ms(100));
    let outcome = bench.events.iter().find_map(|(_, event)| match event {
        Event::IdQueryEnded(outcome) => Some(*outcome),
        _ => None,
    });
    outcome.unwrap()
}

#[test]
fn answers_that_collide_into_a_good_frame_are_no_telemetry_of_a_known_motor() {
    let mut bench = known(&[FROM_1, FROM_2]);
    let outcome = asked_all(&mut bench, &bytes(COLLIDED));
    assert_eq!(told(&bench), []);
    assert_eq!(outcome, IdQueryOutcome::Garbled, "two motors are there");
}

#[test]
fn two_good_frames_behind_an_id_query_are_no_telemetry() {
    let mut bench = known(&[FROM_1]);
    let frames = [bytes(FROM_1), bytes(COLLIDED)].concat();
    assert_eq!(asked_all(&mut bench, &frames), IdQueryOutcome::Garbled);
    assert_eq!(told(&bench), []);
    assert_eq!(bench.bus.motors(bench.now).count(), 1, "none is invented");
}

/// Whether it was alone is not known; what it says next is.
#[test]
fn a_motor_that_answers_alone_is_found_and_asked_at_once() {
    let mut bench = known(&[]);
    let outcome = asked_all(&mut bench, &bytes(FROM_2));
    assert_eq!(outcome, IdQueryOutcome::One(id(2)));
    let query = Request::Query { id: id(2) };
    assert_eq!(bench.sent[0].request(), query);
    answer(&mut bench, query, &bytes(FROM_2));
    bench.run(ms(1));
    assert_eq!(told(&bench).len(), 1);
}

/// What nobody can read but one motor may obey is answered by that motor.
#[test]
fn the_answer_to_a_raw_frame_with_one_addressee_is_telemetry_of_that_motor_only() {
    for (reply, kept) in [(FROM_1, 1), (FROM_2, 0)] {
        let mut bench = known(&[FROM_1, FROM_2]);
        let [body @ .., _, _] = *drive_frame(ID, rpm(10)).bytes();
        let [b0, b1, b2, b3, b4, b5, b6, b7] = body;
        let lookalike = Frame::with_crc([b0, b1, b2, b3, b4, b5, b6, b7, 1]);
        bench.forget_the_past();
        bench.command(raw(lookalike, Repeat::Once)).unwrap();
        bench.run_until(ms(100), |bench| {
            bench.sent.last().map(|sent| sent.frame) == Some(lookalike)
        });
        bench.run(ms(2));
        bench.forget_the_past();
        bench.bus.receive(bench.now, &bytes(reply));
        bench.run(ms(25));
        assert_eq!(told(&bench).len(), kept, "{reply}");
        let last = bench.bus.raw().unwrap().last;
        let is_answer = matches!(last, Some(RawAnswer::Reply { .. }));
        assert_eq!(is_answer, kept == 1, "{last:?}");
    }
}
