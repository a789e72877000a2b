//! Giving a motor another ID: proved before, verified after, never by accident.
#![allow(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::panic,
    reason = "a test that cannot go on fails"
)]

mod bench;

use bench::{Bench, ID, id, ms, rpm};
use motorlink_bus::{Command, Event, IdChangeOutcome, Refusal, Repeat, SetIdFrames, StopReason};
use motorlink_protocol::{AssignableId, MotorId, Request};
use motorlink_simulator::{Echo, MotorConfig, WireFaults, WorldConfig};

fn to(address: u8) -> AssignableId {
    AssignableId::new(id(address)).unwrap()
}

fn set_id(from: MotorId, address: u8) -> Command {
    more(from, address, SetIdFrames::Five)
}

fn more(from: MotorId, address: u8, frames: SetIdFrames) -> Command {
    let to = to(address);
    Command::SetId { from, to, frames }
}

fn is_set_id(sent: &bench::Sent) -> bool {
    matches!(sent.request(), Request::SetId { .. })
}

fn outcome(bench: &Bench) -> Option<IdChangeOutcome> {
    bench.events.iter().find_map(|(_, event)| match event {
        Event::IdChangeEnded { outcome, .. } => Some(*outcome),
        _ => None,
    })
}

/// A bench on which a full scan has just ended.
fn scanned(config: WorldConfig) -> Bench {
    let mut bench = Bench::new(config);
    bench.command(Command::FullScan).unwrap();
    bench.run_until(ms(30_000), |bench| {
        bench.happened(|event| matches!(event, Event::ScanEnded(_)))
    });
    bench.forget_the_past();
    bench
}

fn change(bench: &mut Bench, command: Command) -> IdChangeOutcome {
    bench.command(command).unwrap();
    bench.run_until(ms(10_000), |bench| outcome(bench).is_some());
    outcome(bench).unwrap()
}

#[test]
fn five_frames_in_a_row_and_then_the_new_id_answers_and_the_old_one_is_silent() {
    let mut bench = scanned(WorldConfig::default());
    assert_eq!(change(&mut bench, set_id(ID, 5)), IdChangeOutcome::Changed);
    let first = bench.sent.iter().position(is_set_id).unwrap();
    assert_eq!(bench.sent.iter().filter(|sent| is_set_id(sent)).count(), 5);
    assert!(
        bench.sent[first..first + 5].iter().all(is_set_id),
        "nothing between them"
    );
    assert!(bench.world.motor(id(5)).is_some() && bench.world.motor(ID).is_none());
    assert_eq!(bench.status(id(5)).id, id(5));
    assert!(
        bench.bus.motors(bench.now).all(|motor| motor.id != ID),
        "the old one is forgotten"
    );
    bench.run(ms(3_000));
    assert!(!bench.happened(|event| *event == Event::MotorSilent(ID)));
}

#[test]
fn no_id_is_set_before_a_full_scan_has_found_exactly_one_motor() {
    let mut bench = Bench::one_motor();
    assert_eq!(bench.command(set_id(ID, 5)), Err(Refusal::NotProvedAlone));

    for (motors, from) in [(vec![1, 2], ID), (vec![], ID), (vec![9], ID)] {
        let ids = motors.iter().map(|address| id(*address));
        let mut bench = scanned(WorldConfig::with_ids(ids));
        assert_eq!(
            bench.command(set_id(from, 5)),
            Err(Refusal::NotProvedAlone),
            "{motors:?}"
        );
    }
    let mut cancelled = Bench::one_motor();
    cancelled.command(Command::FullScan).unwrap();
    cancelled.run(ms(500));
    cancelled.command(Command::CancelSurvey).unwrap();
    assert_eq!(
        cancelled.command(set_id(ID, 5)),
        Err(Refusal::NotProvedAlone)
    );
}

#[test]
fn a_proof_lasts_a_minute_and_ends_when_another_motor_speaks_or_it_was_used() {
    let mut bench = scanned(WorldConfig::default());
    bench.run(ms(61_000));
    assert_eq!(bench.command(set_id(ID, 5)), Err(Refusal::NotProvedAlone));

    let mut bench = scanned(WorldConfig::default());
    bench.world.add_motor(MotorConfig::new(id(7)));
    bench.command(Command::Watch(id(7))).unwrap();
    bench.run(ms(300));
    assert_eq!(bench.command(set_id(ID, 5)), Err(Refusal::NotProvedAlone));

    let mut bench = scanned(WorldConfig::default());
    change(&mut bench, set_id(ID, 5));
    assert_eq!(
        bench.command(set_id(id(5), 6)),
        Err(Refusal::NotProvedAlone)
    );
}

#[test]
fn a_motor_that_was_plugged_in_after_the_scan_is_noticed_before_the_first_frame() {
    let mut bench = scanned(WorldConfig::default());
    bench.world.add_motor(MotorConfig::new(id(7)));
    assert_eq!(change(&mut bench, set_id(ID, 5)), IdChangeOutcome::NotAlone);
    assert!(!bench.sent.iter().any(is_set_id));
}

#[test]
fn the_id_it_has_already_is_refused() {
    let mut bench = scanned(WorldConfig::default());
    assert_eq!(bench.command(set_id(ID, 1)), Err(Refusal::SameId(ID)));
}

