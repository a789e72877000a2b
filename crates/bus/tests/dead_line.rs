//! A line that is dead for seconds on an open port: what was driven on it is stopped once it answers again.

use motorlink_bus::{Command, Consent, Event, Refusal, Repeat, StopReason, StopReport};
use motorlink_protocol::{Mode, MotorId, family::Model};
use motorlink_simulator::{WireFaults, WorldConfig};

use crate::fixture::driven_models::{setpoint, switched};
use crate::fixture::many_motors::{drive, watching};
use crate::fixture::{Fixture, ID, id, ms, raw, rpm, two};

/// The cable is loose; the motors keep their supply, and turn on.
fn cut(fixture: &mut Fixture) {
    fixture.world.set_faults(WireFaults {
        lose_request: 1.0,
        ..WireFaults::default()
    });
}

fn join(fixture: &mut Fixture) {
    fixture.world.set_faults(WireFaults::default());
    fixture.forget_the_past();
}

fn report(fixture: &Fixture) -> Option<&StopReport> {
    let events = fixture.events.iter().map(|(_, event)| event);
    let mut reports = events.filter_map(|event| match event {
        Event::StopEnded(report) => Some(report),
        _ => None,
    });
    reports.next_back()
}

fn confirmed(fixture: &Fixture) -> Vec<(MotorId, bool)> {
    let outcomes = report(fixture).into_iter().flat_map(|it| &it.motors);
    outcomes.map(|it| (it.id, it.confirmed)).collect()
}

#[test]
fn what_a_dead_line_left_driven_is_stopped_from_its_first_reply_on() {
    for model in Model::ALL {
        for mode in [
            Mode::Velocity,
            Mode::Current,
            Mode::OpenLoop,
            Mode::Position,
        ] {
            if !model.has(mode) {
                continue;
            }
            let mut fixture = switched(model, mode);
            fixture.drive(setpoint(mode)).unwrap();
            fixture.run(ms(150));
            cut(&mut fixture);
            fixture.run(ms(12_000));
            if mode != Mode::Position {
                assert!(fixture.true_rpm().abs() > 20.0, "{model} {mode}");
            }
            let angle = fixture.world.motor(ID).unwrap().angle_deg();
            join(&mut fixture);
            // A silent motor is asked once a second.
            fixture.run_until(ms(1_000 + 1_500), |fixture| report(fixture).is_some());
            assert_eq!(report(&fixture).unwrap().reason, StopReason::LeftDriven);
            assert_eq!(confirmed(&fixture), [(ID, true)], "{model} {mode}");
            assert!(fixture.true_rpm().abs() < 2.0, "{model} {mode}");
            assert!(!fixture.status(ID).may_turn, "{model} {mode}");
            assert!(!fixture.bus.is_halted());
            if mode == Mode::Position {
                let turned = fixture.world.motor(ID).unwrap().angle_deg() - angle;
                assert!(turned.abs() < 5.0, "{model}: {turned} degrees");
            }
            // Once is enough.
            fixture.forget_the_past();
            fixture.run(ms(5_000));
            assert!(!fixture.happened(|event| matches!(event, Event::StopBegan(_))));
        }
    }
}

/// Nothing may come between the first reply and the stop, and no alert is shown of a motor that is being stopped.
#[test]
fn a_command_at_the_moment_of_the_first_reply_does_not_drive() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    cut(&mut fixture);
    fixture.run(ms(12_000));
    join(&mut fixture);
    loop {
        fixture.run(ms(1));
        fixture.sleep(ms(2));
        while let Some(chunk) = fixture.world.receive(fixture.now) {
            fixture.bus.receive(fixture.now, &chunk.bytes);
        }
        if fixture
            .status(ID)
            .last
            .is_some_and(|last| last.at == fixture.now)
        {
            break;
        }
    }
    assert!(!fixture.status(ID).turns_unasked);
    assert_eq!(fixture.drive(rpm(50)), Err(Refusal::Stopping(ID)));
}

