//! Changing loops: five frames, confirmed by replies, and refused where the wheel would move by it.

use crate::fixture;
use crate::fixture::{Fixture, ID, amps, degrees, id, longest_gap, ms, rpm};
use motorlink_bus::{Activity, Command, Event, Refusal};
use motorlink_protocol::{Drive, Mode, Setpoint};

#[test]
fn a_switch_is_sent_five_times_and_confirmed_by_replies() {
    let mut fixture = Fixture::one_motor();
    fixture
        .command(Command::SwitchMode {
            id: ID,
            mode: Mode::Current,
        })
        .unwrap();
    fixture.run(ms(400));
    let switches: Vec<_> = fixture
        .sent
        .iter()
        .filter(|s| s.is_switch())
        .map(|s| s.at)
        .collect();
    assert_eq!(switches.len(), 5);
    for pair in switches.windows(2) {
        let gap = pair[1].since(pair[0]);
        assert!(gap >= ms(19) && gap <= ms(24), "{gap:?}");
    }
    assert!(fixture.happened(|e| *e
        == Event::ModeSwitched {
            id: ID,
            mode: Mode::Current
        }));
    assert_eq!(fixture.activity(), Activity::Idle);
}

/// Zero means 0 rpm before the switch and 0 A after it; the old setpoint would mean something else.
#[test]
fn a_driven_motor_is_driven_on_at_zero_while_it_is_switched() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    fixture.forget_the_past();
    fixture
        .command(Command::SwitchMode {
            id: ID,
            mode: Mode::Current,
        })
        .unwrap();
    fixture.run(ms(500));
    let frames = fixture.drive_times(ID);
    assert!(longest_gap(&frames) <= ms(25), "{:?}", longest_gap(&frames));
    let values = fixture
        .sent
        .iter()
        .filter_map(|s| s.drive_of(ID))
        .map(Drive::signed);
    assert!(values.into_iter().all(|value| value == 0));
    assert!(fixture.happened(|e| *e
        == Event::ModeSwitched {
            id: ID,
            mode: Mode::Current
        }));
}

#[test]
fn the_position_loop_is_refused_to_a_turning_wheel_and_to_an_unknown_speed() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    let to_position = |id| Command::SwitchMode {
        id,
        mode: Mode::Position,
    };
    assert!(matches!(
        fixture.command(to_position(ID)),
        Err(Refusal::TooFast(_))
    ));
    assert_eq!(
        fixture.command(to_position(id(9))),
        Err(Refusal::SpeedUnknown(id(9)))
    );
    fixture.run(ms(100));
    assert!(!fixture.sent.iter().any(fixture::Sent::is_switch));
}

/// The motor silently refuses the position loop above 10 rpm; the bus reports a switch that is not confirmed.
#[test]
fn a_switch_that_the_motor_refuses_is_reported() {
    let mut fixture = Fixture::one_motor();
    fixture.world.motor_mut(ID).unwrap().mute(true);
    fixture
        .command(Command::SwitchMode {
            id: ID,
            mode: Mode::Position,
        })
        .unwrap();
    fixture.run(ms(1_000));
    assert!(fixture.happened(|e| matches!(
        e,
        Event::ModeSwitchFailed {
            asked: Mode::Position,
            ..
        }
    )));
}

#[test]
fn the_position_loop_reaches_its_target_and_holds_its_angle_on_command() {
    let mut fixture = Fixture::one_motor();
    fixture.switch(Mode::Position);
    fixture.drive(degrees(90.0)).unwrap();
    fixture.run(ms(3_000));
    let angle = |fixture: &Fixture| fixture.status(ID).position.unwrap().1.degrees();
    assert!((angle(&fixture) - 90.0).abs() < 2.0, "{}", angle(&fixture));
    fixture.drive(degrees(200.0)).unwrap();
    fixture.run(ms(60));
    fixture.command(Command::Hold(ID)).unwrap();
    fixture.run(ms(5)); // the next reply says where it is
    let Activity::Driven {
        setpoint: Setpoint::Position(held),
    } = fixture.activity()
    else {
        panic!("{:?}", fixture.activity())
    };
    fixture.run(ms(2_000));
    assert!((angle(&fixture) - held.degrees()).abs() < 3.0);
}

/// The drive that was given during the switch is carried out behind its fifth frame, 100 ms later.
#[test]
fn a_motor_that_loses_power_during_a_switch_is_not_started_behind_it() {
    for cut_ms in (0..120).step_by(3) {
        let mut fixture = Fixture::one_motor();
        fixture.switch(Mode::Current);
        // Driven, it reports its loop with every frame, long before the fifth switch.
        fixture.drive(amps(0.0)).unwrap();
        fixture.run(ms(200));
        fixture.forget_the_past();
        let switch = Command::SwitchMode {
            id: ID,
            mode: Mode::Velocity,
        };
        fixture.command(switch).unwrap();
        fixture.drive(rpm(100)).unwrap();
        fixture.run(ms(cut_ms));
        fixture.world.motor_mut(ID).unwrap().power(false);
        let cut = fixture.now;
        fixture.run(ms(1_500));
        let last = fixture.drive_times(ID).into_iter().filter(|at| {
            let moves = |sent: &&fixture::Sent| {
                sent.at == *at && sent.drive_of(ID).is_some_and(|drive| drive.signed() != 0)
            };
            fixture.sent.iter().any(|sent| moves(&sent))
        });
        // As if it had been driven all along.
        let late = last.max().map_or(ms(0), |at| at.since(cut));
        assert!(
            late <= ms(250),
            "driven {late:?} after the cut at {cut_ms} ms"
        );
    }
}
