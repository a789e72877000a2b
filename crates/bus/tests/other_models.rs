//! Motors of another model than that of the line: they are found, and nothing drives them.

use std::time::Duration;

use motorlink_bus::{Activity, Bus, BusSettings, Command, Event, Limits, Refusal, Repeat};
use motorlink_protocol::{Frame, Instant, MotorId, family::Model};
use motorlink_simulator::WorldConfig;

use crate::fixture::{Fixture, ID, id, ms, raw, rpm};

const PAIRS: [(Model, Model); 2] = [
    (Model::Ddsm115, Model::Ddsm210),
    (Model::Ddsm210, Model::Ddsm115),
];

/// Motor 1 is of the model of the line, motor 2 of another.
fn mixed(expected: Model, found: Model) -> Fixture {
    let mut config = WorldConfig::of(expected, [ID]);
    let mut other = WorldConfig::of(found, [id(2)]).motors;
    // At angle 0 the odometry reply of a DDSM210 is like an echo.
    for motor in &mut other {
        motor.angle_deg = 30.0;
    }
    config.motors.extend(other);
    let mut fixture = Fixture::watching(config, &[ID]);
    fixture.run(ms(700));
    fixture
}

/// A line of `expected` that has motors of `found` only.
fn wrong_model(expected: Model, found: Model, ids: &[MotorId]) -> Fixture {
    let mut config = WorldConfig::of(found, ids.iter().copied());
    for motor in &mut config.motors {
        motor.angle_deg = 30.0;
    }
    let mut fixture = Fixture::new(config);
    fixture.bus = Bus::with_model(fixture.now, expected);
    fixture
}

/// When the other model was reported.
fn reported(fixture: &Fixture) -> Vec<Instant> {
    let shown = |event: &Event| matches!(event, Event::OtherModel { .. });
    let events = fixture.events.iter().filter(|(_, event)| shown(event));
    events.map(|(at, _)| *at).collect()
}

/// Runs until the other model is reported.
fn until_reported(fixture: &mut Fixture, limit: Duration) -> Duration {
    fixture.run_until(limit, |fixture| !reported(fixture).is_empty())
}

fn drive(motor: MotorId, value: i16) -> Command {
    let [high, low] = value.to_be_bytes();
    let frame = Frame::with_crc([motor.get(), 0x64, high, low, 0, 0, 0, 0, 0]);
    raw(frame, Repeat::Once)
}

#[test]
fn a_motor_of_another_model_ends_all_driving() {
    for (expected, found) in PAIRS {
        let mut fixture = mixed(expected, found);
        fixture.drive(rpm(40)).unwrap();
        fixture.run(ms(500));
        fixture.command(Command::Watch(id(2))).unwrap();
        fixture.run(ms(1_500));
        let shown = Event::OtherModel { expected, found };
        assert!(fixture.happened(|event| *event == shown), "{expected}");
        fixture.run(ms(3_000));
        assert!(fixture.true_rpm().abs() < 1.0, "{expected}");
        let refused = fixture.drive(rpm(40));
        assert_eq!(refused, Err(Refusal::OtherModel { expected, found }));
    }
}

#[test]
fn a_release_lets_the_motors_drive_once_the_other_model_is_gone() {
    for (expected, found) in PAIRS {
        let mut fixture = mixed(expected, found);
        fixture.command(Command::Watch(id(2))).unwrap();
        until_reported(&mut fixture, ms(5_000));
        fixture.world.motor_mut(id(2)).unwrap().power(false);
        fixture.run(ms(5_000));
        fixture.forget_the_past();
        fixture.command(Command::Release).unwrap();
        fixture.drive(rpm(40)).unwrap();
        fixture.run(ms(5_000));
        assert!(fixture.true_rpm().abs() > 35.0, "{expected}");
        assert_eq!(reported(&fixture), [], "{expected}");
    }
}

