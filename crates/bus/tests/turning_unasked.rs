//! A wheel that turns although nothing here drives it is reported from the first reply on.

use motorlink_bus::{Bus, Command, Event, Repeat};
use motorlink_protocol::{Mode, Reply, family::Model};

use crate::fixture::driven_models::{on, setpoint, switched};
use crate::fixture::{Fixture, ID, ms, raw, rpm};

fn turns_unasked(fixture: &Fixture) -> bool {
    fixture.status(ID).turns_unasked
}

/// A new bus that watches the motor, which the old one left driven.
fn reloaded(fixture: &mut Fixture) {
    fixture.bus = Bus::with_model(fixture.now, fixture.bus.model());
    fixture.forget_the_past();
    fixture.command(Command::Watch(ID)).unwrap();
}

fn first_reply(fixture: &mut Fixture) -> Reply {
    fixture.run_until(ms(500), |fixture| {
        fixture.happened(|event| matches!(event, Event::Telemetry(_)))
    });
    fixture.status(ID).last.unwrap().reply
}

#[test]
fn a_wheel_that_turns_after_a_reload_is_reported_with_the_first_reply() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    assert!(!turns_unasked(&fixture), "it is driven here");
    reloaded(&mut fixture);
    assert!(first_reply(&mut fixture).speed.unwrap().magnitude() > 50);
    assert!(turns_unasked(&fixture));
    fixture.command(Command::Stop(ID)).unwrap();
    assert!(!turns_unasked(&fixture), "it is being stopped");
    fixture.run(ms(1_000));
    assert!(!turns_unasked(&fixture), "it stands");
}

#[test]
fn each_model_that_turns_unasked_is_reported() {
    for model in Model::ALL {
        let mut fixture = on(model);
        fixture.drive(rpm(60)).unwrap();
        fixture.run(ms(1_500));
        reloaded(&mut fixture);
        fixture.run(ms(500));
        assert!(turns_unasked(&fixture), "{model}");
    }
}

/// A person turns the wheel by hand, slower than 10 rpm.
#[test]
fn a_wheel_turned_slowly_by_hand_is_not_reported() {
    let mut fixture = Fixture::one_motor();
    let mut fastest = 0.0_f32;
    for step in 0..1_000 {
        let motor = fixture.world.motor_mut(ID).unwrap();
        fastest = fastest.max(motor.speed_rpm());
        motor.set_push_nm((8.0 - motor.speed_rpm()) * 0.01);
        fixture.run(ms(1));
        assert!(!turns_unasked(&fixture), "step {step} {fastest}");
    }
    assert!((6.0..10.0).contains(&fastest), "{fastest}");
}

#[test]
fn a_blocked_wheel_whose_motor_draws_a_current_is_reported() {
    let mut fixture = switched(Model::Ddsm115, Mode::Current);
    fixture.world.motor_mut(ID).unwrap().set_load_nm(5.0);
    fixture.drive(setpoint(Mode::Current)).unwrap();
    fixture.run(ms(510));
    reloaded(&mut fixture);
    let reply = first_reply(&mut fixture);
    assert_eq!(reply.speed.unwrap().magnitude(), 0);
    assert!(turns_unasked(&fixture), "{reply:?}");
}

/// The wheel is pushed so hard that the brake cannot hold it.
#[test]
fn a_wheel_that_turns_on_after_an_unconfirmed_stop_is_reported() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    fixture.world.motor_mut(ID).unwrap().set_push_nm(3.0);
    fixture.command(Command::Stop(ID)).unwrap();
    while fixture.bus.is_stopping() {
        assert!(!turns_unasked(&fixture), "while it is stopped");
        fixture.run(ms(20));
    }
    assert!(fixture.happened(
        |event| matches!(event, Event::StopEnded(report) if !report.motors[0].confirmed)
    ));
    fixture.run(ms(200));
    assert!(turns_unasked(&fixture));
}

#[test]
fn a_wheel_that_a_raw_frame_has_moved_is_not_unasked() {
    let mut fixture = Fixture::one_motor();
    let spin = "01 64 00 64 00 00 00 00 00 4F".parse().unwrap();
    fixture.command(raw(spin, Repeat::Once)).unwrap();
    for _ in 0..50 {
        fixture.run(ms(20));
        assert!(!turns_unasked(&fixture));
    }
    assert!(fixture.status(ID).may_turn);
}

#[test]
fn one_calm_reply_does_not_end_it_and_a_few_do() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    reloaded(&mut fixture);
    first_reply(&mut fixture);
    let replies = |fixture: &Fixture| {
        let telemetry = |event: &&(_, Event)| matches!(event.1, Event::Telemetry(_));
        fixture.events.iter().filter(telemetry).count()
    };
    fixture.world.motor_mut(ID).unwrap().set_load_nm(5.0);
    let calm = |fixture: &Fixture| {
        fixture
            .status(ID)
            .last
            .unwrap()
            .reply
            .speed
            .unwrap()
            .magnitude()
            < 10
    };
    // Its driver is off: the wheel stands and draws nothing.
    fixture.world.motor_mut(ID).unwrap().power(false);
    fixture.run(ms(300));
    fixture.world.motor_mut(ID).unwrap().power(true);
    fixture.forget_the_past();
    fixture.run_until(ms(2_000), calm);
    let first = replies(&fixture);
    assert!(turns_unasked(&fixture));
    fixture.run_until(ms(2_000), |fixture| !turns_unasked(fixture));
    assert_eq!(replies(&fixture) - first, 2, "three calm replies in all");
}
