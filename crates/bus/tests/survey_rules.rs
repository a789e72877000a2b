//! Scans and ID changes: the ways round their rules.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    reason = "a test that cannot go on fails"
)]

mod bench;

use bench::{Bench, ID, id, is_set_id, ms, rpm, scan_report, to, two};
use motorlink_bus::{Command, Event, Output, SetIdFrames, StopReason};
use motorlink_protocol::{Detail, Mode, Request};
use motorlink_simulator::{MotorConfig, WireFaults, WorldConfig};

#[test]
fn two_motors_of_one_id_are_no_proof() {
    let mut proofs = 0;
    let mut both = 0;
    for seed in 0..40 {
        let mut bench = Bench::new(WorldConfig {
            seed,
            faults: WireFaults {
                lose_reply: 0.05,
                ..WireFaults::default()
            },
            ..WorldConfig::with_ids([id(4)])
        });
        bench.world.add_motor(MotorConfig {
            angle_deg: 123.0,
            ambient_c: 40.0,
            ..MotorConfig::new(id(4))
        });
        let r = scan_report(&mut bench);
        if r.found == [id(4)] && r.noisy.is_empty() {
            proofs += 1;
            if bench
                .command(Command::SetId {
                    from: id(4),
                    to: to(5),
                    frames: SetIdFrames::Five,
                })
                .is_ok()
            {
                bench.run_until(ms(20_000), |bench| {
                    bench.happened(|e| matches!(e, Event::IdChangeEnded { .. }))
                });
                both += u32::from(bench.sent.iter().any(is_set_id));
            }
        }
    }
    assert_eq!(
        proofs, 0,
        "{proofs} of 40 scans proved two motors with ID 4 to be one; set-ID sent in {both}"
    );
}

#[test]
fn an_id_query_that_a_stop_ends_is_told() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(500));
    bench.command(Command::IdQuery).unwrap();
    bench.run(ms(20));
    bench
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    bench.run(ms(5000));
    assert!(
        bench.happened(|e| matches!(e, Event::IdQueryEnded(_))),
        "never told"
    );
}

#[test]
fn a_scan_does_not_rename_stop_all() {
    let mut bench = Bench::one_motor();
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(500));
    bench
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    bench.run(ms(20));
    bench.command(Command::FullScan).unwrap();
    bench.run(ms(1000));
    let r = bench.events.iter().find_map(|(_, e)| match e {
        Event::StopEnded(r) => Some(r.reason),
        _ => None,
    });
    assert_eq!(r, Some(StopReason::Operator));
}

#[test]
fn every_request_of_a_scan_is_counted_with_its_end() {
    let mut bench = Bench::new(WorldConfig::default());
    scan_report(&mut bench);
    let u = bench.bus.line_status(bench.now).unaddressed;
    assert!(
        u.requests <= u.replies + u.silences + u.bad_crcs + u.fragments + 4,
        "{u:?}"
    );
}

#[test]
fn a_stop_that_waits_for_another_motor_is_no_busy_loop() {
    let mut bench = two();
    bench.world.set_faults(WireFaults {
        lose_reply: 1.0,
        ..WireFaults::default()
    });
    bench.command(Command::Stop(ID)).unwrap();
    bench.run(ms(2000));
    bench.command(Command::Stop(id(2))).unwrap();
    bench.run(ms(1050));
    let mut short = 0;
    let mut n = 0;
    for _ in 0..2000 {
        match bench.bus.poll(bench.now) {
            Output::Wait(at) => {
                n += 1;
                if at.since(bench.now) < std::time::Duration::from_micros(50) {
                    short += 1;
                }
                bench.now = at;
                bench.world.advance(bench.now);
                while let Some(c) = bench.world.receive(bench.now) {
                    bench.bus.receive(bench.now, &c.bytes);
                }
            }
            Output::Transmit(f) => bench.world.transmit(bench.now, f.bytes()),
            Output::Event(Event::PingPage) => bench.bus.page_answered(bench.now),
            Output::Event(_) => {}
        }
    }
    assert!(short < 20, "{short} of {n} waits under 50 us");
}

#[test]
fn a_silent_page_ends_an_id_change_and_scan() {
    let mut bench = Bench::one_motor();
    bench.command(Command::FullScan).unwrap();
    bench.page_lives = false;
    bench.run(ms(1500));
    assert!(bench.bus.survey().is_none(), "{:?}", bench.bus.survey());
}

#[test]
fn an_answer_to_an_id_query_cut_short_is_not_read_as_that_of_a_query() {
    let mut bench = Bench::watching(
        WorldConfig {
            faults: WireFaults {
                hold: ms(16),
                ..WireFaults::default()
            },
            ..WorldConfig::default()
        },
        &[ID],
    );
    bench.switch(Mode::Position);
    bench.run(ms(500));
    for wait in 0..12 {
        bench.run(ms(300));
        bench.forget_the_past();
        bench.command(Command::IdQuery).unwrap();
        bench.run_until(ms(100), |bench| {
            bench.sent.iter().any(|s| s.request() == Request::IdQuery)
        });
        bench.run(ms(wait));
        bench.command(Command::Stop(ID)).unwrap();
        bench.run(ms(200));
        for (_, e) in &bench.events {
            if let Event::Telemetry(s) = e
                && let Detail::Query { temperature, .. } = s.reply.detail
            {
                assert!(
                    (20..40).contains(&temperature.degrees()),
                    "wait {wait}: {temperature:?}"
                );
            }
        }
        bench.run(ms(4000));
        bench.switch(Mode::Position);
    }
}

#[test]
fn a_scan_in_steady_noise_ends() {
    let mut bench = Bench::new(WorldConfig::default());
    bench.command(Command::FullScan).unwrap();
    for i in 0..120_000u32 {
        bench.bus.receive(bench.now, &[(i * 37).to_le_bytes()[0]]);
        bench.run(ms(1));
        if bench.happened(|e| matches!(e, Event::ScanEnded(_))) {
            break;
        }
    }
    let r = bench.events.iter().find_map(|(_, e)| match e {
        Event::ScanEnded(r) => Some((r.found.clone(), r.noisy.len(), r.took_ms)),
        _ => None,
    });
    assert!(r.is_some());
}
