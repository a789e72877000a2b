//! Some of several motors on one line are silent: none takes the line from the others.

use crate::fixture::many_motors::{drive, driven, queries, watching};
use crate::fixture::{Fixture, ID, id, longest_gap, ms, rpm};
use motorlink_bus::{Command, Consent, Event, StopReason};
use motorlink_protocol::{Drive, Instant, MotorId, Setpoint, family::Model};
use motorlink_simulator::WorldConfig;

fn brakes(fixture: &Fixture, motor: MotorId) -> Vec<Instant> {
    let brake: Drive = Setpoint::Brake.into();
    let brakes = fixture
        .sent
        .iter()
        .filter(|sent| sent.drive_of(motor) == Some(brake));
    brakes.map(|sent| sent.at).collect()
}

#[test]
fn a_stop_that_joins_another_does_not_take_the_brake_from_it() {
    let mut fixture = watching(&[1, 2]);
    drive(&mut fixture, id(1));
    drive(&mut fixture, id(2));
    fixture.run(ms(2_000));
    fixture.forget_the_past();
    fixture.command(Command::Stop(id(1))).unwrap();
    fixture.run(ms(120));
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    fixture.run(ms(300));
    let gap = longest_gap(&brakes(&fixture, id(1)));
    assert!(gap <= ms(20), "{gap:?} without brake");
}

#[test]
fn a_motor_that_loses_power_does_not_take_the_other_down() {
    let mut fixture = watching(&[1, 2]);
    drive(&mut fixture, id(1));
    drive(&mut fixture, id(2));
    fixture.run(ms(2_000));
    fixture.forget_the_past();
    fixture.world.motor_mut(id(1)).unwrap().power(false);
    fixture.run(ms(4_000));
    let withdrawn =
        |motor| fixture.happened(|e| matches!(e, Event::Withdrawn { id, .. } if *id == motor));
    assert!(withdrawn(id(1)));
    assert!(!withdrawn(id(2)));
    let gap = longest_gap(&fixture.drive_times(id(2)));
    assert!(gap <= ms(30), "{gap:?}");
}

#[test]
fn silent_motors_cost_a_driven_one_next_to_nothing() {
    for silent in [1, 3] {
        let addresses: Vec<u8> = (1..=1 + silent).collect();
        let mut fixture = watching(&addresses);
        drive(&mut fixture, ID);
        for address in 2..=1 + silent {
            fixture.world.motor_mut(id(address)).unwrap().power(false);
        }
        fixture.run(ms(4_000));
        fixture.forget_the_past();
        fixture.run(ms(2_000));
        let frames = fixture.drive_times(ID);
        assert!(
            frames.len() >= 98,
            "{} of 100 beside {silent} silent",
            frames.len()
        );
        assert!(longest_gap(&frames) <= ms(30), "{:?}", longest_gap(&frames));
        fixture.forget_the_past();
        fixture
            .command(Command::StopAll(StopReason::Operator))
            .unwrap();
        fixture.run(ms(250));
        // All of them are braked, round by round, since any may hear.
        let gap = longest_gap(&brakes(&fixture, ID));
        assert!(
            gap <= ms(10 + 10 * u64::from(silent)),
            "{gap:?} beside {silent} silent"
        );
        fixture.run(ms(150));
        assert!(fixture.true_rpm().abs() < 1.0);
    }
}

#[test]
fn one_of_four_that_falls_silent_costs_the_others_no_frame() {
    let mut fixture = driven(&[1, 2, 3, 4]);
    fixture.world.motor_mut(id(4)).unwrap().power(false);
    fixture.run(ms(30_000));
    for address in 1..=3 {
        let frames = fixture.drive_times(id(address));
        assert!(frames.len() >= 1_485, "{} to {address}", frames.len());
        assert!(longest_gap(&frames) <= ms(30), "{:?}", longest_gap(&frames));
    }
    // Its wheel may turn, so the bus looks for it once a second.
    fixture.forget_the_past();
    fixture.run(ms(16_000));
    assert!((15..=17).contains(&queries(&fixture, id(4))));
    fixture.world.motor_mut(id(4)).unwrap().power(true);
    fixture.run_until(ms(1_200), |fixture| {
        fixture.happened(|event| *event == Event::MotorBack(id(4)))
    });
}

/// The bus queries it more and more rarely, and notices when it is back.
#[test]
fn one_that_was_never_driven_is_looked_for_rarely_while_others_are() {
    let mut fixture = watching(&[1, 2, 3, 4]);
    for address in 1..=3 {
        drive(&mut fixture, id(address));
    }
    fixture.world.motor_mut(id(4)).unwrap().power(false);
    fixture.run(ms(30_000));
    fixture.forget_the_past();
    fixture.run(ms(16_000));
    assert!((1..=3).contains(&queries(&fixture, id(4))));
    fixture.world.motor_mut(id(4)).unwrap().power(true);
    fixture.run_until(ms(9_000), |fixture| {
        fixture.happened(|event| *event == Event::MotorBack(id(4)))
    });
}

