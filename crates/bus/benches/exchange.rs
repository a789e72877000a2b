//! What one exchange costs in computing: decoding a reply, and everything between two frames.
//!
//! `cargo xtask bench` prints it. At 500 exchanges a second a core has two million nanoseconds for each.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    reason = "a measurement that cannot go on ends, and criterion makes an item without docs"
)]

use std::{hint::black_box, time::Duration};

use criterion::{Criterion, criterion_group, criterion_main};
use motorlink_bus::{Bus, BusSettings, Command, CommandRate, Consent, Output};
use motorlink_protocol::{Frame, Instant, Layout, MotorId, Reply, Request, Setpoint, SpeedTarget};

/// A reply that a motor gave: 100 rpm, 0.25 A.
fn reply(id: MotorId) -> Frame {
    Frame::with_crc([id.get(), 2, 0x04, 0, 0, 100, 0x17, 0xCF, 0])
}

fn decode(criterion: &mut Criterion) {
    let frame = reply(MotorId::FIRST);
    criterion.bench_function("decode a reply", |bencher| {
        bencher.iter(|| Reply::decode(black_box(&frame), Some(Layout::Drive)));
    });
}

/// A bus that drives so many motors, and the time on it.
struct Driven {
    bus: Bus,
    now: Instant,
}

impl Driven {
    fn new(motors: u8) -> Self {
        let now = Instant::from_millis(1_000);
        let mut driven = Self {
            bus: Bus::new(now),
            now,
        };
        let ids = || MotorId::all().take(motors.into());
        for id in ids() {
            let watched = driven.bus.command(now, Command::Watch(id));
            watched.expect("watching is never refused");
        }
        for _ in 0..200 {
            driven.exchange();
        }
        let rate = CommandRate::new(500).expect("500 Hz is the most");
        let now = driven.now;
        let set = driven.bus.command(
            now,
            Command::Configure(BusSettings {
                rate,
                ..BusSettings::default()
            }),
        );
        set.expect("a rate is never refused");
        for id in ids() {
            let speed = SpeedTarget::new(100).expect("100 rpm is in range");
            let drive = Command::Drive {
                id,
                setpoint: Setpoint::velocity(speed),
                consent: Consent::None,
            };
            driven
                .bus
                .command(driven.now, drive)
                .expect("it has answered");
        }
        driven
    }

    /// Sends what is due next and hears its reply.
    fn exchange(&mut self) {
        loop {
            match self.bus.poll(self.now) {
                Output::Transmit(frame) => {
                    self.now = self.now + Duration::from_micros(1_900);
                    let asked = Request::parse(&frame)
                        .ok()
                        .and_then(|request| request.addressee());
                    let Some(id) = asked else { continue };
                    self.bus.receive(self.now, reply(id).bytes());
                    self.bus.page_answered(self.now);
                    return;
                }
                Output::Event(event) => drop(black_box(event)),
                Output::Wait(until) => self.now = until,
            }
        }
    }
}

fn exchange(criterion: &mut Criterion) {
    for motors in [1, 8] {
        let mut driven = Driven::new(motors);
        criterion.bench_function(&format!("one exchange, {motors} driven"), |bencher| {
            bencher.iter(|| driven.exchange());
        });
    }
}

/// The decision that the bus makes most often: the next frame, when none is due.
fn schedule(criterion: &mut Criterion) {
    let mut driven = Driven::new(8);
    let mut now = driven.now;
    let soon = loop {
        match driven.bus.poll(now) {
            Output::Wait(until) if until > now + Duration::from_micros(200) => break now,
            Output::Wait(until) => now = until,
            Output::Transmit(_) => now = now + Duration::from_micros(1_900),
            Output::Event(event) => drop(black_box(event)),
        }
    };
    criterion.bench_function("schedule: who is next, 8 driven", |bencher| {
        bencher.iter(|| driven.bus.poll(black_box(soon)));
    });
}

fn line_status(criterion: &mut Criterion) {
    let mut driven = Driven::new(8);
    for _ in 0..1_000 {
        driven.exchange();
    }
    criterion.bench_function("status of the line, 8 driven", |bencher| {
        bencher.iter(|| driven.bus.line_status(black_box(driven.now)));
    });
}

criterion_group!(benches, decode, exchange, schedule, line_status);
criterion_main!(benches);