#[test]
fn a_line_that_is_back_at_the_end_of_the_stop_is_stopped_to_the_end() {
    for back_after in [2_800, 2_990, 3_150, 3_250, 3_400, 4_200, 5_300] {
        let mut fixture = Fixture::one_motor();
        fixture.drive(rpm(100)).unwrap();
        fixture.run(ms(1_000));
        // So heavy that the brake needs more than what is left of the window.
        cut(&mut fixture);
        fixture.run(ms(back_after));
        join(&mut fixture);
        fixture.run(ms(2_500));
        assert!(fixture.true_rpm().abs() < 2.0, "{back_after}");
        assert_eq!(confirmed(&fixture), [(ID, true)], "{back_after}");
        assert!(!fixture.status(ID).may_turn, "{back_after}");
    }
}

/// Releasing one while another still brakes would turn the vehicle.
#[test]
fn all_motors_of_a_dead_line_are_stopped_together() {
    let mut fixture = two();
    for motor in [ID, id(2)] {
        drive(&mut fixture, motor);
    }
    fixture.run(ms(1_000));
    cut(&mut fixture);
    fixture.run(ms(12_300));
    join(&mut fixture);
    fixture.run_until(ms(2_500), |fixture| report(fixture).is_some());
    assert_eq!(confirmed(&fixture), [(ID, true), (id(2), true)]);
    for motor in [ID, id(2)] {
        assert!(fixture.world.motor(motor).unwrap().speed_rpm().abs() < 2.0);
    }
}

/// A silent motor is asked more and more rarely while others are driven, but not one that may turn.
#[test]
fn a_motor_that_may_turn_is_looked_for_while_another_is_driven() {
    let mut fixture = watching(&[1, 2]);
    drive(&mut fixture, id(2));
    fixture.run(ms(1_000));
    fixture.world.motor_mut(id(2)).unwrap().power(false);
    drive(&mut fixture, ID);
    fixture.run(ms(31_000));
    fixture.world.motor_mut(id(2)).unwrap().power(true);
    fixture.forget_the_past();
    fixture.run_until(ms(2_500), |fixture| report(fixture).is_some());
    assert_eq!(confirmed(&fixture), [(id(2), true)]);
    assert!(fixture.status(ID).activity != motorlink_bus::Activity::Idle);
}

/// A raw frame that is sent once runs a motor that keeps its command: nothing withdraws it.
#[test]
fn what_one_raw_frame_drives_is_stopped_after_a_dead_line_too() {
    let mut fixture = Fixture::one_motor();
    let spin = "01 64 00 64 00 00 00 00 00 4F".parse().unwrap();
    fixture.command(raw(spin, Repeat::Once)).unwrap();
    fixture.run(ms(1_000));
    cut(&mut fixture);
    fixture.run(ms(12_000));
    assert!(fixture.true_rpm() > 90.0);
    join(&mut fixture);
    fixture.run_until(ms(2_500), |fixture| report(fixture).is_some());
    assert_eq!(confirmed(&fixture), [(ID, true)]);
}

#[test]
fn a_wheel_that_stood_before_the_line_died_is_not_braked_when_a_person_turns_it() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    fixture.command(Command::Stop(ID)).unwrap();
    fixture.run(ms(1_000));
    assert_eq!(confirmed(&fixture), [(ID, true)]);
    cut(&mut fixture);
    fixture.run(ms(12_000));
    join(&mut fixture);
    for _ in 0..300 {
        let motor = fixture.world.motor_mut(ID).unwrap();
        motor.set_push_nm((30.0 - motor.speed_rpm()) * 0.01);
        fixture.run(ms(10));
    }
    assert!(fixture.true_rpm().abs() > 5.0);
    assert!(!fixture.happened(|event| matches!(event, Event::StopBegan(_))));
    assert!(fixture.drive_times(ID).is_empty());
}

/// A stop of a motor that answered all along and was pushed on: a person may hold the wheel.
#[test]
fn a_stop_that_a_person_prevents_is_not_repeated() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    cut(&mut fixture);
    fixture.run(ms(12_000));
    fixture.world.motor_mut(ID).unwrap().set_push_nm(3.0);
    join(&mut fixture);
    fixture.run(ms(15_000));
    let began = |event: &&(_, Event)| matches!(event.1, Event::StopBegan(_));
    assert_eq!(fixture.events.iter().filter(began).count(), 1);
    assert_eq!(confirmed(&fixture), [(ID, false)]);
    assert!(fixture.status(ID).turns_unasked);
}

