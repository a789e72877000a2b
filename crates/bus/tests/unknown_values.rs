//! A value that no reply of that age has told is unknown: no default, and no older one with a new age.

use crate::fixture;
use motorlink_bus::{Bus, Command, Event, Sample, StopReason};
use motorlink_protocol::{Detail, Mode, Reply, Request, family::Model};
use motorlink_simulator::{WireFaults, WorldConfig};

use crate::fixture::driven_models::{on, setpoint, switched};
use crate::fixture::{Fixture, ID, ms, rpm};

const SEPARATE: [Model; 2] = [Model::Ddsm210, Model::Ddsm400];

fn samples(fixture: &Fixture) -> impl Iterator<Item = Sample> {
    fixture.events.iter().filter_map(|(_, event)| match event {
        Event::Telemetry(sample) => Some(*sample),
        _ => None,
    })
}

/// Turns the wheel at about 100 rpm.
fn turn_by_hand(fixture: &mut Fixture) {
    for (push_nm, time) in [(0.02, 300), (0.002, 300)] {
        fixture.world.motor_mut(ID).unwrap().set_push_nm(push_nm);
        fixture.run(ms(time));
    }
}

/// The port opens on a wheel that turns, and its motor gives its first odometry reply.
fn opened_on_a_turning_wheel(model: Model) -> Fixture {
    let mut fixture = on(model);
    turn_by_hand(&mut fixture);
    fixture.bus = Bus::with_model(fixture.now, model);
    fixture.forget_the_past();
    fixture.command(Command::Watch(ID)).unwrap();
    fixture.run_until(ms(300), |fixture| fixture.status(ID).counters.replies > 0);
    fixture
}

#[test]
fn the_first_odometry_reply_tells_no_speed() {
    for model in SEPARATE {
        let mut fixture = opened_on_a_turning_wheel(model);
        assert_eq!(fixture.status(ID).speed, None, "{model}");
        fixture.run(ms(400));
        let (_, speed) = fixture.status(ID).speed.unwrap();
        assert!(speed.magnitude() > 20, "{model}: {speed}");
    }
}

#[test]
fn stop_all_stops_a_motor_whose_speed_is_unknown() {
    for model in SEPARATE {
        let mut fixture = opened_on_a_turning_wheel(model);
        fixture
            .command(Command::StopAll(StopReason::Operator))
            .unwrap();
        fixture.world.motor_mut(ID).unwrap().set_push_nm(0.0);
        fixture.run(ms(1_000));
        let frames = fixture.drive_times(ID).len();
        assert!(frames > 10, "{model}: {frames} stop frames");
    }
}

#[test]
fn after_a_gap_of_over_a_second_the_old_speed_does_not_return() {
    for model in SEPARATE {
        let mut fixture = on(model);
        turn_by_hand(&mut fixture);
        fixture.world.motor_mut(ID).unwrap().mute(true);
        fixture.run(ms(3_000));
        fixture.world.motor_mut(ID).unwrap().mute(false);
        fixture.forget_the_past();
        fixture.run_until(ms(3_000), |fixture| samples(fixture).next().is_some());
        // The speed before the gap was about 100 rpm, and the free wheel has become slower.
        let told = samples(&fixture).next().unwrap().reply.speed;
        let off = told.map(|told| f32::from(told.rpm()) - fixture.true_rpm());
        assert!(off.is_none_or(|off| off.abs() < 5.0), "{model}: {told:?}");
    }
}

#[test]
fn an_odometry_reply_between_drive_replies_repeats_none_of_their_values() {
    for model in SEPARATE {
        let mut fixture = on(model);
        fixture.drive(rpm(60)).unwrap();
        fixture.run(ms(1_500));
        let odometry = |sample: &Sample| matches!(sample.reply.detail, Detail::Odometry { .. });
        let read: Vec<Reply> = samples(&fixture)
            .filter(odometry)
            .map(|sample| sample.reply)
            .collect();
        assert!(read.len() > 3, "{model}");
        let told = |reply: &Reply| reply.speed.is_some() || reply.current.is_some();
        assert!(!read.iter().skip(1).any(told), "{model}: {read:?}");
    }
}

/// In the position loop a drive reply has the angle in place of the speed.
#[test]
fn a_drive_reply_in_the_position_loop_tells_no_speed() {
    for model in SEPARATE {
        let mut fixture = switched(model, Mode::Position);
        fixture.drive(setpoint(Mode::Position)).unwrap();
        fixture.run(ms(500));
        let drive = |sample: &Sample| matches!(sample.reply.detail, Detail::Temperature(_));
        let told = samples(&fixture)
            .filter(drive)
            .find(|sample| sample.reply.speed.is_some());
        assert_eq!(told, None, "{model}");
    }
}

#[test]
fn the_loop_of_a_motor_that_has_not_named_it_is_unknown() {
    let mut fixture = Fixture::new(WorldConfig::of(Model::Ddsm210, [ID]));
    fixture.command(Command::Watch(ID)).unwrap();
    fixture.run_until(ms(300), |fixture| {
        fixture
            .sent
            .iter()
            .any(|sent| sent.frame.bytes()[1] == 0x75)
    });
    let query = |sent: &fixture::Sent| matches!(sent.request(), Request::Query { .. });
    assert!(fixture.sent.first().is_some_and(query));
    assert_eq!(samples(&fixture).next(), None);
}

/// An adapter begins to gather bytes: a query meets the reply to the one before, and the speed was half too high.
#[test]
fn an_odometry_reply_tells_no_speed_if_it_may_answer_an_earlier_query() {
    for hold in 30..80 {
        let mut fixture = on(Model::Ddsm210);
        fixture.drive(rpm(60)).unwrap();
        fixture.run(ms(2_000));
        fixture.forget_the_past();
        fixture.world.set_faults(WireFaults {
            hold: ms(hold),
            ..WireFaults::default()
        });
        // Before its setpoint is withdrawn.
        fixture.run(ms(150));
        assert!(fixture.true_rpm().abs() > 55.0);
        for Sample { at, reply } in samples(&fixture) {
            if let (Detail::Odometry { .. }, Some(speed)) = (reply.detail, reply.speed) {
                let rpm = speed.magnitude();
                assert!((50..=70).contains(&rpm), "{hold} ms, at {at:?}: {rpm} rpm");
            }
        }
    }
}
