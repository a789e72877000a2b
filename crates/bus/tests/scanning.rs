//! Who is there: the ID query and the full scan.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    reason = "a test that cannot go on fails"
)]

mod bench;

use bench::{Bench, ID, id, ms, rpm};
use motorlink_bus::{
    Activity, Command, Event, IdQueryOutcome, Refusal, ScanReport, StopReason, SurveyStatus,
};
use motorlink_protocol::{MotorId, Request};
use motorlink_simulator::{Echo, WireFaults, WorldConfig};

/// A bus on which nobody was asked yet.
fn unknown(motors: &[u8], faults: WireFaults, seed: u64) -> Bench {
    let ids = motors.iter().map(|address| id(*address));
    Bench::new(WorldConfig {
        seed,
        faults,
        ..WorldConfig::with_ids(ids)
    })
}

fn scan_ended(bench: &Bench) -> Option<ScanReport> {
    bench.events.iter().find_map(|(_, event)| match event {
        Event::ScanEnded(report) => Some(report.clone()),
        _ => None,
    })
}

fn scan(bench: &mut Bench) -> ScanReport {
    bench.forget_the_past();
    bench.command(Command::FullScan).unwrap();
    bench.run_until(ms(60_000), |bench| scan_ended(bench).is_some());
    scan_ended(bench).unwrap()
}

fn ids(motors: &[u8]) -> Vec<MotorId> {
    motors.iter().map(|address| id(*address)).collect()
}

#[test]
fn a_full_scan_finds_every_motor_and_invents_none() {
    for motors in [vec![1, 2, 3], vec![7, 100, 254], vec![200], vec![]] {
        let mut bench = unknown(&motors, WireFaults::default(), 1);
        let report = scan(&mut bench);
        assert_eq!(report.found, ids(&motors));
        assert!(report.complete && report.noisy.is_empty());
        assert_eq!(report.asked, 254);
        assert!(bench.bus.survey().is_none());
        let watched: Vec<_> = bench.bus.motors(bench.now).map(|motor| motor.id).collect();
        assert_eq!(
            watched,
            ids(&motors),
            "and asks those it found for telemetry"
        );
    }
}

#[test]
fn motors_appear_as_they_answer_and_progress_is_told() {
    let mut bench = unknown(&[5, 250], WireFaults::default(), 1);
    bench.command(Command::FullScan).unwrap();
    let mut before = 0;
    bench.run_until(ms(5_000), |bench| match bench.bus.survey() {
        Some(SurveyStatus::Scanning {
            asked,
            of,
            left_ms,
            found,
        }) => {
            assert_eq!(of, 254);
            assert!(asked >= before, "progress goes one way");
            assert!(left_ms < 10_000);
            before = asked;
            found == ids(&[5])
        }
        other => panic!("{other:?}"),
    });
    assert!(before < 20);
}

/// Two motors with one ID cannot be told apart, but their quarrel can be heard.
#[test]
fn an_address_that_two_motors_share_is_told_as_noisy() {
    let mut bench = unknown(&[4, 9], WireFaults::default(), 1);
    bench.world.add_motor(motorlink_simulator::MotorConfig {
        angle_deg: 123.0,
        ambient_c: 40.0,
        ..motorlink_simulator::MotorConfig::new(id(4))
    });
    let report = scan(&mut bench);
    assert_eq!(report.found, ids(&[9]));
    assert_eq!(report.noisy, ids(&[4]));
}

#[test]
fn what_is_driven_is_stopped_before_a_scan_and_drives_no_more() {
    for command in [Command::FullScan, Command::IdQuery] {
        let mut bench = Bench::one_motor();
        bench.drive(rpm(100)).unwrap();
        bench.run(ms(1_000));
        bench.forget_the_past();
        bench.command(command).unwrap();
        assert!(bench.happened(|event| *event == Event::StopBegan(StopReason::Survey)));
        assert!(matches!(bench.activity(), Activity::Stopping { .. }));
        bench.run_until(ms(2_000), |bench| {
            bench
                .sent
                .iter()
                .any(|sent| sent.request() == Request::IdQuery)
        });
        assert!(
            bench.true_rpm().abs() < 1.0,
            "it stands before anyone is asked"
        );
        assert_eq!(bench.drive(rpm(100)), Err(Refusal::Surveying));
        bench.run(ms(4_000));
        assert_eq!(bench.activity(), Activity::Idle);
        assert!(bench.true_rpm().abs() < 1.0, "and nothing starts it again");
        bench.drive(rpm(100)).unwrap();
    }
}

