//! The full scan on a line that is slow, noisy or loses replies.

use std::time::Duration;

use crate::fixture::scans::{ids, scan, scan_ended, unknown};
use crate::fixture::{Fixture, ID, Sent, id, ms};
use motorlink_bus::{Command, ScanFault, ScanReport};
use motorlink_protocol::family::Model;
use motorlink_simulator::{Echo, WireFaults, WorldConfig};

#[test]
fn a_scan_on_an_adapter_that_holds_bytes_finds_all_in_seven_seconds() {
    let hold = WireFaults {
        hold: ms(16),
        ..WireFaults::default()
    };
    for seed in 0..5 {
        let report = scan(&mut unknown(&[1, 90, 254], hold.clone(), seed));
        assert_eq!(report.found, ids(&[1, 90, 254]));
        assert!(report.took_ms <= 7_000, "{} ms", report.took_ms);
    }
}

/// A reply that a busy machine hands over late is no loss, and no slow adapter.
#[test]
fn a_machine_that_is_delayed_now_and_then_makes_no_slow_scan() {
    let mut late = 0;
    for seed in 0..10 {
        let mut fixture = unknown(&[1, 90, 254], WireFaults::default(), seed);
        fixture.command(Command::FullScan).unwrap();
        while scan_ended(&fixture).is_none() {
            fixture.run(ms(90 + 7 * seed));
            fixture.now = fixture.now + ms(12);
            fixture.world.advance(fixture.now);
        }
        let report = scan_ended(&fixture).unwrap();
        assert_eq!(report.found, ids(&[1, 90, 254]), "seed {seed}");
        assert!(report.noisy.is_empty(), "seed {seed}");
        assert!(
            report.took_ms <= 2_500,
            "seed {seed}: {} ms",
            report.took_ms
        );
        let motors = fixture.bus.motors(fixture.now);
        late += motors.map(|motor| motor.counters.late).sum::<u64>();
        late += fixture.bus.line_status(fixture.now).unaddressed.wrong_ids;
    }
    assert!(late > 10, "{late} replies were late");
}

/// A reply delayed by any time is not lost on the line, and no address has to be probed again for
/// it.
#[test]
fn a_machine_that_stood_still_for_a_moment_makes_no_slow_scan() {
    for seed in 0..20 {
        let mut fixture = unknown(&[1, 90, 254], WireFaults::default(), seed);
        fixture.command(Command::FullScan).unwrap();
        while scan_ended(&fixture).is_none() {
            fixture.run(ms(430 + 7 * seed));
            fixture.now = fixture.now + ms(80);
            fixture.world.advance(fixture.now);
        }
        let report = scan_ended(&fixture).unwrap();
        assert_eq!(report.found, ids(&[1, 90, 254]), "seed {seed}");
        assert!(
            report.took_ms <= 3_000,
            "seed {seed}: {} ms",
            report.took_ms
        );
    }
}

/// The queries of several windows go out at once, and the replies to them collide.
#[test]
fn an_adapter_that_stalls_for_some_windows_hides_no_motor() {
    for stall in 1..45 {
        for before in [88, 89, 90] {
            let mut fixture = unknown(&[1, 90, 91, 254], WireFaults::default(), stall);
            fixture.command(Command::FullScan).unwrap();
            let is_next = |fixture: &Fixture| {
                let last = fixture.sent.last().map(|sent| sent.frame);
                last.is_some_and(|frame| frame.bytes()[..2] == [before, 0x74])
            };
            fixture.run_until(ms(5_000), is_next);
            fixture.stall(ms(stall));
            fixture.run_until(ms(60_000), |fixture| scan_ended(fixture).is_some());
            let report = scan_ended(&fixture).unwrap();
            assert_eq!(
                report.found,
                ids(&[1, 90, 91, 254]),
                "{stall} ms from {before} on: {report:?}"
            );
        }
    }
}

/// The figure over 1,000 seeds is printed by `cargo xtask fixture`; here a few, so that a scan that
/// gives up too early is noticed.
#[test]
fn a_scan_on_a_line_that_loses_replies_finds_all() {
    let lossy = WireFaults {
        echo: Echo::Whole,
        lose_reply: 0.05,
        ..WireFaults::default()
    };
    for seed in 0..40 {
        let report = scan(&mut unknown(&[3, 77, 201], lossy.clone(), seed));
        assert_eq!(report.found, ids(&[3, 77, 201]), "seed {seed}");
        assert!(report.noisy.is_empty(), "seed {seed}");
    }
}

#[test]
fn noise_gets_a_second_look_and_makes_no_motor() {
    let noisy = WireFaults {
        corrupt_reply: 0.2,
        stray: 0.2,
        ..WireFaults::default()
    };
    for seed in 0..10 {
        let report = scan(&mut unknown(&[3, 77, 201], noisy.clone(), seed));
        assert_eq!(report.found, ids(&[3, 77, 201]), "seed {seed}");
    }
}