/// Motors that have lost their bus have lower IDs than those that turn.
#[test]
fn silent_motors_do_not_delay_the_first_brake_of_the_others() {
    let mut fixture = driven(&[1, 2, 3, 4, 5, 6, 7, 8]);
    for address in 1..=5 {
        fixture.world.motor_mut(id(address)).unwrap().power(false);
    }
    fixture.run(ms(250));
    fixture.forget_the_past();
    let stopped = fixture.now;
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    fixture.run(ms(400));
    for address in 6..=8 {
        let brakes = brakes(&fixture, id(address));
        let first = brakes[0].since(stopped);
        assert!(first <= ms(20), "{first:?} to the first brake of {address}");
        assert!(longest_gap(&brakes) <= ms(60), "{:?}", longest_gap(&brakes));
    }
}

/// What does not answer costs those that do nothing: 221 ms to rest, as alone.
#[test]
fn a_stop_of_16_motors_of_which_15_have_no_power_brakes_the_16th_as_if_alone() {
    let ids: Vec<MotorId> = (1..=16).map(id).collect();
    for live in [1, 9, 16] {
        let mut fixture = Fixture::watching(WorldConfig::with_ids(ids.clone()), &ids);
        let live = id(live);
        fixture
            .command(Command::Drive {
                id: live,
                setpoint: rpm(100),
                consent: Consent::None,
            })
            .unwrap();
        fixture.run(ms(1_500));
        for other in ids.iter().filter(|other| **other != live) {
            fixture.world.motor_mut(*other).unwrap().power(false);
        }
        fixture.run(ms(3_000));
        fixture.forget_the_past();
        let asked = fixture.now;
        fixture
            .command(Command::StopAll(StopReason::Operator))
            .unwrap();
        // Every one of them is stopped: none is known to stand.
        let stands = fixture.run_until(ms(1_000), |fixture| {
            fixture.world.motor(live).unwrap().speed_rpm().abs() < 1.0
        });
        let brakes: Vec<Instant> = fixture.drive_times(live);
        assert!(brakes[0].since(asked) <= ms(10));
        let gap = longest_gap(&brakes);
        println!("motor {live} of 16: {stands:?} to rest, brake frames {gap:?} apart at most");
        assert!(gap <= ms(25), "{gap:?}");
        assert!(stands <= ms(230), "{stands:?}");
        let others = ids.iter().filter(|other| **other != live);
        fixture.run(ms(1_500));
        for other in others {
            let frames = fixture.sent.iter();
            let to_it = frames.filter(|sent| sent.frame.bytes()[0] == other.get());
            assert!(to_it.count() > 3, "motor {other} was given up");
        }
    }
}

/// Motor 1 has lost its supply while it was driven, and its stop sends frames for two seconds.
fn stopped_for_long(model: Model, others: &[MotorId]) -> Fixture {
    let ids: Vec<MotorId> = [&[ID], others].concat();
    let mut fixture = Fixture::watching(WorldConfig::of(model, ids.clone()), &ids);
    // A DDSM400 is enabled meanwhile.
    fixture.run(ms(1_000));
    drive(&mut fixture, ID);
    fixture.run(ms(1_000));
    fixture.world.motor_mut(ID).unwrap().power(false);
    fixture.run_until(ms(500), |fixture| {
        fixture.happened(|event| matches!(event, Event::Withdrawn { .. }))
    });
    fixture.run(ms(2_000));
    fixture
}

fn all_confirm_within_1500_ms(fixture: &mut Fixture) {
    fixture.forget_the_past();
    fixture.run_until(ms(1_500), |fixture| {
        fixture.happened(|event| match event {
            Event::StopEnded(report) => report.motors.iter().all(|motor| motor.confirmed),
            _ => false,
        })
    });
}

/// Each motor had to catch up with the frames that the silent one had got.
#[test]
fn a_motor_that_answers_again_is_braked_with_those_that_have_joined_its_stop() {
    for model in Model::ALL {
        let others = [id(2), id(3), id(4)];
        let mut fixture = stopped_for_long(model, &others);
        // Its stop has nearly ended.
        fixture.run(ms(600));
        for other in others {
            drive(&mut fixture, other);
        }
        fixture.run(ms(200));
        let all = Command::StopAll(StopReason::Operator);
        fixture.command(all).unwrap();
        fixture.world.motor_mut(ID).unwrap().power(true);
        all_confirm_within_1500_ms(&mut fixture);
    }
}

/// The same beside another silent motor, which has got no frame before.
#[test]
fn a_motor_that_answers_again_is_braked_beside_one_that_has_just_fallen_silent() {
    let mut fixture = stopped_for_long(Model::Ddsm115, &[id(2)]);
    fixture.world.motor_mut(id(2)).unwrap().power(false);
    fixture.run(ms(600));
    let all = Command::StopAll(StopReason::Operator);
    fixture.command(all).unwrap();
    fixture.world.motor_mut(ID).unwrap().power(true);
    fixture.forget_the_past();
    fixture.run(ms(300));
    let brakes = brakes(&fixture, ID).len();
    assert!(brakes > 10, "{brakes} brakes");
}