#[test]
fn a_scan_is_cancelled_at_once_by_its_button_and_by_every_stop() {
    for command in [
        Command::CancelSurvey,
        Command::StopAll(StopReason::Operator),
        Command::Stop(ID),
    ] {
        let mut bench = Bench::one_motor();
        bench.command(Command::FullScan).unwrap();
        bench.run(ms(500));
        bench.command(command).unwrap();
        let report = scan_ended(&bench).unwrap();
        assert!(!report.complete && report.asked > 0 && report.asked < 254);
        bench.forget_the_past();
        bench.run(ms(500));
        let asked_others =
            |sent: &bench::Sent| matches!(sent.request(), Request::Query { id } if id != ID);
        assert!(!bench.sent.iter().any(asked_others));
    }
}

#[test]
fn a_motor_that_was_found_stays_fresh_during_the_scan() {
    let mut bench = Bench::one_motor();
    bench.command(Command::FullScan).unwrap();
    for _ in 0..10 {
        bench.run(ms(100));
        let last = bench.status(ID).last.unwrap();
        assert!(bench.now.since(last.at) < ms(500));
    }
}

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
fn a_machine_that_is_held_up_now_and_then_makes_no_slow_scan() {
    let mut late = 0;
    for seed in 0..10 {
        let mut bench = unknown(&[1, 90, 254], WireFaults::default(), seed);
        bench.command(Command::FullScan).unwrap();
        while scan_ended(&bench).is_none() {
            bench.run(ms(90 + 7 * seed));
            bench.now = bench.now + ms(12);
            bench.world.advance(bench.now);
        }
        let report = scan_ended(&bench).unwrap();
        assert_eq!(report.found, ids(&[1, 90, 254]), "seed {seed}");
        assert!(report.noisy.is_empty(), "seed {seed}");
        assert!(
            report.took_ms <= 2_500,
            "seed {seed}: {} ms",
            report.took_ms
        );
        let motors = bench.bus.motors(bench.now);
        late += motors.map(|motor| motor.counters.late).sum::<u64>();
        late += bench.bus.line_status(bench.now).unaddressed.wrong_ids;
    }
    assert!(late > 10, "{late} replies were late");
}

/// However long it was held up: what it hands out then was not lost on the line, and no address has to be
/// asked once more for it.
#[test]
fn a_machine_that_stood_still_for_a_moment_makes_no_slow_scan() {
    for seed in 0..20 {
        let mut bench = unknown(&[1, 90, 254], WireFaults::default(), seed);
        bench.command(Command::FullScan).unwrap();
        while scan_ended(&bench).is_none() {
            bench.run(ms(430 + 7 * seed));
            bench.now = bench.now + ms(80);
            bench.world.advance(bench.now);
        }
        let report = scan_ended(&bench).unwrap();
        assert_eq!(report.found, ids(&[1, 90, 254]), "seed {seed}");
        assert!(
            report.took_ms <= 3_000,
            "seed {seed}: {} ms",
            report.took_ms
        );
    }
}

/// The figure over 1,000 seeds is printed by `cargo xtask bench`; here a few, so that a scan that
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
fn the_id_query_says_who_is_there() {
    for (motors, outcome) in [
        (vec![], IdQueryOutcome::Nobody),
        (vec![9], IdQueryOutcome::One(id(9))),
        (vec![1, 2, 3], IdQueryOutcome::Garbled),
    ] {
        let mut bench = unknown(&motors, WireFaults::default(), 1);
        bench.command(Command::IdQuery).unwrap();
        bench.run(ms(100));
        assert!(
            bench.happened(|event| *event == Event::IdQueryEnded(outcome)),
            "{motors:?}: {:?}",
            bench.events
        );
    }
}
