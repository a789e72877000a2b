//! Start of a group with motors in other loops: none is driven before all are ready.

use motorlink_bus::{Activity, Command, Consent, Event, GroupSetpoints, Refusal};
use motorlink_protocol::{Instant, Mode, MotorId, Setpoint, family::Model};
use motorlink_simulator::WorldConfig;

use crate::fixture::driven_models::setpoint;
use crate::fixture::{Fixture, amps, degrees, id, ms, rpm};

pub const IDS: [u8; 3] = [1, 2, 3];

fn rover_of(model: Model) -> Fixture {
    let ids = IDS.map(id);
    let mut fixture = Fixture::watching(WorldConfig::of(model, ids), &ids);
    // A DDSM400 is enabled meanwhile.
    fixture.run(ms(700));
    fixture.forget_the_past();
    fixture
}

fn alone(fixture: &mut Fixture, motor: u8, setpoint: Setpoint) {
    let (id, consent) = (id(motor), Consent::None);
    let start = Command::Start {
        id,
        setpoint,
        consent,
    };
    fixture.command(start).unwrap();
}

/// The first motor is driven alone, the second in the position loop, and the third stands.
pub fn rover() -> Fixture {
    let mut fixture = rover_of(Model::Ddsm115);
    alone(&mut fixture, 1, rpm(80));
    alone(&mut fixture, 2, degrees(90.0));
    fixture.run(ms(1_500));
    fixture.forget_the_past();
    fixture
}

pub fn speeds(speeds: [i32; 3]) -> GroupSetpoints {
    let [one, two, three] = speeds.map(rpm);
    GroupSetpoints::new(&[(id(1), one), (id(2), two), (id(3), three)]).unwrap()
}

pub fn start(all: [i32; 3]) -> Command {
    Command::StartGroup {
        setpoints: speeds(all),
        consent: Consent::None,
    }
}

pub fn adjust(all: [i32; 3]) -> Command {
    Command::AdjustGroup {
        setpoints: speeds(all),
        consent: Consent::None,
    }
}

pub fn activities(fixture: &Fixture) -> [Activity; 3] {
    IDS.map(|motor| fixture.status(id(motor)).activity)
}

pub fn waits(fixture: &Fixture) -> bool {
    let waiting = IDS.map(|motor| fixture.status(id(motor)).waiting.is_some());
    assert!(waiting[0] == waiting[1] && waiting[1] == waiting[2]);
    waiting[0]
}

fn driven_at(all: [i32; 3]) -> [Activity; 3] {
    all.map(|speed| Activity::Driven {
        setpoint: rpm(speed),
    })
}

/// The drive frames that are neither zero nor brakes.
pub fn moving_frames(fixture: &Fixture) -> Vec<(MotorId, Instant)> {
    let moved = |sent: &crate::fixture::Sent| {
        let moved = IDS.map(id).into_iter().find(|motor| {
            let drive = sent.drive_of(*motor);
            drive.is_some_and(|drive| drive.signed() != 0)
        });
        moved.map(|motor| (motor, sent.at))
    };
    fixture.sent.iter().filter_map(moved).collect()
}

pub fn why_not(fixture: &Fixture) -> Option<(MotorId, Refusal)> {
    fixture.events.iter().find_map(|(_, event)| match event {
        Event::NotStarted { id, refusal } => Some((*id, *refusal)),
        _ => None,
    })
}

#[test]
fn all_stand_and_are_switched_before_the_first_is_driven() {
    let mut fixture = rover();
    fixture.command(start([100, -100, 50])).unwrap();
    assert!(waits(&fixture));
    let took = fixture.run_until(ms(2_500), |fixture| {
        assert!(waits(fixture) || moving_frames(fixture).len() <= 3);
        activities(fixture) == driven_at([100, -100, 50])
    });
    assert!(took > ms(100), "{took:?}");
    assert!(fixture.happened(|event| matches!(event, Event::StopEnded(_))));
    fixture.run(ms(2_000));
    let first = IDS.map(|motor| {
        let frames = moving_frames(&fixture);
        frames
            .into_iter()
            .find(|(of, _)| *of == id(motor))
            .unwrap()
            .1
    });
    let apart = first
        .iter()
        .max()
        .unwrap()
        .since(*first.iter().min().unwrap());
    assert!(apart < ms(20), "{apart:?}");
    for (motor, asked) in [(1, 100.0), (2, -100.0), (3, 50.0)] {
        let speed: f32 = fixture.world.motor(id(motor)).unwrap().speed_rpm();
        assert!((speed - asked).abs() < 5.0, "{motor} at {speed}");
    }
}

