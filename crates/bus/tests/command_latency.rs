//! What an operator does shows at once, and what is not an operator's act shows not at all.

use crate::fixture::{Fixture, ID, amps, degrees, ms, rpm};
use motorlink_bus::{Activity, BusSettings, Command, CommandRate, Refusal, StopReason};
use motorlink_protocol::Mode;
use motorlink_simulator::{WireFaults, WorldConfig};

fn at_rate(mode: Mode, hertz: u16) -> Fixture {
    let mut fixture = Fixture::one_motor();
    if mode != Mode::Velocity {
        fixture.switch(mode);
    }
    fixture
        .command(Command::Configure(BusSettings {
            rate: CommandRate::new(hertz).unwrap(),
            ..BusSettings::default()
        }))
        .unwrap();
    fixture
}

/// The page's Stop in the current loop is 0 A.
#[test]
fn coming_to_rest_does_not_wait_for_the_command_rate() {
    for hertz in [1, 5, 10, 20, 50] {
        let mut fixture = at_rate(Mode::Current, hertz);
        fixture.drive(amps(0.3)).unwrap();
        fixture.run(ms(1_501));
        fixture.forget_the_past();
        let asked = fixture.now;
        fixture.drive(amps(0.0)).unwrap();
        fixture.run(ms(20));
        let waited = fixture.drive_times(ID)[0].since(asked);
        assert!(waited <= ms(10), "{waited:?} at {hertz} Hz");
    }
}

#[test]
fn hold_holds_the_angle_of_now_and_not_one_of_earlier() {
    for hertz in [2, 5, 10, 20, 50] {
        for moving_ms in (100..600).step_by(61) {
            let mut fixture = at_rate(Mode::Position, hertz);
            fixture.drive(degrees(300.0)).unwrap();
            fixture.run(ms(moving_ms));
            fixture.forget_the_past();
            let asked = fixture.now;
            fixture.command(Command::Hold(ID)).unwrap();
            fixture.run(ms(5));
            assert!(fixture.drive_times(ID)[0].since(asked) <= ms(3));
            let here = fixture.world.motor(ID).unwrap().angle_deg();
            let Activity::Driven { setpoint } = fixture.activity() else {
                panic!("{:?}", fixture.activity())
            };
            let motorlink_protocol::Setpoint::Position(held) = setpoint else {
                panic!("{setpoint:?}")
            };
            let off = (held.degrees() - here + 180.0).rem_euclid(360.0) - 180.0;
            assert!(
                off.abs() <= 5.0,
                "{off} degrees off at {hertz} Hz after {moving_ms} ms"
            );
        }
    }
}

#[test]
fn a_faster_rate_begins_at_once() {
    let mut fixture = at_rate(Mode::Velocity, 1);
    fixture.drive(rpm(50)).unwrap();
    fixture.run(ms(100));
    fixture.forget_the_past();
    fixture
        .command(Command::Configure(BusSettings {
            rate: CommandRate::new(50).unwrap(),
            ..BusSettings::default()
        }))
        .unwrap();
    fixture.run(ms(200));
    assert!(
        fixture.drive_times(ID).len() >= 9,
        "{}",
        fixture.drive_times(ID).len()
    );
}

/// A click that was waiting in a page that hung is no act of now.
#[test]
fn a_command_from_a_page_that_had_stopped_answering_starts_nothing() {
    let mut fixture = Fixture::one_motor();
    fixture.page_lives = false;
    fixture.run(ms(10_000));
    assert_eq!(fixture.drive(rpm(100)), Err(Refusal::PageSilent));
    let to_current = Command::SwitchMode {
        id: ID,
        mode: Mode::Current,
    };
    assert_eq!(fixture.command(to_current), Err(Refusal::PageSilent));
    assert_eq!(
        fixture.command(Command::StopAll(StopReason::Operator)),
        Ok(()),
        "a stop is taken"
    );
    assert_eq!(fixture.command(Command::Release), Err(Refusal::PageSilent));
    fixture.page_lives = true;
    fixture.run(ms(300));
    fixture.command(Command::Release).unwrap();
    assert_eq!(fixture.drive(rpm(100)), Ok(()));
}

#[test]
fn a_stop_asked_for_again_has_its_whole_window_again() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(2_000));
    fixture.world.motor_mut(ID).unwrap().mute(true);
    fixture.command(Command::Stop(ID)).unwrap();
    fixture.run(ms(2_950));
    fixture.forget_the_past();
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    fixture.run(ms(4_000));
    let frames = fixture.drive_times(ID);
    let braked = frames[frames.len() - 1].since(frames[0]);
    assert!(braked > ms(2_500), "{braked:?}");
}

/// The page's Stop in the current loop is 0 A, and it counts on a line that loses replies too.
#[test]
fn rest_is_never_refused_to_a_motor_that_is_driven_behind_a_switch() {
    let mut driven_behind_a_switch = 0;
    for seed in 0..200 {
        let mut fixture = Fixture::watching(
            WorldConfig {
                seed,
                ..WorldConfig::default()
            },
            &[ID],
        );
        let mode = Mode::Current;
        fixture.world.set_faults(WireFaults {
            lose_reply: 0.4,
            ..WireFaults::default()
        });
        // What is driven gets neutral frames meanwhile, some of which are lost.
        let driven = fixture.drive(rpm(20)).is_ok();
        fixture.run(ms(100));
        let switched = fixture
            .command(Command::SwitchMode { id: ID, mode })
            .is_ok();
        if !driven || !switched || fixture.drive(amps(0.3)).is_err() {
            continue;
        }
        for _ in 0..400 {
            fixture.run(ms(1));
            if matches!(fixture.activity(), Activity::Driven { .. }) {
                driven_behind_a_switch += 1;
                assert_eq!(fixture.drive(amps(0.0)), Ok(()), "seed {seed}");
                break;
            }
        }
    }
    assert!(driven_behind_a_switch > 50, "{driven_behind_a_switch}");
}
