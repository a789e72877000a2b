//! Standstill is what speed and angle say: where they disagree, or one is unknown, it is not confirmed.

use motorlink_bus::{Activity, Command, Event, StopOutcome, StopReason, WithdrawReason};
use motorlink_protocol::{Mode, Position, family::Model};
use motorlink_simulator::{MotorConfig, WorldConfig};

use crate::fixture::driven_models::{on, stopped};
use crate::fixture::{Fixture, ID, degrees, ms, rpm};

fn with(motor: MotorConfig) -> Fixture {
    let model = motor.model;
    let config = WorldConfig {
        motors: vec![motor],
        ..WorldConfig::of(model, [])
    };
    let mut fixture = Fixture::watching(config, &[ID]);
    // A DDSM400 is enabled meanwhile.
    fixture.run(ms(700));
    fixture.forget_the_past();
    fixture
}

/// A motor that reports -0.1 rpm however fast it turns.
fn stuck_speed(model: Model) -> Fixture {
    with(MotorConfig {
        speed_stuck_rpm: Some(-0.1),
        ..MotorConfig::of(model, ID)
    })
}

fn outcome(fixture: &Fixture) -> Option<StopOutcome> {
    fixture.events.iter().find_map(|(_, event)| match event {
        Event::StopEnded(report) => report.motors.first().copied(),
        _ => None,
    })
}

#[test]
fn a_motor_that_reports_no_speed_is_confirmed_only_when_its_wheel_stands() {
    for model in Model::ALL {
        let mut fixture = stuck_speed(model);
        fixture.drive(rpm(80)).unwrap();
        fixture.run(ms(1_500));
        assert!(fixture.true_rpm() > 70.0, "{model}");
        let took = stopped(&mut fixture);
        assert!(
            fixture.true_rpm().abs() < 1.0,
            "{model}: {}",
            fixture.true_rpm()
        );
        assert!(took <= ms(600), "{model}: {took:?}");
    }
}

#[test]
fn a_motor_that_reports_no_speed_while_its_wheel_is_pushed_is_not_confirmed() {
    for model in Model::ALL {
        let mut fixture = stuck_speed(model);
        fixture.drive(rpm(80)).unwrap();
        fixture.run(ms(1_500));
        // More than the brake holds.
        fixture.world.motor_mut(ID).unwrap().set_push_nm(10.0);
        fixture.command(Command::Stop(ID)).unwrap();
        fixture.run(ms(3_500));
        assert!(fixture.true_rpm().abs() > 5.0, "{model}");
        assert!(!outcome(&fixture).unwrap().confirmed, "{model}");
    }
}

/// The angle stays, and the speed falls to zero: they agree.
#[test]
fn a_frozen_angle_with_a_speed_that_falls_to_zero_is_confirmed() {
    let mut fixture = with(MotorConfig {
        drive_angle_stuck: Some(Position::from_raw(0x1234)),
        ..MotorConfig::new(ID)
    });
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_500));
    let took = stopped(&mut fixture);
    assert!(fixture.true_rpm().abs() < 1.0);
    assert!(took <= ms(600), "{took:?}");
}

#[test]
fn each_model_confirms_a_stop_within_600_ms() {
    for model in Model::ALL {
        let mut fixture = on(model);
        fixture.drive(rpm(100)).unwrap();
        fixture.run(ms(2_000));
        let took = stopped(&mut fixture);
        println!("{model}: {took:?}");
        assert!(took <= ms(600), "{model}: {took:?}");
    }
}

/// Nothing drives it, and its speed is stuck.
#[test]
fn stop_all_stops_a_wheel_whose_angle_moves_at_a_reported_standstill() {
    for model in Model::ALL {
        let mut fixture = stuck_speed(model);
        for (push_nm, time) in [(0.02, 300), (0.002, 600)] {
            fixture.world.motor_mut(ID).unwrap().set_push_nm(push_nm);
            fixture.run(ms(time));
        }
        fixture.world.motor_mut(ID).unwrap().set_push_nm(0.0);
        assert!(fixture.true_rpm() > 50.0, "{model}");
        fixture
            .command(Command::StopAll(StopReason::Operator))
            .unwrap();
        fixture.run(ms(1_000));
        assert!(
            outcome(&fixture).is_some_and(|outcome| outcome.confirmed),
            "{model}"
        );
        assert!(fixture.true_rpm().abs() < 1.0, "{model}");
    }
}

/// The drive replies report 51.2 degrees wherever the wheel is: Hold would turn it there.
#[test]
fn an_angle_that_does_not_fit_the_motion_is_not_held() {
    for (wait_ms, goal) in [(250, 200.0), (2_500, 200.0), (2_500, 140.0)] {
        let mut fixture = with(MotorConfig {
            drive_angle_stuck: Some(Position::from_raw(0x1234)),
            ..MotorConfig::new(ID)
        });
        fixture.switch(Mode::Position);
        fixture.drive(degrees(goal)).unwrap();
        fixture.run(ms(wait_ms));
        let before = fixture.world.motor(ID).unwrap().turns();
        fixture.command(Command::Hold(ID)).unwrap();
        assert!(matches!(fixture.activity(), Activity::Stopping { .. }));
        let reason = WithdrawReason::AngleMisfits;
        assert!(fixture.happened(|event| *event == Event::Withdrawn { id: ID, reason }));
        fixture.run(ms(1_000));
        let moved = (fixture.world.motor(ID).unwrap().turns() - before) * 360.0;
        assert!(moved.abs() < 60.0, "{wait_ms} ms: {moved}");
        assert!(fixture.true_rpm().abs() < 1.0);
    }
}

/// A load may hold a wheel until the stop begins. The angles of that time say nothing of the wheel afterwards. Found by
/// seed 4561 of a motor that keeps its command.
#[test]
fn a_stop_is_confirmed_by_angles_of_its_own() {
    for model in Model::ALL {
        let mut fixture = stuck_speed(model);
        fixture.drive(rpm(0)).unwrap();
        fixture.run(ms(2_000));
        fixture.command(Command::Stop(ID)).unwrap();
        fixture.run(ms(25));
        assert_eq!(outcome(&fixture), None, "{model}");
        fixture.run(ms(575));
        let outcome = outcome(&fixture);
        assert!(outcome.is_some_and(|outcome| outcome.confirmed), "{model}");
    }
}
