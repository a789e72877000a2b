//! Motors that are driven as one.

use crate::fixture;
use crate::fixture::{Fixture, id, ms, rpm};
use motorlink_bus::{
    Activity, BusSettings, Command, Consent, Event, GroupError, GroupSetpoints, Ramp, Refusal,
    StopReason,
};
use motorlink_protocol::{Drive, Mode, MotorId, Setpoint};
use motorlink_simulator::WorldConfig;

fn rover() -> Fixture {
    let ids = [id(1), id(2), id(3)];
    Fixture::watching(WorldConfig::with_ids(ids), &ids)
}

fn parts(speeds: &[(u8, i32)]) -> GroupSetpoints {
    let parts: Vec<(MotorId, Setpoint)> = speeds
        .iter()
        .map(|(motor, speed)| (id(*motor), rpm(*speed)))
        .collect();
    GroupSetpoints::new(&parts).unwrap()
}

fn drive(fixture: &mut Fixture, speeds: &[(u8, i32)]) -> Result<(), Refusal> {
    fixture.command(Command::DriveGroup {
        setpoints: parts(speeds),
        consent: Consent::None,
    })
}

fn adjust(fixture: &mut Fixture, speeds: &[(u8, i32)]) -> Result<(), Refusal> {
    fixture.command(Command::AdjustGroup {
        setpoints: parts(speeds),
        consent: Consent::None,
    })
}

fn speed(fixture: &Fixture, motor: u8) -> f32 {
    fixture.world.motor(id(motor)).unwrap().speed_rpm()
}

fn is_driven(fixture: &Fixture, motor: u8) -> bool {
    matches!(fixture.status(id(motor)).activity, Activity::Driven { .. })
}

#[test]
fn all_of_a_group_start_and_each_has_its_own_setpoint() {
    let mut fixture = rover();
    drive(&mut fixture, &[(1, 100), (2, -100)]).unwrap();
    fixture.run(ms(2_000));
    assert!((speed(&fixture, 1) - 100.0).abs() < 5.0);
    assert!((speed(&fixture, 2) + 100.0).abs() < 5.0);
    assert!(speed(&fixture, 3).abs() < 1.0, "it was not asked");
    adjust(&mut fixture, &[(1, 50), (2, -60)]).unwrap();
    fixture.run(ms(2_000));
    assert!((speed(&fixture, 1) - 50.0).abs() < 5.0);
    assert!((speed(&fixture, 2) + 60.0).abs() < 5.0);
}

#[test]
fn where_one_may_not_be_driven_none_is() {
    let mut fixture = rover();
    fixture
        .command(Command::SwitchMode {
            id: id(2),
            mode: Mode::Current,
        })
        .unwrap();
    assert_eq!(
        drive(&mut fixture, &[(1, 100), (2, 100)]),
        Err(Refusal::Switching(id(2)))
    );
    fixture.run(ms(500));
    assert_eq!(
        drive(&mut fixture, &[(1, 100), (2, 100)]),
        Err(Refusal::OtherLoop {
            id: id(2),
            asked: Mode::Velocity,
            reported: Mode::Current
        })
    );
    assert_eq!(
        drive(&mut fixture, &[(1, 100), (9, 100)]),
        Err(Refusal::NotAnswering(id(9)))
    );
    fixture.run(ms(500));
    assert!(!is_driven(&fixture, 1) && speed(&fixture, 1).abs() < 1.0);
}

#[test]
fn when_one_falls_silent_all_are_stopped() {
    let mut fixture = rover();
    drive(&mut fixture, &[(1, 100), (2, 100)]).unwrap();
    fixture
        .command(Command::Drive {
            id: id(3),
            setpoint: rpm(60),
            consent: Consent::None,
        })
        .unwrap();
    fixture.run(ms(2_000));
    fixture.world.motor_mut(id(2)).unwrap().power(false);
    fixture.run(ms(400));
    assert!(
        !is_driven(&fixture, 1),
        "no wheel goes on without the other"
    );
    fixture.run(ms(4_000));
    assert!(speed(&fixture, 1).abs() < 1.0);
    assert!(is_driven(&fixture, 3), "it is none of theirs");
    assert!((speed(&fixture, 3) - 60.0).abs() < 5.0);
}

#[test]
fn a_stop_of_one_is_a_stop_of_all_of_them_in_the_same_rounds() {
    let mut fixture = rover();
    drive(&mut fixture, &[(1, 100), (2, 100)]).unwrap();
    fixture.run(ms(2_000));
    fixture.forget_the_past();
    fixture.command(Command::Stop(id(1))).unwrap();
    fixture.run(ms(100));
    let brake: Drive = Setpoint::Brake.into();
    let brakes = |motor: u8| {
        let of_motor = fixture.sent.iter();
        of_motor
            .filter(|sent| sent.drive_of(id(motor)) == Some(brake))
            .count()
    };
    assert!(brakes(1) > 5 && brakes(1).abs_diff(brakes(2)) <= 1);
    fixture.run(ms(3_000));
    assert!(speed(&fixture, 1).abs() < 1.0 && speed(&fixture, 2).abs() < 1.0);
    assert!(fixture.happened(|event| *event == Event::StopBegan(StopReason::OneMotor)));
}