#[test]
fn scan_in_steady_noise_ends_and_finds_no_false_motor() {
    let mut fixture = Fixture::new(WorldConfig::default());
    fixture.command(Command::FullScan).unwrap();
    for step in 0..120_000_u32 {
        let noise = (step * 37).to_le_bytes()[0];
        fixture.bus.receive(fixture.now, &[noise]);
        fixture.run(ms(1));
        if scan_ended(&fixture).is_some() {
            break;
        }
    }
    let report = scan_ended(&fixture).unwrap();
    assert!(report.complete, "{report:?}");
    assert!(report.found.iter().all(|found| *found == ID), "{report:?}");
    assert!(report.noisy.len() > 200, "{report:?}");
}

/// The rest of a late reply comes right behind the ID query.
#[test]
fn late_bytes_behind_the_id_query_shorten_no_reply_window() {
    let mut fixture = Fixture::watching(WorldConfig::of(Model::Ddsm400, [ID, id(2)]), &[ID]);
    fixture.run(ms(1_000));
    fixture.forget_the_past();
    fixture.command(Command::FullScan).unwrap();
    let is_id_query = |fixture: &Fixture| {
        let last = fixture.sent.last();
        last.is_some_and(|sent| sent.frame.bytes()[..2] == [0xC8, 0x64])
    };
    fixture.run_until(ms(1_000), is_id_query);
    // All other bytes of the ID query are lost.
    fixture.world.motor_mut(ID).unwrap().mute(true);
    fixture.world.motor_mut(id(2)).unwrap().mute(true);
    let now = fixture.now + Duration::from_micros(240);
    fixture.now = now;
    fixture.bus.receive(now, &[0x1C, 0x00, 0x02]);
    fixture.run(ms(5));
    fixture.world.motor_mut(ID).unwrap().mute(false);
    fixture.world.motor_mut(id(2)).unwrap().mute(false);
    let ended = |fixture: &Fixture| scan_ended(fixture).is_some();
    fixture.run_until(ms(60_000), ended);
    assert_eq!(scan_ended(&fixture).unwrap().found, [ID, id(2)]);
}

/// No reply comes in its window, and each chunk ends within a frame.
#[test]
fn a_scan_behind_an_adapter_that_delivers_blocks_finds_all_and_says_so() {
    let blocks = WireFaults {
        block: 32,
        ..WireFaults::default()
    };
    for motors in [&[1][..], &[77], &[254], &[3, 77, 201]] {
        for seed in 0..5 {
            let report = scan(&mut unknown(motors, blocks.clone(), seed));
            assert_eq!(report.found, ids(motors), "seed {seed}: {report:?}");
            assert!(report.noisy.is_empty(), "seed {seed}: {report:?}");
            assert_eq!(report.fault, Some(ScanFault::Blocks), "seed {seed}");
            assert_eq!(report.asked, 254);
            assert!(report.took_ms <= 8_000, "seed {seed}: {report:?}");
        }
    }
    assert_eq!(
        scan(&mut unknown(&[1], WireFaults::default(), 1)).fault,
        None
    );
}

#[test]
fn a_scan_on_a_floating_pair_calls_no_address_noisy() {
    let floating = WireFaults {
        floating: true,
        ..WireFaults::default()
    };
    for motors in [&[][..], &[1], &[3, 77, 201]] {
        for seed in 0..5 {
            let report = scan(&mut unknown(motors, floating.clone(), seed));
            assert_eq!(report.found, ids(motors), "seed {seed}: {report:?}");
            assert!(report.noisy.is_empty(), "seed {seed}: {report:?}");
            let floats = motors.is_empty().then_some(ScanFault::Floating);
            assert_eq!(report.fault, floats, "seed {seed}");
        }
    }
}

/// A scan of motor 1, with three bytes of noise behind the first queries for the address 12.
fn with_noise_at_12(probes: usize) -> ScanReport {
    let mut fixture = unknown(&[1], WireFaults::default(), 1);
    fixture.command(Command::FullScan).unwrap();
    let asks_12 = |sent: &Sent| sent.frame.bytes()[..2] == [12, 0x74];
    let mut asked = 0;
    while scan_ended(&fixture).is_none() {
        fixture.run(ms(1));
        let now_asked = fixture.sent.iter().filter(|sent| asks_12(sent)).count();
        if now_asked > asked && now_asked <= probes {
            fixture.bus.receive(fixture.now, &[0x02, 0x7F, 0x31]);
        }
        asked = now_asked;
    }
    scan_ended(&fixture).unwrap()
}

/// Late bytes of a busy machine come in the windows of an address that nobody has.
#[test]
fn a_noisy_address_is_asked_again_before_it_is_called_noisy() {
    let quiet = with_noise_at_12(6);
    assert_eq!((quiet.found, quiet.noisy), (ids(&[1]), Vec::new()));
    let noisy = with_noise_at_12(usize::MAX);
    assert_eq!((noisy.found, noisy.noisy), (ids(&[1]), ids(&[12])));
    assert!(noisy.took_ms < quiet.took_ms + 400, "{} ms", noisy.took_ms);
}
