//! Stopping: velocity loop, zero, brake, next on the wire, until every reply says it stands.

use std::collections::BTreeMap;

use crate::fixture::{Fixture, ID, Sent, amps, degrees, id, ms, rpm};
use motorlink_bus::{Command, Consent, Event, StopReason, StopReport};
use motorlink_protocol::{Drive, Mode, MotorId, Request, Setpoint};
use motorlink_simulator::{MotorConfig, WireFaults, WorldConfig};

pub const STOP: Command = Command::StopAll(StopReason::Operator);

pub fn report(fixture: &Fixture) -> StopReport {
    let reports = fixture
        .events
        .iter()
        .rev()
        .find_map(|(_, event)| match event {
            Event::StopEnded(report) => Some(report.clone()),
            _ => None,
        });
    reports.expect("the stop has ended")
}

pub fn brake() -> Drive {
    Setpoint::Brake.into()
}

pub fn spinning(target: i32) -> Fixture {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(target)).unwrap();
    fixture.run(ms(2_000));
    fixture.forget_the_past();
    fixture
}

#[test]
fn from_100_rpm_the_wheel_stands_within_300_ms_confirmed_and_braked_until_then() {
    for target in [100, -100] {
        let mut fixture = spinning(target);
        fixture.command(STOP).unwrap();
        let took = fixture.run_until(ms(1_000), |b| {
            b.happened(|e| matches!(e, Event::StopEnded(_)))
        });
        assert!(took <= ms(300), "{took:?}");
        assert!(fixture.true_rpm().abs() < 1.0, "{}", fixture.true_rpm());
        assert!(report(&fixture).motors.iter().all(|motor| motor.confirmed));
        // It was in the velocity loop: no time is spent on switching, and every frame brakes.
        let ended = fixture
            .events
            .iter()
            .find(|(_, e)| matches!(e, Event::StopEnded(_)))
            .unwrap()
            .0;
        let of_the_stop = fixture.sent.iter().filter(|sent| sent.at < ended);
        assert!(of_the_stop.clone().count() > 20);
        assert!(
            of_the_stop
                .into_iter()
                .all(|sent| sent.drive_of(ID) == Some(brake()))
        );
    }
}

#[test]
fn a_stop_is_the_next_frame_behind_the_exchange_in_flight() {
    for offset_us in (0..20_000).step_by(500) {
        let mut fixture = spinning(100);
        fixture.run(std::time::Duration::from_micros(offset_us));
        fixture.forget_the_past();
        fixture.command(STOP).unwrap();
        let asked = fixture.now;
        fixture.run(ms(10));
        let first = fixture.sent.first().expect("a frame within 10 ms");
        assert_eq!(first.drive_of(ID), Some(brake()));
        assert!(
            first.at.since(asked) <= ms(3),
            "{:?}",
            first.at.since(asked)
        );
    }
}

#[test]
fn in_the_current_loop_the_brake_is_sent_while_it_is_switched() {
    let mut fixture = Fixture::one_motor();
    fixture.switch(Mode::Current);
    fixture.drive(amps(0.3)).unwrap();
    fixture.run(ms(1_500));
    assert!(fixture.true_rpm().abs() > 20.0, "{}", fixture.true_rpm());
    fixture.forget_the_past();
    fixture.command(STOP).unwrap();
    fixture.run(ms(1_000));
    let first = fixture
        .sent
        .iter()
        .position(Sent::is_switch)
        .expect("a mode switch");
    assert!(first <= 2);
    assert_eq!(fixture.sent[0].drive_of(ID), Some(brake()));
    assert!(report(&fixture).motors[0].confirmed);
    assert!(fixture.true_rpm().abs() < 1.0);
}

/// In the position loop a zero setpoint is no stop but a move to 0 degrees.
#[test]
fn in_the_position_loop_no_zero_is_sent_before_the_velocity_loop_is_reported() {
    let mut fixture = Fixture::one_motor();
    fixture.switch(Mode::Position);
    fixture.drive(degrees(90.0)).unwrap();
    fixture.run(ms(2_000));
    fixture.forget_the_past();
    let before = fixture.world.motor(ID).unwrap().angle_deg();
    fixture.command(STOP).unwrap();
    fixture.run(ms(1_000));
    assert!(fixture.sent[0].is_switch());
    let first_brake = fixture
        .sent
        .iter()
        .find(|s| s.drive_of(ID).is_some())
        .unwrap();
    let velocity_reported = fixture.events.iter().find_map(|(at, event)| match event {
        Event::Telemetry(sample) if sample.reply.mode == Mode::Velocity => Some(*at),
        _ => None,
    });
    assert!(first_brake.at >= velocity_reported.unwrap());
    assert!(report(&fixture).motors[0].confirmed);
    let after = fixture.world.motor(ID).unwrap().angle_deg();
    assert!((after - before).abs() < 2.0, "{before} to {after}");
}

#[test]
fn a_stop_during_a_switch_to_the_position_loop_sends_no_zero_into_it() {
    for delay in (0..120).step_by(5) {
        let mut fixture = Fixture::one_motor();
        // Standing at an angle far from 0, so that a stray zero would show.
        fixture.switch(Mode::Position);
        fixture.drive(degrees(120.0)).unwrap();
        fixture.run(ms(2_000));
        fixture.command(Command::Stop(ID)).unwrap();
        fixture.run(ms(500));
        let before = fixture.world.motor(ID).unwrap().angle_deg();
        fixture
            .command(Command::SwitchMode {
                id: ID,
                mode: Mode::Position,
            })
            .unwrap();
        fixture.run(ms(delay));
        fixture.command(STOP).unwrap();
        fixture.run(ms(1_000));
        let after = fixture.world.motor(ID).unwrap().angle_deg();
        assert!(
            (after - before).abs() < 2.0,
            "after {delay} ms: {before} to {after}"
        );
        // Once the switch was over the wheel stood, idle: there was nothing to stop.
        assert!(report(&fixture).motors.iter().all(|motor| motor.confirmed));
    }
}