#[test]
fn none_of_a_group_is_driven_apart_from_it() {
    let mut fixture = rover();
    drive(&mut fixture, &[(1, 100), (2, 100)]).unwrap();
    fixture.run(ms(500));
    let together = Err(Refusal::InGroup(id(1)));
    assert_eq!(
        fixture.command(Command::Drive {
            id: id(1),
            setpoint: rpm(50),
            consent: Consent::None,
        }),
        together
    );
    assert_eq!(
        fixture.command(Command::SwitchMode {
            id: id(1),
            mode: Mode::Current
        }),
        together
    );
    assert_eq!(drive(&mut fixture, &[(1, 50), (3, 50)]), together);
    assert_eq!(adjust(&mut fixture, &[(1, 50)]), together);
    // All of them and another are a larger group.
    drive(&mut fixture, &[(1, 50), (2, 50), (3, 50)]).unwrap();
}

/// What a pad sends while it is held: it never starts a wheel.
#[test]
fn what_is_adjusted_after_a_stop_stays_stopped() {
    let mut fixture = rover();
    drive(&mut fixture, &[(1, 100), (2, 100)]).unwrap();
    fixture.run(ms(1_000));
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    assert!(adjust(&mut fixture, &[(1, 80), (2, 80)]).is_err());
    fixture.run(ms(2_000));
    fixture.command(Command::Release).unwrap();
    assert_eq!(
        adjust(&mut fixture, &[(1, 80), (2, 80)]),
        Err(Refusal::NotDriven(id(1)))
    );
    fixture.run(ms(1_000));
    assert!(speed(&fixture, 1).abs() < 1.0);
}

/// What the page's Stop and Brake send in each loop.
#[test]
fn zero_and_brake_for_one_of_a_group_stop_all_of_it() {
    for setpoint in [rpm(0), Setpoint::Brake] {
        for adjusts in [false, true] {
            let mut fixture = rover();
            drive(&mut fixture, &[(1, 100), (2, 100)]).unwrap();
            fixture.run(ms(1_000));
            let (id, consent) = (id(1), Consent::None);
            let command = if adjusts {
                Command::Adjust {
                    id,
                    setpoint,
                    consent,
                }
            } else {
                Command::Drive {
                    id,
                    setpoint,
                    consent,
                }
            };
            fixture.command(command).unwrap();
            fixture.run(ms(1_000));
            assert!(speed(&fixture, 1).abs() < 1.0 && speed(&fixture, 2).abs() < 1.0);
        }
    }
}

#[test]
fn a_hold_of_one_of_a_group_stops_all_of_it() {
    let mut fixture = rover();
    for motor in [1, 2] {
        fixture
            .command(Command::SwitchMode {
                id: id(motor),
                mode: Mode::Position,
            })
            .unwrap();
    }
    fixture.run(ms(600));
    let parts = [
        (id(1), fixture::degrees(90.0)),
        (id(2), fixture::degrees(90.0)),
    ];
    let parts = GroupSetpoints::new(&parts).unwrap();
    let consent = Consent::None;
    fixture
        .command(Command::DriveGroup {
            setpoints: parts,
            consent,
        })
        .unwrap();
    fixture.run(ms(50));
    fixture.command(Command::Hold(id(1))).unwrap();
    assert!(!is_driven(&fixture, 1) && !is_driven(&fixture, 2));
}

#[test]
fn the_end_of_a_raw_run_on_one_of_a_group_stops_all_of_it() {
    let mut fixture = rover();
    let frame = fixture::drive_frame(id(1), rpm(50));
    fixture
        .command(fixture::raw(frame, motorlink_bus::Repeat::Once))
        .unwrap();
    fixture.run(ms(300));
    drive(&mut fixture, &[(1, 100), (2, 100)]).unwrap();
    fixture.run(ms(500));
    fixture.command(Command::StopRaw).unwrap();
    fixture.run(ms(1_000));
    assert!(!is_driven(&fixture, 1) && !is_driven(&fixture, 2));
}

#[test]
fn one_alone_is_no_group() {
    let mut fixture = rover();
    drive(&mut fixture, &[(1, 100)]).unwrap();
    fixture
        .command(Command::Adjust {
            id: id(1),
            setpoint: rpm(50),
            consent: Consent::None,
        })
        .unwrap();
}

#[test]
fn a_group_is_of_different_motors_and_not_empty() {
    assert_eq!(GroupSetpoints::new(&[]), Err(GroupError::Empty));
    let twice = [(id(1), rpm(1)), (id(2), rpm(1)), (id(1), rpm(2))];
    assert_eq!(
        GroupSetpoints::new(&twice),
        Err(GroupError::Duplicate(id(1)))
    );
    let many: Vec<_> = (1..=17).map(|motor| (id(motor), rpm(1))).collect();
    assert_eq!(GroupSetpoints::new(&many), Err(GroupError::TooMany));
}

#[test]
fn a_ramp_bounds_what_is_sent_but_no_stop() {
    let mut fixture = rover();
    fixture
        .command(Command::Configure(BusSettings {
            ramp: Some(Ramp::new(100).unwrap()),
            ..BusSettings::default()
        }))
        .unwrap();
    drive(&mut fixture, &[(1, 200), (2, -200)]).unwrap();
    fixture.run(ms(1_000));
    for (motor, sign) in [(1, 1.0), (2, -1.0)] {
        let along = speed(&fixture, motor) * sign;
        assert!((85.0..=102.0).contains(&along), "{along} after a second");
    }
    fixture.run(ms(2_000));
    assert!((speed(&fixture, 1) - 200.0).abs() < 5.0);
    fixture.command(Command::Stop(id(1))).unwrap();
    fixture.run(ms(700));
    assert!(speed(&fixture, 1).abs() < 2.0, "no ramp holds a stop up");
}
