//! A driven motor whose drive frames are withheld for a time, to measure what its firmware does then.

use crate::fixture;
use std::time::Duration;

use crate::fixture::{Fixture, ID, Sent, id, ms, rpm};
use motorlink_bus::{Activity, Command, Event, Refusal, StopReason, WITHHELD_MAX, Withheld};
use motorlink_protocol::{Mode, MotorId, family::Model};
use motorlink_simulator::{WireFaults, WorldConfig};

const SILENCE: Duration = Duration::from_millis(600);
const ALMOST: Duration = Duration::from_millis(599);

/// A motor at 30 rpm.
fn driven(config: WorldConfig) -> Fixture {
    let mut fixture = Fixture::watching(config, &[ID]);
    fixture.drive(rpm(30)).unwrap();
    fixture.run(ms(1_000));
    fixture.forget_the_past();
    fixture
}

fn withhold(fixture: &mut Fixture, time: Duration, requests: Withheld) -> Result<(), Refusal> {
    fixture.bus.withhold(fixture.now, ID, time, requests)
}

/// Whether a drive frame was sent, of any model.
fn drove(fixture: &Fixture) -> bool {
    let mut sent = fixture.sent.iter();
    sent.any(|sent| sent.frame.bytes().starts_with(&[1, 0x64]))
}

fn is_driven(fixture: &Fixture) -> bool {
    matches!(fixture.activity(), Activity::Driven { .. })
}

fn is_stopping(fixture: &Fixture) -> bool {
    matches!(fixture.activity(), Activity::Stopping { .. })
}

#[test]
fn a_motor_without_drive_frames_is_asked_as_often_as_it_was_driven_and_stays_driven() {
    let mut fixture = driven(WorldConfig::default());
    withhold(&mut fixture, SILENCE, Withheld::DriveFrames).unwrap();
    fixture.run(ALMOST);
    assert_eq!(fixture.drive_times(ID), []);
    let queries = fixture.sent.iter().filter(|sent| sent.is_query()).count();
    // 50 Hz, the rate of commands.
    assert!((28..=32).contains(&queries), "{queries}");
    assert!(is_driven(&fixture), "{:?}", fixture.events);
    fixture.forget_the_past();
    fixture.run(ms(200));
    assert!(fixture.drive_times(ID).len() >= 9, "driven again");
    assert!(is_driven(&fixture), "{:?}", fixture.events);
}

#[test]
fn a_line_without_requests_carries_no_frame_and_a_query_soon_follows_its_end() {
    for other in [false, true] {
        let ids: &[MotorId] = if other { &[ID, id(2)] } else { &[ID] };
        let mut fixture = driven(WorldConfig::with_ids(ids.iter().copied()));
        withhold(&mut fixture, SILENCE, Withheld::Requests).unwrap();
        // The exchange in flight has been sent before.
        fixture.run(ALMOST);
        assert!(fixture.sent.is_empty(), "{:?}", fixture.sent);
        assert!(is_driven(&fixture), "{:?}", fixture.events);
        withhold(&mut fixture, ms(200), Withheld::DriveFrames).unwrap();
        fixture.run(ms(30));
        assert!(fixture.sent.iter().any(Sent::is_query));
        assert_eq!(fixture.drive_times(ID), []);
        fixture.run(ms(300));
        assert!(!fixture.drive_times(ID).is_empty(), "driven again");
        assert!(is_driven(&fixture), "{:?}", fixture.events);
    }
}

#[test]
fn frames_are_never_withheld_for_longer_than_a_second_in_a_row() {
    for requests in [Withheld::DriveFrames, Withheld::Requests] {
        let mut fixture = driven(WorldConfig::default());
        let began = fixture.now;
        for _ in 0..30 {
            withhold(&mut fixture, ms(5_000), requests).unwrap();
            fixture.run(ms(50));
            if let Some(first) = fixture.drive_times(ID).first() {
                let after = first.since(began);
                assert!(after <= WITHHELD_MAX + ms(25), "{after:?}");
                break;
            }
        }
        assert!(!fixture.drive_times(ID).is_empty(), "never driven again");
    }
}

