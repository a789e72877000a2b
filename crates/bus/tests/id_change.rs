//! Giving a motor another ID: proved before, verified after, never by accident.
#![cfg(test)]

mod fixture;

use fixture::{Fixture, ID, id, ms, rpm};
use motorlink_bus::{
    Command, Event, IdChangeOutcome, LineEventKind, Refusal, SetIdFrames, StopReason,
};
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

fn is_set_id(sent: &fixture::Sent) -> bool {
    matches!(sent.request(), Request::SetId { .. })
}

fn outcome(fixture: &Fixture) -> Option<IdChangeOutcome> {
    fixture.events.iter().find_map(|(_, event)| match event {
        Event::IdChangeEnded { outcome, .. } => Some(*outcome),
        _ => None,
    })
}

/// A fixture on which a full scan has just ended.
fn scanned(config: WorldConfig) -> Fixture {
    let mut fixture = Fixture::new(config);
    fixture.command(Command::FullScan).unwrap();
    fixture.run_until(ms(30_000), |fixture| {
        fixture.happened(|event| matches!(event, Event::ScanEnded(_)))
    });
    fixture.forget_the_past();
    fixture
}

fn change(fixture: &mut Fixture, command: Command) -> IdChangeOutcome {
    fixture.command(command).unwrap();
    fixture.run_until(ms(10_000), |fixture| outcome(fixture).is_some());
    outcome(fixture).unwrap()
}

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
fn a_motor_that_dies_meanwhile_is_reported_as_lost() {
    let mut fixture = scanned(WorldConfig::default());
    fixture.command(set_id(ID, 5)).unwrap();
    fixture.run_until(ms(1_000), |fixture| fixture.sent.iter().any(is_set_id));
    fixture.world.remove_motor(ID);
    fixture.run_until(ms(10_000), |fixture| outcome(fixture).is_some());
    assert_eq!(outcome(&fixture), Some(IdChangeOutcome::Lost));
}

#[test]
fn a_stop_ends_an_id_change_at_once_and_says_that_frames_were_sent() {
    let mut fixture = scanned(WorldConfig::default());
    fixture.command(set_id(ID, 5)).unwrap();
    fixture.run_until(ms(1_000), |fixture| {
        fixture.sent.iter().filter(|sent| is_set_id(sent)).count() == 2
    });
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    assert_eq!(
        outcome(&fixture),
        Some(IdChangeOutcome::Cancelled { frames_sent: 2 })
    );
    fixture.run(ms(1_000));
    assert_eq!(
        fixture.sent.iter().filter(|sent| is_set_id(sent)).count(),
        2
    );
    assert!(fixture.world.motor(ID).is_some());
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

/// Forty changes on a bad line: a lost reply may make the outcome unsure, never wrong.
#[test]
fn on_a_bad_line_the_outcome_is_never_wrong() {
    let mut changed = 0;
    for seed in 0..40 {
        let mut fixture = scanned(WorldConfig {
            seed,
            faults: WireFaults {
                echo: Echo::Whole,
                lose_reply: 0.1,
                lose_request: 0.05,
                ..WireFaults::default()
            },
            ..WorldConfig::default()
        });
        match fixture.command(set_id(ID, 5)) {
            Err(Refusal::NotProvedAlone) => continue,
            refused => refused.unwrap(),
        }
        fixture.run_until(ms(20_000), |fixture| outcome(fixture).is_some());
        let has_new = fixture.world.motor(id(5)).is_some();
        match outcome(&fixture).unwrap() {
            IdChangeOutcome::Changed => {
                assert!(has_new, "seed {seed}");
                changed += 1;
            }
            IdChangeOutcome::Kept { .. } => assert!(!has_new, "seed {seed}"),
            IdChangeOutcome::NotAlone => {
                assert!(!fixture.sent.iter().any(is_set_id), "seed {seed}");
            }
            other => panic!("seed {seed}: {other:?}"),
        }
    }
    assert!(changed >= 20, "{changed} of 40");
}

/// A second motor with the old ID: its corrupt replies are noise at the old ID.
#[test]
fn noise_at_the_old_id_ends_with_both() {
    let mut fixture = scanned(WorldConfig::default());
    fixture.command(set_id(ID, 5)).unwrap();
    let probes_new = |sent: &fixture::Sent| sent.request() == Request::Query { id: id(5) };
    fixture.run_until(ms(5_000), |fixture| fixture.sent.iter().any(probes_new));
    fixture.run(ms(10));
    fixture.world.add_motor(MotorConfig::new(ID));
    fixture.world.set_faults(WireFaults {
        corrupt_reply: 1.0,
        ..WireFaults::default()
    });
    fixture.run_until(ms(5_000), |fixture| outcome(fixture).is_some());
    assert_eq!(outcome(&fixture), Some(IdChangeOutcome::Both));
    let is_junk = |event: &Event| match event {
        Event::Line(event) => matches!(event.kind, LineEventKind::Junk(_)),
        _ => false,
    };
    assert!(fixture.happened(is_junk));
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

#[test]
fn silence_of_the_old_id_is_logged() {
    let mut fixture = scanned(WorldConfig::default());
    assert_eq!(
        change(&mut fixture, set_id(ID, 5)),
        IdChangeOutcome::Changed
    );
    let is_silence = |event: &Event| match event {
        Event::Line(event) => {
            matches!(event.kind, LineEventKind::Silence { id, .. } if id == ID)
        }
        _ => false,
    };
    assert!(fixture.happened(is_silence));
}

/// The other motor collides in one check only and is silent afterwards.
#[test]
fn collision_in_one_check_ends_the_id_change() {
    let mut fixture = scanned(WorldConfig::default());
    fixture.world.add_motor(MotorConfig {
        angle_deg: 77.0,
        ..MotorConfig::new(id(7))
    });
    fixture.command(set_id(ID, 5)).unwrap();
    fixture.run(ms(50));
    fixture.world.motor_mut(id(7)).unwrap().mute(true);
    fixture.run(ms(5_000));
    assert!(!fixture.sent.iter().any(is_set_id));
    assert_eq!(outcome(&fixture), Some(IdChangeOutcome::NotAlone));
}

#[test]
fn id_change_that_ends_with_its_port_reports_the_frames_sent() {
    let mut fixture = scanned(WorldConfig::default());
    fixture.command(set_id(ID, 5)).unwrap();
    fixture.run_until(ms(1_000), |fixture| {
        fixture.sent.iter().filter(|sent| is_set_id(sent)).count() == 3
    });
    let events: Vec<Event> = fixture.bus.close(fixture.now).collect();
    let cancelled = Event::IdChangeEnded {
        from: ID,
        to: to(5),
        outcome: IdChangeOutcome::Cancelled { frames_sent: 3 },
    };
    assert!(events.contains(&cancelled), "{events:?}");
}

#[test]
fn silent_page_cancels_an_id_change() {
    let mut fixture = scanned(WorldConfig::default());
    fixture.page_lives = false;
    fixture.run(ms(700));
    fixture.command(set_id(ID, 5)).unwrap();
    fixture.run_until(ms(1_000), |fixture| outcome(fixture).is_some());
    let outcome = outcome(&fixture).unwrap();
    assert!(
        matches!(outcome, IdChangeOutcome::Cancelled { .. }),
        "{outcome:?}"
    );
    assert_eq!(fixture.bus.job(), None);
}
