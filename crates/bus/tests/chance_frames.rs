//! Bytes that pass the CRC by chance: across two replies, and where several motors answer at once.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    reason = "a test that cannot go on fails"
)]

mod bench;

use bench::{Bench, id, ms};
use motorlink_bus::{Command, Event};
use motorlink_protocol::{Frame, Reply};
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
