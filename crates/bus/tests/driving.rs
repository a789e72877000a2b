//! Driving: rates, queries in addition, several motors, and what is refused.

use crate::fixture::{Fixture, ID, amps, id, longest_gap, ms, rpm, two};
use motorlink_bus::{
    Activity, BusSettings, Command, CommandRate, Consent, Event, IdQueryOutcome, Refusal,
};
use motorlink_protocol::{Detail, Drive, Mode, MotorId};
use motorlink_simulator::{MotorConfig, WorldConfig};

fn with_motors(addresses: &[u8]) -> WorldConfig {
    let motors = addresses
        .iter()
        .map(|address| MotorConfig::new(id(*address)))
        .collect();
    WorldConfig {
        motors,
        ..WorldConfig::default()
    }
}

fn temperatures(fixture: &Fixture) -> usize {
    let is_query = |event: &Event| matches!(event, Event::Telemetry(sample) if matches!(sample.reply.detail, Detail::Query { .. }));
    fixture
        .events
        .iter()
        .filter(|(_, event)| is_query(event))
        .count()
}

#[test]
fn the_id_query_finds_the_one_motor() {
    let mut fixture = Fixture::new(with_motors(&[7]));
    fixture.command(Command::IdQuery).unwrap();
    fixture.run(ms(100));
    assert!(fixture.happened(|e| *e == Event::IdQueryEnded(IdQueryOutcome::One(id(7)))));
}

#[test]
fn several_motors_that_answer_the_id_query_at_once_are_called_garbled() {
    let mut fixture = Fixture::new(with_motors(&[1, 2, 3]));
    fixture.command(Command::IdQuery).unwrap();
    fixture.run(ms(100));
    assert!(fixture.happened(|e| *e == Event::IdQueryEnded(IdQueryOutcome::Garbled)));
}

#[test]
fn an_id_query_on_an_empty_line_has_no_reply() {
    let mut fixture = Fixture::new(with_motors(&[]));
    fixture.command(Command::IdQuery).unwrap();
    fixture.run(ms(100));
    assert!(fixture.happened(|e| *e == Event::IdQueryEnded(IdQueryOutcome::NoReply)));
}

#[test]
fn a_driven_motor_gets_fifty_drive_frames_a_second_and_ten_queries_in_addition() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(10_000));
    let frames = fixture.drive_times(ID);
    assert!((499..=501).contains(&frames.len()), "{}", frames.len());
    assert!(longest_gap(&frames) <= ms(21), "{:?}", longest_gap(&frames));
    let fresh = temperatures(&fixture);
    assert!((98..=102).contains(&fresh), "{fresh} temperatures");
    assert!((fixture.true_rpm() - 100.0).abs() < 3.0);
    assert_eq!(fixture.status(ID).link.command_hz, 50);
    assert_eq!(fixture.status(ID).link.loss_per_mille, Some(0));
}

#[test]
fn the_rate_is_a_setting() {
    for hertz in [1, 20, 200] {
        let mut fixture = Fixture::one_motor();
        fixture
            .command(Command::Configure(BusSettings {
                rate: CommandRate::new(hertz).unwrap(),
                ..BusSettings::default()
            }))
            .unwrap();
        // At 1 Hz the wheel coasts between frames; nothing is withdrawn, since queries answer.
        fixture.drive(rpm(50)).unwrap();
        fixture.run(ms(5_000));
        let frames = fixture.drive_times(ID).len();
        let asked = usize::from(hertz) * 5;
        assert!(
            frames.abs_diff(asked) <= 1 + asked / 100,
            "{frames} at {hertz} Hz"
        );
        assert!(temperatures(&fixture) >= 40);
    }
}

#[test]
fn several_motors_are_driven_side_by_side() {
    let ids: Vec<MotorId> = (1..=4).map(id).collect();
    let mut fixture = Fixture::watching(with_motors(&[1, 2, 3, 4]), &ids);
    for (place, motor) in ids.iter().enumerate() {
        let setpoint = rpm(40 + 20 * i32::try_from(place).unwrap());
        fixture
            .command(Command::Drive {
                id: *motor,
                setpoint,
                consent: Consent::None,
            })
            .unwrap();
    }
    fixture.run(ms(5_000));
    for motor in ids {
        let frames = fixture.drive_times(motor);
        assert!(
            (248..=252).contains(&frames.len()),
            "{motor:?}: {}",
            frames.len()
        );
        assert!(
            longest_gap(&frames) <= ms(30),
            "{motor:?}: {:?}",
            longest_gap(&frames)
        );
        assert!(fixture.status(motor).temperature.is_some());
    }
}

