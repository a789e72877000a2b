//! Full scans of virtual motors on bad lines, in virtual time: how many runs find every motor.
//!
//! `cargo run --release -p motorlink-bus --example full_scans -- 1000` plays so many seeds of each
//! line. The seed of a run that misses or invents a motor is printed.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a measurement that cannot go on ends"
)]

use std::time::Duration;

use motorlink_bus::{Bus, Command, Event, Output, ScanReport};
use motorlink_protocol::{Instant, MotorId};
use motorlink_simulator::{Echo, WireFaults, World, WorldConfig};

/// No scan takes longer.
const PATIENCE: Duration = Duration::from_secs(60);

fn main() {
    let seeds: u64 = std::env::args()
        .nth(1)
        .map_or(1_000, |seeds| seeds.parse().expect("a number of seeds"));
    let lossy = WireFaults {
        echo: Echo::Whole,
        lose_reply: 0.05,
        ..WireFaults::default()
    };
    let held = WireFaults {
        hold: Duration::from_millis(16),
        ..WireFaults::default()
    };
    play("every 20th reply lost, echo", &lossy, seeds);
    play("adapter holds bytes for 16 ms", &held, seeds.div_ceil(10));
}

/// Scans three motors at addresses that the seed chooses, on a line with these faults.
fn play(line: &str, faults: &WireFaults, seeds: u64) {
    let (mut complete, mut invented, mut longest_ms) = (0_u64, 0_u64, 0);
    for seed in 0..seeds {
        let motors = three_motors(seed);
        let report = scan(WorldConfig {
            seed,
            faults: faults.clone(),
            ..WorldConfig::with_ids(motors)
        });
        let all = motors.iter().all(|id| report.found.contains(id));
        let none_else = report.found.iter().all(|id| motors.contains(id));
        complete += u64::from(all);
        invented += u64::from(!none_else);
        longest_ms = longest_ms.max(report.took_ms);
        if !(all && none_else) {
            println!("  seed {seed}: {motors:?}, found {:?}", report.found);
        }
    }
    println!(
        "full scan, {line}, {seeds} seeds: every motor found in {} per mille, \
         invented in {invented} runs, longest {longest_ms} ms of bus time",
        complete * 1000 / seeds
    );
}

/// Three different addresses.
fn three_motors(seed: u64) -> [MotorId; 3] {
    let address = |place: u64| {
        let spread = (seed * 97 + place * 85) % 254 + 1;
        MotorId::new(u8::try_from(spread).expect("at most 254")).expect("at least 1")
    };
    [address(0), address(1), address(2)]
}

/// One full scan, from a bus that knows no motor.
fn scan(config: WorldConfig) -> ScanReport {
    let mut now = Instant::from_millis(1_000);
    let mut world = World::new(config);
    world.advance(now);
    let mut bus = Bus::new(now);
    bus.command(now, Command::FullScan)
        .expect("nothing is driven");
    let end = now + PATIENCE;
    while now < end {
        let wake = loop {
            match bus.poll(now) {
                Output::Transmit(frame) => world.transmit(now, frame.bytes()),
                Output::Event(Event::ScanEnded(report)) => return report,
                Output::Event(Event::PingPage) => bus.page_answered(now),
                Output::Event(_) => {}
                Output::Wait(at) => break at,
            }
        };
        now = world
            .next_event()
            .map_or(wake, |event| event.min(wake))
            .max(now);
        world.advance(now);
        while let Some(chunk) = world.receive(now) {
            bus.receive(now, &chunk.bytes);
        }
    }
    panic!("the scan did not end within {PATIENCE:?}")
}
