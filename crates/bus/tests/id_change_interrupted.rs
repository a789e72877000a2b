//! A stop, the port, the page or a bad line interrupts an ID change: what it reports is true.

use crate::fixture;
use crate::fixture::id_changes::{change, is_set_id, outcome, scanned, set_id, to};
use crate::fixture::{ID, id, ms};
use motorlink_bus::{Command, Event, IdChangeOutcome, LineEventKind, Refusal, StopReason};
use motorlink_protocol::Request;
use motorlink_simulator::{Echo, MotorConfig, WireFaults, WorldConfig};

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
