//! Giving a motor another ID: proved before, verified after, never by accident.

use crate::fixture;
use crate::fixture::id_changes::{change, is_set_id, more, outcome, scanned, set_id};
use crate::fixture::{Fixture, ID, id, ms, rpm};
use motorlink_bus::{Command, Event, IdChangeOutcome, Refusal, SetIdFrames};
use motorlink_simulator::{MotorConfig, WireFaults, WorldConfig};

#[test]
fn five_frames_in_a_row_and_then_the_new_id_answers_and_the_old_one_is_silent() {
    let mut fixture = scanned(WorldConfig::default());
    assert_eq!(
        change(&mut fixture, set_id(ID, 5)),
        IdChangeOutcome::Changed
    );
    let first = fixture.sent.iter().position(is_set_id).unwrap();
    assert_eq!(
        fixture.sent.iter().filter(|sent| is_set_id(sent)).count(),
        5
    );
    assert!(
        fixture.sent[first..first + 5].iter().all(is_set_id),
        "nothing between them"
    );
    assert!(fixture.world.motor(id(5)).is_some() && fixture.world.motor(ID).is_none());
    assert_eq!(fixture.status(id(5)).id, id(5));
    assert!(
        fixture.bus.motors(fixture.now).all(|motor| motor.id != ID),
        "the old one is forgotten"
    );
    fixture.run(ms(3_000));
    assert!(!fixture.happened(|event| matches!(event, Event::MotorSilent { .. })));
}

#[test]
fn no_id_is_set_before_a_full_scan_has_found_exactly_one_motor() {
    let mut fixture = Fixture::one_motor();
    assert_eq!(fixture.command(set_id(ID, 5)), Err(Refusal::NotProvedAlone));

    for (motors, from) in [(vec![1, 2], ID), (vec![], ID), (vec![9], ID)] {
        let ids = motors.iter().map(|address| id(*address));
        let mut fixture = scanned(WorldConfig::with_ids(ids));
        assert_eq!(
            fixture.command(set_id(from, 5)),
            Err(Refusal::NotProvedAlone),
            "{motors:?}"
        );
    }
    let mut cancelled = Fixture::one_motor();
    cancelled.command(Command::FullScan).unwrap();
    cancelled.run(ms(500));
    cancelled.command(Command::CancelJob).unwrap();
    assert_eq!(
        cancelled.command(set_id(ID, 5)),
        Err(Refusal::NotProvedAlone)
    );
}

#[test]
fn a_proof_lasts_a_minute_and_ends_when_another_motor_speaks_or_it_was_used() {
    let mut fixture = scanned(WorldConfig::default());
    fixture.run(ms(61_000));
    assert_eq!(fixture.command(set_id(ID, 5)), Err(Refusal::NotProvedAlone));

    let mut fixture = scanned(WorldConfig::default());
    fixture.world.add_motor(MotorConfig::new(id(7)));
    fixture.command(Command::Watch(id(7))).unwrap();
    fixture.run(ms(300));
    assert_eq!(fixture.command(set_id(ID, 5)), Err(Refusal::NotProvedAlone));

    let mut fixture = scanned(WorldConfig::default());
    change(&mut fixture, set_id(ID, 5));
    assert_eq!(
        fixture.command(set_id(id(5), 6)),
        Err(Refusal::NotProvedAlone)
    );
}

#[test]
fn a_motor_that_was_plugged_in_after_the_scan_is_noticed_before_the_first_frame() {
    let mut fixture = scanned(WorldConfig::default());
    fixture.world.add_motor(MotorConfig::new(id(7)));
    assert_eq!(
        change(&mut fixture, set_id(ID, 5)),
        IdChangeOutcome::NotAlone
    );
    assert!(!fixture.sent.iter().any(is_set_id));
}

/// A busy computer or adapter holds replies back, or queries.
#[test]
fn replies_that_come_late_together_are_not_another_motor() {
    for stall in (20..300).step_by(20) {
        for after in (0..1_500).step_by(61) {
            for holds_replies in [true, false] {
                let mut fixture = scanned(WorldConfig::default());
                fixture.command(set_id(ID, 5)).unwrap();
                fixture.run(ms(after));
                if holds_replies {
                    fixture.world.set_faults(WireFaults {
                        hold: ms(stall),
                        ..WireFaults::default()
                    });
                    fixture.run(ms(stall));
                    fixture.world.set_faults(WireFaults::default());
                } else {
                    fixture.stall(ms(stall));
                }
                fixture.run_until(ms(10_000), |fixture| outcome(fixture).is_some());
                assert_eq!(
                    outcome(&fixture),
                    Some(IdChangeOutcome::Changed),
                    "{stall} ms, {after} ms after the command, of replies: {holds_replies}"
                );
            }
        }
    }
}

