//! The full scan on a good line.

use crate::fixture;
use crate::fixture::scans::{ids, scan, scan_ended, unknown};
use crate::fixture::{Fixture, ID, id, ms, rpm, to};
use motorlink_bus::{Activity, Command, Event, JobStatus, Refusal, SetIdFrames, StopReason};
use motorlink_protocol::Request;
use motorlink_simulator::{MotorConfig, WireFaults, WorldConfig};

#[test]
fn a_full_scan_finds_every_motor_and_invents_none() {
    for motors in [vec![1, 2, 3], vec![7, 100, 254], vec![200], vec![]] {
        let mut fixture = unknown(&motors, WireFaults::default(), 1);
        let report = scan(&mut fixture);
        assert_eq!(report.found, ids(&motors));
        assert!(report.complete && report.noisy.is_empty());
        assert_eq!(report.asked, 254);
        assert!(fixture.bus.job().is_none());
        let watched: Vec<_> = fixture
            .bus
            .motors(fixture.now)
            .map(|motor| motor.id)
            .collect();
        assert_eq!(
            watched,
            ids(&motors),
            "and asks those it found for telemetry"
        );
    }
}

#[test]
fn motors_appear_as_they_answer_and_progress_is_reported() {
    let mut fixture = unknown(&[5, 250], WireFaults::default(), 1);
    fixture.command(Command::FullScan).unwrap();
    let mut before = 0;
    fixture.run_until(ms(5_000), |fixture| match fixture.bus.job() {
        Some(JobStatus::Scanning {
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

/// Two motors with one ID cannot be told apart, but their replies collide.
#[test]
fn an_address_that_two_motors_share_is_reported_as_noisy() {
    let mut fixture = unknown(&[4, 9], WireFaults::default(), 1);
    fixture.world.add_motor(MotorConfig {
        angle_deg: 123.0,
        ambient_c: 40.0,
        ..MotorConfig::new(id(4))
    });
    let report = scan(&mut fixture);
    assert_eq!(report.found, ids(&[9]));
    assert_eq!(report.noisy, ids(&[4]));
}

#[test]
fn what_is_driven_is_stopped_before_a_scan_and_drives_no_more() {
    for command in [Command::FullScan, Command::IdQuery] {
        let mut fixture = Fixture::one_motor();
        fixture.drive(rpm(100)).unwrap();
        fixture.run(ms(1_000));
        fixture.forget_the_past();
        fixture.command(command).unwrap();
        assert!(fixture.happened(|event| *event == Event::StopBegan(StopReason::Job)));
        assert!(matches!(fixture.activity(), Activity::Stopping { .. }));
        fixture.run_until(ms(2_000), |fixture| {
            fixture
                .sent
                .iter()
                .any(|sent| sent.request() == Request::IdQuery)
        });
        assert!(
            fixture.true_rpm().abs() < 1.0,
            "it stands before anyone is asked"
        );
        assert_eq!(fixture.drive(rpm(100)), Err(Refusal::JobRunning));
        fixture.run(ms(4_000));
        assert_eq!(fixture.activity(), Activity::Idle);
        assert!(
            fixture.true_rpm().abs() < 1.0,
            "and nothing starts it again"
        );
        fixture.drive(rpm(100)).unwrap();
    }
}

#[test]
fn a_scan_is_cancelled_at_once_by_its_button_and_by_every_stop() {
    for command in [
        Command::CancelJob,
        Command::StopAll(StopReason::Operator),
        Command::Stop(ID),
    ] {
        let mut fixture = Fixture::one_motor();
        fixture.command(Command::FullScan).unwrap();
        fixture.run(ms(500));
        fixture.command(command).unwrap();
        let report = scan_ended(&fixture).unwrap();
        assert!(!report.complete && report.asked > 0 && report.asked < 254);
        fixture.forget_the_past();
        fixture.run(ms(500));
        let asked_others =
            |sent: &fixture::Sent| matches!(sent.request(), Request::Query { id } if id != ID);
        assert!(!fixture.sent.iter().any(asked_others));
    }
}

#[test]
fn a_motor_that_was_found_stays_fresh_during_the_scan() {
    let mut fixture = Fixture::one_motor();
    fixture.command(Command::FullScan).unwrap();
    for _ in 0..10 {
        fixture.run(ms(100));
        let last = fixture.status(ID).last.unwrap();
        assert!(fixture.now.since(last.at) < ms(500));
    }
}

/// Two motors with one ID may look like one where replies are lost. No scan may prove that.
#[test]
fn scan_of_two_motors_with_one_id_proves_nothing() {
    let lossy = WireFaults {
        lose_reply: 0.05,
        ..WireFaults::default()
    };
    for seed in 0..40 {
        let mut fixture = unknown(&[4], lossy.clone(), seed);
        fixture.world.add_motor(MotorConfig {
            angle_deg: 123.0,
            ambient_c: 40.0,
            ..MotorConfig::new(id(4))
        });
        let report = scan(&mut fixture);
        assert!(report.complete, "seed {seed}");
        let noticed = report.found.contains(&id(4)) || report.noisy.contains(&id(4));
        assert!(noticed, "seed {seed}: {report:?}");
        let set_id = Command::SetId {
            from: id(4),
            to: to(5),
            frames: SetIdFrames::Five,
        };
        let refused = fixture.command(set_id);
        assert_eq!(refused, Err(Refusal::NotProvedAlone), "seed {seed}");
    }
}

#[test]
fn scan_during_a_stop_of_all_keeps_the_reason_of_the_stop() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(500));
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    fixture.run(ms(20));
    fixture.command(Command::FullScan).unwrap();
    assert_eq!(fixture.bus.job(), Some(JobStatus::Stopping));
    fixture.run(ms(1_000));
    let reason = fixture.events.iter().find_map(|(_, event)| match event {
        Event::StopEnded(report) => Some(report.reason),
        _ => None,
    });
    assert_eq!(reason, Some(StopReason::Operator));
}

#[test]
fn every_request_of_a_scan_is_counted_with_its_end() {
    let mut fixture = Fixture::new(WorldConfig::default());
    scan(&mut fixture);
    let counters = fixture.bus.line_status(fixture.now).unaddressed;
    assert!(counters.requests >= 253, "{counters:?}");
    let ends = counters.replies + counters.silences + counters.bad_crcs + counters.fragments;
    // The second reply of motor 1 makes it known; it has counters of its own from then on.
    assert!(counters.requests.abs_diff(ends) <= 4, "{counters:?}");
}

#[test]
fn silent_page_cancels_a_scan() {
    let mut fixture = Fixture::one_motor();
    fixture.command(Command::FullScan).unwrap();
    fixture.run(ms(10));
    assert!(fixture.bus.job().is_some());
    fixture.page_lives = false;
    fixture.run_until(ms(1_500), |fixture| scan_ended(fixture).is_some());
    let report = scan_ended(&fixture).unwrap();
    assert!(!report.complete && report.asked < 254, "{report:?}");
    assert_eq!(fixture.bus.job(), None);
}