/// A scan would let the wheel turn for seconds.
#[test]
fn a_motor_that_answers_a_scan_is_stopped_first() {
    let mut fixture = Fixture::watching(WorldConfig::default(), &[ID]);
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    cut(&mut fixture);
    fixture.run(ms(12_000));
    fixture.command(Command::FullScan).unwrap();
    fixture.run(ms(4_000));
    assert!(fixture.bus.job().is_some());
    join(&mut fixture);
    fixture.run(ms(10_000));
    assert_eq!(confirmed(&fixture), [(ID, true)]);
    let consent = Consent::None;
    let setpoint = rpm(50);
    fixture
        .command(Command::Drive {
            id: ID,
            setpoint,
            consent,
        })
        .unwrap();
}

/// The cable is loose: it passes a few frames in between, and none at the end of the stop.
#[test]
fn a_line_that_comes_and_goes_is_stopped_when_it_is_back() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    for (dead_ms, good_ms) in [(1_900, 30), (1_400, 2_500)] {
        cut(&mut fixture);
        fixture.run(ms(dead_ms));
        join(&mut fixture);
        fixture.run(ms(good_ms));
    }
    assert_eq!(confirmed(&fixture), [(ID, true)]);
    assert!(fixture.true_rpm().abs() < 2.0);
}

/// A brake that reaches the position loop turns the wheel to 0 degrees. The line comes back in the middle of a stop.
#[test]
fn a_line_that_is_back_during_the_stop_of_a_motor_in_the_position_loop_turns_no_wheel() {
    for model in Model::ALL
        .into_iter()
        .filter(|model| model.has(Mode::Position))
    {
        for back_after in (500..3_200).step_by(73) {
            let mut fixture = switched(model, Mode::Position);
            fixture.drive(setpoint(Mode::Position)).unwrap();
            fixture.run(ms(1_500));
            cut(&mut fixture);
            fixture.run(ms(back_after));
            let angle = fixture.world.motor(ID).unwrap().angle_deg();
            join(&mut fixture);
            fixture.run(ms(2_500));
            let turned = fixture.world.motor(ID).unwrap().angle_deg() - angle;
            assert!(
                turned.abs() < 1.0,
                "{model}, {back_after} ms: {turned} degrees"
            );
            assert_eq!(
                confirmed(&fixture),
                [(ID, true)],
                "{model}, {back_after} ms"
            );
        }
    }
}

/// It obeys every frame, but none of its replies arrives. In the position loop it turns to its target at most, and the
/// switch ends that. In every other loop it may turn for ever.
#[test]
fn a_motor_whose_replies_are_all_lost_is_braked_unless_it_is_in_the_position_loop() {
    for model in Model::ALL {
        let modes = [
            Mode::Velocity,
            Mode::Current,
            Mode::OpenLoop,
            Mode::Position,
        ];
        for mode in modes.into_iter().filter(|mode| model.has(*mode)) {
            let mut fixture = switched(model, mode);
            fixture.drive(setpoint(mode)).unwrap();
            fixture.run(ms(150));
            fixture.world.set_faults(WireFaults {
                lose_reply: 1.0,
                ..WireFaults::default()
            });
            fixture.run_until(ms(1_000), |fixture| {
                fixture.happened(|event| matches!(event, Event::StopBegan(_)))
            });
            fixture.run_until(ms(4_000), |fixture| report(fixture).is_some());
            let motor = fixture.world.motor(ID).unwrap();
            assert_eq!(motor.mode(), Mode::Velocity, "{model} {mode}");
            assert!(motor.speed_rpm().abs() < 1.0, "{model} {mode}");
            let is_braked = motor.obeyed().is_some_and(|(_, drive)| drive.brakes());
            assert_eq!(is_braked, mode != Mode::Position, "{model} {mode}");
        }
    }
}