#[test]
fn a_release_while_the_other_model_still_answers_is_followed_by_a_stop() {
    for (expected, found) in PAIRS {
        let mut fixture = mixed(expected, found);
        fixture.command(Command::Watch(id(2))).unwrap();
        until_reported(&mut fixture, ms(5_000));
        // It has been silent for long, so it is asked rarely.
        fixture.run(ms(20_000));
        fixture.forget_the_past();
        fixture.command(Command::Release).unwrap();
        fixture.drive(rpm(40)).unwrap();
        let took = until_reported(&mut fixture, ms(2_000));
        assert!(took <= ms(200), "{expected}: {took:?}");
        assert!(fixture.bus.is_halted());
        fixture.run(ms(3_000));
        assert_eq!(fixture.activity(), Activity::Idle, "{expected}");
        assert!(fixture.true_rpm().abs() < 1.0, "{expected}");
        let refused = fixture.drive(rpm(40));
        assert_eq!(refused, Err(Refusal::OtherModel { expected, found }));
    }
}

/// USB is plugged in first, and the motors get power later.
#[test]
fn a_motor_of_another_model_that_gets_power_late_is_reported() {
    for (expected, found) in PAIRS {
        for ids in [&[ID][..], &[ID, id(2), id(3)]] {
            let mut fixture = wrong_model(expected, found, ids);
            for motor in ids {
                fixture.world.motor_mut(*motor).unwrap().power(false);
                fixture.command(Command::Watch(*motor)).unwrap();
            }
            fixture.run(ms(3_000));
            assert_eq!(reported(&fixture), []);
            for motor in ids {
                fixture.world.motor_mut(*motor).unwrap().power(true);
            }
            let took = until_reported(&mut fixture, ms(30_000));
            assert!(took <= ms(5_000), "{expected} {ids:?}: {took:?}");
        }
    }
}

/// While others are driven a silent motor is asked rarely.
#[test]
fn a_motor_of_another_model_that_gets_power_while_others_drive_is_reported() {
    for (expected, found) in PAIRS {
        let mut fixture = mixed(expected, found);
        fixture.world.motor_mut(id(2)).unwrap().power(false);
        fixture.command(Command::Watch(id(2))).unwrap();
        fixture.drive(rpm(40)).unwrap();
        fixture.run(ms(30_000));
        assert_eq!(reported(&fixture), []);
        fixture.world.motor_mut(id(2)).unwrap().power(true);
        let took = until_reported(&mut fixture, ms(60_000));
        assert!(took <= ms(20_000), "{expected}: {took:?}");
    }
}

/// A DDSM115 reads the 100.0 rpm of a DDSM210 as 1,000 rpm.
#[test]
fn a_raw_frame_does_not_drive_a_motor_whose_model_is_unknown() {
    for model in [Model::Ddsm210, Model::Ddsm400] {
        let mut fixture = wrong_model(model, Model::Ddsm115, &[ID]);
        let limits = Limits::new(100, 2_700, 75).unwrap();
        fixture
            .command(Command::Configure(BusSettings {
                limits,
                ..BusSettings::default()
            }))
            .unwrap();
        for value in [1_000, -101] {
            let refused = fixture.command(drive(ID, value));
            assert_eq!(refused, Err(Refusal::NotAnswering(ID)), "{model} {value}");
        }
        let everyone = Frame::with_crc([0xC8, 0x64, 3, 0xE8, 0, 0, 0, 0, 0]);
        let refused = fixture.command(raw(everyone, Repeat::Once));
        assert_eq!(refused, Err(Refusal::NotAnswering(id(0xC8))), "{model}");
        // A query and a zero harm nobody.
        let query = Frame::with_crc([1, 0x74, 0, 0, 0, 0, 0, 0, 0]);
        fixture.command(raw(query, Repeat::Once)).unwrap();
        fixture.run(ms(100));
        fixture.command(drive(ID, 0)).unwrap();
        fixture.run(ms(1_000));
        assert!(fixture.true_rpm().abs() < 1.0, "{model}");
    }
}

#[test]
fn a_raw_frame_drives_a_motor_that_has_answered_as_the_model_of_the_line() {
    for model in [Model::Ddsm210, Model::Ddsm400] {
        let mut fixture = Fixture::watching(WorldConfig::of(model, [ID]), &[ID]);
        fixture.run(ms(700));
        fixture.command(drive(ID, 1_000)).unwrap();
        // One that has not answered may be of another model.
        fixture.run(ms(100));
        let refused = fixture.command(drive(id(9), 1_000));
        assert_eq!(refused, Err(Refusal::NotAnswering(id(9))), "{model}");
    }
}