#[test]
fn all_motors_are_stopped_round_by_round() {
    let ids: Vec<MotorId> = (1..=4).map(id).collect();
    let motors = ids.iter().map(|id| MotorConfig::new(*id)).collect();
    let mut fixture = Fixture::watching(
        WorldConfig {
            motors,
            ..WorldConfig::default()
        },
        &ids,
    );
    for motor in &ids {
        let setpoint = rpm(100);
        fixture
            .command(Command::Drive {
                id: *motor,
                setpoint,
                consent: Consent::None,
            })
            .unwrap();
    }
    fixture.run(ms(2_000));
    fixture.forget_the_past();
    fixture.command(STOP).unwrap();
    fixture.run(ms(1_000));
    let mut frames: BTreeMap<MotorId, u32> = ids.iter().map(|id| (*id, 0)).collect();
    let ended = fixture
        .events
        .iter()
        .find(|(_, e)| matches!(e, Event::StopEnded(_)))
        .unwrap()
        .0;
    for sent in fixture.sent.iter().filter(|sent| sent.at < ended) {
        let Request::Drive { id, .. } = sent.request() else {
            panic!("{sent:?}")
        };
        *frames.get_mut(&id).unwrap() += 1;
        let (least, most) = (
            frames.values().min().unwrap(),
            frames.values().max().unwrap(),
        );
        assert!(most - least <= 1, "{frames:?}");
    }
    assert_eq!(report(&fixture).motors.len(), 4);
    assert!(report(&fixture).motors.iter().all(|motor| motor.confirmed));
}

#[test]
fn a_motor_that_does_not_answer_is_named_and_costs_the_others_nothing() {
    let ids = [id(1), id(2)];
    let motors = ids.iter().map(|id| MotorConfig::new(*id)).collect();
    let mut fixture = Fixture::watching(
        WorldConfig {
            motors,
            ..WorldConfig::default()
        },
        &ids,
    );
    for motor in ids {
        let setpoint = rpm(100);
        fixture
            .command(Command::Drive {
                id: motor,
                setpoint,
                consent: Consent::None,
            })
            .unwrap();
    }
    fixture.run(ms(1_500));
    fixture.world.motor_mut(id(2)).unwrap().mute(true);
    fixture.command(STOP).unwrap();
    fixture.run(ms(5_000));
    let report = report(&fixture);
    assert_eq!(report.reason, StopReason::Operator);
    let confirmed: Vec<_> = report.motors.iter().map(|m| (m.id, m.confirmed)).collect();
    assert_eq!(confirmed, [(id(1), true), (id(2), false)]);
    assert_eq!(report.motors[1].speed, None, "unknown is not zero");
    // It hears even though it does not answer, so it was braked all the same.
    assert!(fixture.world.motor(id(2)).unwrap().speed_rpm().abs() < 1.0);
}

/// Seed 47149: each of the two others was asked while the brake was due, with a window of 40 ms each.
#[test]
fn a_brake_that_is_due_waits_for_one_query_at_most() {
    let ids = [id(1), id(2), id(3)];
    let motors = ids.iter().map(|id| MotorConfig::new(*id)).collect();
    let mut fixture = Fixture::watching(
        WorldConfig {
            motors,
            ..WorldConfig::default()
        },
        &ids,
    );
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_500));
    for motor in fixture.world.motors_mut() {
        motor.mute(true);
    }
    fixture.run_until(ms(1_000), |b| {
        b.happened(|e| matches!(e, Event::StopBegan(_)))
    });
    fixture.forget_the_past();
    fixture.run(ms(2_000));
    let of_the_stop = fixture.sent.split(|sent| sent.drive_of(ID).is_some());
    let queries: Vec<usize> = of_the_stop.map(<[Sent]>::len).collect();
    assert!(queries.len() > 20, "{queries:?}");
    assert!(queries.iter().all(|queries| *queries <= 1), "{queries:?}");
}

/// Seed 311329: on an adapter that holds bytes a mode switch of another motor stood between the queries.
#[test]
fn a_brake_that_is_due_waits_for_one_query_at_most_beside_a_switch() {
    for held in (0..200).step_by(10) {
        let ids = [id(1), id(2), id(3), id(4)];
        let mut fixture = Fixture::watching(WorldConfig::with_ids(ids), &ids);
        fixture.drive(rpm(100)).unwrap();
        fixture.run(ms(1_500));
        fixture.world.set_faults(WireFaults {
            hold: ms(120),
            ..WireFaults::default()
        });
        fixture.run(ms(held));
        let mode = Mode::Current;
        let switch = Command::SwitchMode { id: id(3), mode };
        fixture.command(switch).unwrap();
        fixture.forget_the_past();
        fixture.command(Command::Stop(ID)).unwrap();
        fixture.run(ms(500));
        let queries = |sent: &[Sent]| sent.iter().filter(|sent| sent.is_query()).count();
        let of_the_stop = fixture.sent.split(|sent| sent.drive_of(ID).is_some());
        let mut queries: Vec<usize> = of_the_stop.map(queries).collect();
        // Behind the last brake the stop has ended.
        queries.pop();
        assert!(
            queries.iter().all(|queries| *queries <= 1),
            "{held} ms: {queries:?}"
        );
    }
}