#[test]
fn nothing_but_a_drive_command_sends_a_drive_frame() {
    let mut fixture = Fixture::one_motor();
    for command in [
        Command::Watch(id(9)),
        Command::IdQuery,
        Command::SwitchMode {
            id: ID,
            mode: Mode::Current,
        },
        Command::Configure(BusSettings {
            rate: CommandRate::default(),
            ..BusSettings::default()
        }),
        Command::Release,
    ] {
        fixture.command(command).unwrap();
        fixture.run(ms(500));
    }
    let adjust = Command::Adjust {
        id: ID,
        setpoint: amps(1.0),
        consent: Consent::None,
    };
    assert_eq!(fixture.command(adjust), Err(Refusal::NotDriven(ID)));
    fixture.run(ms(500));
    assert!(fixture.drive_times(ID).is_empty());
}

#[test]
fn a_setpoint_of_another_loop_is_refused() {
    let mut fixture = Fixture::one_motor();
    assert_eq!(
        fixture.drive(amps(1.0)),
        Err(Refusal::OtherLoop {
            id: ID,
            asked: Mode::Current,
            reported: Mode::Velocity
        })
    );
    assert_eq!(
        fixture.command(Command::Hold(ID)),
        Err(Refusal::NotHolding(ID))
    );
}

#[test]
fn a_motor_that_never_answered_is_not_driven() {
    let mut fixture = Fixture::one_motor();
    let command = Command::Drive {
        id: id(9),
        setpoint: rpm(50),
        consent: Consent::None,
    };
    assert_eq!(fixture.command(command), Err(Refusal::NotAnswering(id(9))));
}

#[test]
fn a_high_current_asks_first() {
    let mut fixture = Fixture::one_motor();
    fixture.switch(Mode::Current);
    assert!(matches!(
        fixture.drive(amps(6.2)),
        Err(Refusal::NeedsConsent(_))
    ));
    let command = Command::Drive {
        id: ID,
        setpoint: amps(6.2),
        consent: Consent::HighCurrent,
    };
    assert_eq!(fixture.command(command), Ok(()));
}

#[test]
fn a_torque_reversal_passes_through_zero() {
    let mut fixture = Fixture::one_motor();
    fixture.switch(Mode::Current);
    fixture.drive(amps(0.2)).unwrap();
    fixture.run(ms(100));
    fixture.forget_the_past();
    fixture.drive(amps(-0.2)).unwrap();
    fixture.run(ms(100));
    let values: Vec<i16> = fixture
        .sent
        .iter()
        .filter_map(|s| s.drive_of(ID))
        .map(Drive::signed)
        .collect();
    assert_eq!(values[0], 0, "{values:?}");
    assert!(values[1..].iter().all(|value| *value < 0), "{values:?}");
}

#[test]
fn an_adjustment_moves_the_setpoint_of_a_driven_motor_only() {
    let mut fixture = Fixture::one_motor();
    let adjust = |to| Command::Adjust {
        id: ID,
        setpoint: rpm(to),
        consent: Consent::None,
    };
    assert_eq!(fixture.command(adjust(80)), Err(Refusal::NotDriven(ID)));
    fixture.drive(rpm(50)).unwrap();
    fixture.run(ms(200));
    fixture.command(adjust(80)).unwrap();
    assert_eq!(fixture.activity(), Activity::Driven { setpoint: rpm(80) });
    // A drag that outlasts a stop does not undo it.
    fixture.command(Command::Stop(ID)).unwrap();
    assert!(fixture.command(adjust(80)).is_err());
    fixture.run(ms(1_000));
    assert!(fixture.command(adjust(80)).is_err());
}

#[test]
fn a_motor_that_is_driven_is_not_forgotten() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(50)).unwrap();
    assert_eq!(
        fixture.command(Command::Forget(ID)),
        Err(Refusal::Driven(ID))
    );
}

/// A motor is also asked while another one is selected, so its turns go on.
#[test]
fn the_turns_of_a_motor_go_on_while_another_one_is_selected() {
    let mut fixture = two();
    let turns = |fixture: &Fixture| fixture.status(ID).turns.unwrap().number();
    fixture.drive(rpm(60)).unwrap();
    fixture.run(ms(5_000));
    let at_change = turns(&fixture);
    assert!((4.0..5.5).contains(&at_change), "{at_change} turns");
    fixture.command(Command::Watch(id(2))).unwrap();
    fixture.run(ms(5_000));
    fixture.command(Command::Watch(ID)).unwrap();
    fixture.run(ms(5_000));
    let all = turns(&fixture) - at_change;
    assert!((9.5..10.5).contains(&all), "{all} turns");
}