#[test]
fn motors_that_are_ready_start_at_once() {
    let mut fixture = rover_of(Model::Ddsm115);
    fixture.command(start([60, 60, 60])).unwrap();
    assert_eq!(activities(&fixture), driven_at([60, 60, 60]));
    fixture.command(start([90, 90, 90])).unwrap();
    assert_eq!(activities(&fixture), driven_at([90, 90, 90]));
    assert!(!fixture.happened(|event| matches!(event, Event::StopBegan(_))));
}

#[test]
fn one_alone_is_started_as_by_its_own_command() {
    let mut fixture = rover();
    let setpoints = GroupSetpoints::new(&[(id(2), rpm(40))]).unwrap();
    let consent = Consent::None;
    let start = Command::StartGroup { setpoints, consent };
    fixture.command(start).unwrap();
    fixture.run(ms(2_000));
    let setpoint = rpm(40);
    assert_eq!(activities(&fixture)[1], Activity::Driven { setpoint });
    assert_eq!(
        activities(&fixture)[0],
        Activity::Driven { setpoint: rpm(80) }
    );
}

#[test]
fn a_motor_that_may_not_be_driven_refuses_the_start_of_all() {
    let mut fixture = rover();
    fixture.world.motor_mut(id(3)).unwrap().mute(true);
    fixture.run(ms(1_000));
    let refused = fixture.command(start([100, 100, 100]));
    assert_eq!(refused, Err(Refusal::NotAnswering(id(3))));
    assert!(!waits(&fixture));
    assert_eq!(
        activities(&fixture)[0],
        Activity::Driven { setpoint: rpm(80) }
    );
}

#[test]
fn a_group_takes_the_place_of_what_one_of_its_motors_waits_for() {
    let mut fixture = rover();
    alone(&mut fixture, 1, amps(-1.0));
    fixture.command(start([70, 70, 70])).unwrap();
    fixture.run(ms(2_500));
    assert_eq!(activities(&fixture), driven_at([70, 70, 70]));
    assert_eq!(why_not(&fixture), None);
}

#[test]
fn the_newest_setpoints_wait() {
    let mut fixture = rover();
    fixture.command(start([100, -100, 50])).unwrap();
    for speed in 101..=110 {
        fixture.command(adjust([speed, 0, speed])).unwrap();
        fixture.run(ms(15));
    }
    assert!(waits(&fixture));
    fixture.command(start([70, 70, 70])).unwrap();
    fixture.run(ms(2_500));
    assert_eq!(activities(&fixture), driven_at([70, 70, 70]));
}

#[test]
fn none_of_a_waiting_group_is_driven_or_forgotten_apart_from_it() {
    let mut fixture = rover();
    fixture.command(start([100, -100, 50])).unwrap();
    fixture.run(ms(50));
    let (id, consent) = (id(3), Consent::None);
    let setpoint = rpm(30);
    let apart = [
        Command::Start {
            id,
            setpoint,
            consent,
        },
        Command::Drive {
            id,
            setpoint,
            consent,
        },
        Command::Forget(id),
    ];
    for command in apart {
        assert!(fixture.command(command).is_err(), "{command:?}");
    }
    fixture.run(ms(2_500));
    assert_eq!(activities(&fixture), driven_at([100, -100, 50]));
}

/// Every model, from each of its loops.
#[test]
fn each_model_is_driven_as_a_group_in_time() {
    for model in Model::ALL {
        for from in Mode::ALL.into_iter().filter(|mode| model.has(*mode)) {
            let mut fixture = rover_of(model);
            alone(&mut fixture, 2, setpoint(from));
            fixture.run(ms(1_500));
            fixture.command(start([60, 60, 60])).unwrap();
            let took = fixture.run_until(ms(2_500), |fixture| {
                activities(fixture) == driven_at([60, 60, 60])
            });
            assert!(took < ms(2_500), "{model} from {from}: {took:?}");
        }
    }
}