#[test]
fn a_stop_while_frames_are_withheld_goes_out_at_once_and_is_confirmed() {
    for requests in [Withheld::DriveFrames, Withheld::Requests] {
        for command in [Command::Stop(ID), Command::StopAll(StopReason::Operator)] {
            let mut fixture = driven(WorldConfig::default());
            withhold(&mut fixture, SILENCE, requests).unwrap();
            fixture.run(ms(300));
            let pressed = fixture.now;
            fixture.forget_the_past();
            fixture.command(command).unwrap();
            fixture.run(ms(10));
            let first = fixture.drive_times(ID).first().copied().unwrap();
            assert!(first.since(pressed) <= ms(5), "{command:?}");
            fixture.run(ms(2_000));
            assert!(fixture.true_rpm().abs() < 1.0);
            let confirmed = |event: &Event| match event {
                Event::StopEnded(report) => report.motors.iter().all(|motor| motor.confirmed),
                _ => false,
            };
            assert!(fixture.happened(confirmed), "{:?}", fixture.events);
            assert_eq!(fixture.activity(), Activity::Idle);
        }
    }
}

#[test]
fn a_page_that_falls_silent_meanwhile_stops_the_motor() {
    for requests in [Withheld::DriveFrames, Withheld::Requests] {
        let mut fixture = driven(WorldConfig::default());
        fixture.page_lives = false;
        fixture.run(ms(700));
        withhold(&mut fixture, SILENCE, requests).unwrap();
        fixture.run(ms(400));
        assert!(
            fixture.happened(|event| matches!(event, Event::StopBegan(StopReason::PageSilent))),
            "{:?}",
            fixture.events
        );
    }
}

#[test]
fn a_fault_or_silence_while_queries_go_on_withdraws_the_setpoint() {
    let mut fixture = driven(WorldConfig::default());
    withhold(&mut fixture, SILENCE, Withheld::DriveFrames).unwrap();
    fixture.run(ms(100));
    fixture.world.motor_mut(ID).unwrap().set_leak_a(0.0, 5.0);
    fixture.run(ms(300));
    assert!(!is_driven(&fixture), "{:?}", fixture.events);

    let mut fixture = driven(WorldConfig::default());
    withhold(&mut fixture, SILENCE, Withheld::DriveFrames).unwrap();
    fixture.run(ms(100));
    fixture.world.motor_mut(ID).unwrap().power(false);
    fixture.run(ms(400));
    assert!(is_stopping(&fixture), "{:?}", fixture.events);
}

#[test]
fn a_line_that_loses_a_tenth_keeps_the_motor_driven_after_the_silence() {
    for seed in 0..100 {
        let mut fixture = driven(WorldConfig {
            seed,
            faults: WireFaults {
                lose_reply: 0.1,
                ..WireFaults::default()
            },
            ..WorldConfig::default()
        });
        withhold(&mut fixture, SILENCE, Withheld::Requests).unwrap();
        fixture.run(SILENCE + ms(300));
        assert!(is_driven(&fixture), "seed {seed}: {:?}", fixture.events);
    }
}

#[test]
fn only_a_motor_that_is_driven_in_the_velocity_loop_has_frames_to_withhold() {
    let mut fixture = Fixture::one_motor();
    let asked = withhold(&mut fixture, SILENCE, Withheld::DriveFrames);
    assert_eq!(asked, Err(Refusal::NotDriven(ID)));
    fixture.switch(Mode::Current);
    fixture.drive(fixture::amps(0.1)).unwrap();
    let asked = withhold(&mut fixture, SILENCE, Withheld::Requests);
    assert_eq!(asked, Err(Refusal::NotDriven(ID)));
}

#[test]
fn each_model_is_asked_meanwhile_and_driven_afterwards() {
    for model in [
        Model::Ddsm115,
        Model::Ddsm315,
        Model::Ddsm210,
        Model::Ddsm400,
    ] {
        let mut fixture = Fixture::watching(WorldConfig::of(model, [ID]), &[ID]);
        fixture.run(ms(2_500));
        fixture.drive(rpm(30)).unwrap();
        fixture.run(ms(1_500));
        fixture.forget_the_past();
        withhold(&mut fixture, SILENCE, Withheld::DriveFrames).unwrap();
        fixture.run(ALMOST);
        assert!(!drove(&fixture), "{model}");
        assert!(fixture.sent.len() >= 20, "{model}: {}", fixture.sent.len());
        assert!(is_driven(&fixture), "{model}: {:?}", fixture.events);
        withhold(&mut fixture, SILENCE, Withheld::Requests).unwrap();
        fixture.run(ms(800));
        assert!(is_driven(&fixture), "{model}: {:?}", fixture.events);
        assert!(drove(&fixture), "{model}");
    }
}