#[test]
fn the_id_it_has_already_is_refused() {
    let mut fixture = scanned(WorldConfig::default());
    assert_eq!(fixture.command(set_id(ID, 1)), Err(Refusal::SameId(ID)));
}

/// The firmware takes one ID a power cycle.
#[test]
fn a_motor_that_has_taken_an_id_since_power_up_keeps_it() {
    let mut fixture = scanned(WorldConfig::default());
    assert_eq!(
        change(&mut fixture, set_id(ID, 5)),
        IdChangeOutcome::Changed
    );
    fixture.forget_the_past();
    fixture.command(Command::FullScan).unwrap();
    fixture.run_until(ms(10_000), |fixture| {
        fixture.happened(|event| matches!(event, Event::ScanEnded(_)))
    });
    fixture.forget_the_past();
    let frames = SetIdFrames::Five;
    let kept = IdChangeOutcome::Kept { frames };
    assert_eq!(change(&mut fixture, set_id(id(5), 6)), kept);
    assert!(fixture.world.motor(id(5)).is_some());
}

/// M0601 units are reported to take more than five.
#[test]
fn a_motor_that_needs_more_frames_takes_them_after_a_verified_failure() {
    for needed in [6, 10, 13, 40, 41] {
        let mut fixture = scanned(WorldConfig {
            motors: vec![MotorConfig {
                set_id_frames: needed,
                ..MotorConfig::default()
            }],
            ..WorldConfig::default()
        });
        let mut frames = Some(SetIdFrames::default());
        while let Some(sent) = frames {
            fixture.forget_the_past();
            let ended = change(&mut fixture, more(ID, 5, sent));
            let on_the_wire = fixture.sent.iter().filter(|sent| is_set_id(sent)).count();
            assert_eq!(on_the_wire, usize::from(sent.count()));
            if sent.count() >= needed {
                assert_eq!(ended, IdChangeOutcome::Changed, "{needed}");
                frames = None;
            } else {
                assert_eq!(ended, IdChangeOutcome::Kept { frames: sent }, "{needed}");
                frames = sent.more();
                assert_eq!(
                    fixture.command(more(ID, 5, SetIdFrames::MAX)),
                    Err(Refusal::NotProvedAlone),
                    "each time it is proved once more"
                );
                fixture.command(Command::FullScan).unwrap();
                fixture.run_until(ms(30_000), |fixture| {
                    fixture.happened(|event| matches!(event, Event::ScanEnded(_)))
                });
            }
        }
        let within = needed <= SetIdFrames::MAX.count();
        assert_eq!(fixture.world.motor(id(5)).is_some(), within, "{needed}");
    }
}

#[test]
fn what_is_driven_stands_before_an_id_is_set() {
    let mut fixture = scanned(WorldConfig::default());
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    fixture.forget_the_past();
    fixture.command(set_id(ID, 5)).unwrap();
    fixture.run_until(ms(2_000), |fixture| fixture.sent.iter().any(is_set_id));
    assert!(fixture.true_rpm().abs() < 1.0);
}

#[test]
fn wheel_coasting_after_raw_frames_stands_before_an_id_is_set() {
    let mut fixture = scanned(WorldConfig::default());
    let frame = fixture::drive_frame(ID, rpm(100));
    fixture
        .command(fixture::raw(frame, fixture::every(50, 20)))
        .unwrap();
    fixture.run(ms(1_050));
    assert!(fixture.true_rpm() > 50.0, "{}", fixture.true_rpm());
    fixture.forget_the_past();
    fixture.command(set_id(ID, 5)).unwrap();
    fixture.run_until(ms(5_000), |fixture| fixture.sent.iter().any(is_set_id));
    assert!(fixture.true_rpm().abs() < 1.0, "{}", fixture.true_rpm());
}