/// The firmware takes one ID a power cycle.
#[test]
fn a_motor_that_has_taken_an_id_since_power_up_keeps_it() {
    let mut bench = scanned(WorldConfig::default());
    assert_eq!(change(&mut bench, set_id(ID, 5)), IdChangeOutcome::Changed);
    bench.forget_the_past();
    bench.command(Command::FullScan).unwrap();
    bench.run_until(ms(10_000), |bench| {
        bench.happened(|event| matches!(event, Event::ScanEnded(_)))
    });
    bench.forget_the_past();
    let frames = SetIdFrames::Five;
    let kept = IdChangeOutcome::Kept { frames };
    assert_eq!(change(&mut bench, set_id(id(5), 6)), kept);
    assert!(bench.world.motor(id(5)).is_some());
}

/// M0601 units are reported to take more than five.
#[test]
fn a_motor_that_needs_more_frames_takes_them_after_a_verified_failure() {
    for needed in [6, 10, 13, 40, 41] {
        let mut bench = scanned(WorldConfig {
            motors: vec![MotorConfig {
                set_id_frames: needed,
                ..MotorConfig::default()
            }],
            ..WorldConfig::default()
        });
        let mut frames = Some(SetIdFrames::default());
        while let Some(sent) = frames {
            bench.forget_the_past();
            let ended = change(&mut bench, more(ID, 5, sent));
            let on_the_wire = bench.sent.iter().filter(|sent| is_set_id(sent)).count();
            assert_eq!(on_the_wire, usize::from(sent.count()));
            if sent.count() >= needed {
                assert_eq!(ended, IdChangeOutcome::Changed, "{needed}");
                frames = None;
            } else {
                assert_eq!(ended, IdChangeOutcome::Kept { frames: sent }, "{needed}");
                frames = sent.more();
                assert_eq!(
                    bench.command(more(ID, 5, SetIdFrames::MAX)),
                    Err(Refusal::NotProvedAlone),
                    "each time it is proved once more"
                );
                bench.command(Command::FullScan).unwrap();
                bench.run_until(ms(30_000), |bench| {
                    bench.happened(|event| matches!(event, Event::ScanEnded(_)))
                });
            }
        }
        let within = needed <= SetIdFrames::MAX.count();
        assert_eq!(bench.world.motor(id(5)).is_some(), within, "{needed}");
    }
}

#[test]
fn a_motor_that_dies_meanwhile_is_told_as_lost() {
    let mut bench = scanned(WorldConfig::default());
    bench.command(set_id(ID, 5)).unwrap();
    bench.run_until(ms(1_000), |bench| bench.sent.iter().any(is_set_id));
    bench.world.remove_motor(ID);
    bench.run_until(ms(10_000), |bench| outcome(bench).is_some());
    assert_eq!(outcome(&bench), Some(IdChangeOutcome::Lost));
}

#[test]
fn a_stop_ends_an_id_change_at_once_and_says_that_frames_were_sent() {
    let mut bench = scanned(WorldConfig::default());
    bench.command(set_id(ID, 5)).unwrap();
    bench.run_until(ms(1_000), |bench| {
        bench.sent.iter().filter(|sent| is_set_id(sent)).count() == 2
    });
    bench
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    assert_eq!(
        outcome(&bench),
        Some(IdChangeOutcome::Cancelled { frames_sent: 2 })
    );
    bench.run(ms(1_000));
    assert_eq!(bench.sent.iter().filter(|sent| is_set_id(sent)).count(), 2);
    assert!(bench.world.motor(ID).is_some());
}

#[test]
fn what_is_driven_stands_before_an_id_is_set() {
    let mut bench = scanned(WorldConfig::default());
    bench.drive(rpm(100)).unwrap();
    bench.run(ms(1_000));
    bench.forget_the_past();
    bench.command(set_id(ID, 5)).unwrap();
    bench.run_until(ms(2_000), |bench| bench.sent.iter().any(is_set_id));
    assert!(bench.true_rpm().abs() < 1.0);
}

/// Forty changes on a bad line: a lost reply may make the outcome unsure, never wrong.
#[test]
fn on_a_bad_line_the_outcome_is_never_wrong() {
    let mut changed = 0;
    for seed in 0..40 {
        let mut bench = scanned(WorldConfig {
            seed,
            faults: WireFaults {
                echo: Echo::Whole,
                lose_reply: 0.1,
                lose_request: 0.05,
                ..WireFaults::default()
            },
            ..WorldConfig::default()
        });
        match bench.command(set_id(ID, 5)) {
            Err(Refusal::NotProvedAlone) => continue,
            refused => refused.unwrap(),
        }
        bench.run_until(ms(20_000), |bench| outcome(bench).is_some());
        let has_new = bench.world.motor(id(5)).is_some();
        match outcome(&bench).unwrap() {
            IdChangeOutcome::Changed => {
                assert!(has_new, "seed {seed}");
                changed += 1;
            }
            IdChangeOutcome::Kept { .. } => assert!(!has_new, "seed {seed}"),
            IdChangeOutcome::NotAlone => assert!(!bench.sent.iter().any(is_set_id), "seed {seed}"),
            other => panic!("seed {seed}: {other:?}"),
        }
    }
    assert!(changed >= 20, "{changed} of 40");
}

#[test]
fn a_set_id_frame_that_a_person_wrote_needs_the_same_proof() {
    let frame = Request::SetId { id: to(5) }.frame();
    let raw = Command::SendRaw {
        frame,
        repeat: Repeat::Once,
        consent: motorlink_bus::Consent::None,
    };
    let mut bench = Bench::one_motor();
    assert_eq!(bench.command(raw), Err(Refusal::NotProvedAlone));
    let mut bench = scanned(WorldConfig::default());
    bench.command(raw).unwrap();
    bench.run(ms(100)); // behind the ID query
    assert!(bench.sent.iter().any(is_set_id));
}
