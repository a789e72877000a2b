//! Limits that a person sets: crossing one stops the motor, and the bus reports the reason.

use crate::fixture::{
    Fixture, ID, Sent, amps, degrees, drive_frame, driven_models, every, id, ms, raw, rpm,
};
use motorlink_bus::{
    Activity, BusSettings, Command, Consent, Event, ExceededLimit, GroupSetpoints, Limits,
    RawInterval, Refusal, Repeat, WithdrawReason,
};
use motorlink_protocol::{
    Mode, Request,
    family::{self, Model},
};
use motorlink_simulator::WorldConfig;

fn limited(speed_rpm: u16, current_ma: u16, temperature_c: u16) -> Fixture {
    let mut fixture = Fixture::one_motor();
    let limits = Limits::new(speed_rpm, current_ma, temperature_c).unwrap();
    fixture
        .command(Command::Configure(BusSettings {
            limits,
            ..BusSettings::default()
        }))
        .unwrap();
    fixture
}

/// The limit that the motor was stopped for.
fn exceeded(fixture: &Fixture) -> Option<ExceededLimit> {
    fixture.events.iter().find_map(|(_, event)| match event {
        Event::Withdrawn {
            id: ID,
            reason: WithdrawReason::Limit(exceeded),
        } => Some(*exceeded),
        _ => None,
    })
}

fn heat(fixture: &mut Fixture, steps_c: &[u8]) {
    for celsius in steps_c {
        let motor = fixture.world.motor_mut(ID).unwrap();
        motor.set_temperature_c((*celsius).into());
        fixture.run(ms(400));
    }
}

/// It was stopped for a limit, stands, and is not driven.
fn assert_stopped_for_good(fixture: &mut Fixture) {
    fixture.run(ms(3_500));
    assert!(fixture.true_rpm().abs() < 1.0);
    assert_eq!(fixture.status(ID).activity, Activity::Idle);
    fixture.forget_the_past();
    fixture.run(ms(2_000));
    assert!(fixture.sent.iter().all(Sent::is_query));
}

#[test]
fn a_wheel_that_runs_away_in_the_current_loop_is_stopped_at_its_speed_limit() {
    let mut fixture = limited(60, 2_700, 75);
    fixture.switch(Mode::Current);
    fixture.drive(amps(0.4)).unwrap();
    fixture.run_until(ms(2_000), |fixture| exceeded(fixture).is_some());
    assert!(matches!(
        exceeded(&fixture),
        Some(ExceededLimit::Speed { limit: 60, .. })
    ));
    // Unloaded it gains some 50 rpm in a drive period, and its report lags; it would reach 200.
    let fastest = fixture.true_rpm().abs();
    assert!(fastest < 150.0, "{fastest} rpm when it was stopped");
    assert_stopped_for_good(&mut fixture);
}

#[test]
fn a_wheel_at_its_speed_limit_goes_on() {
    let mut fixture = limited(100, 2_700, 75);
    fixture.drive(rpm(-100)).unwrap();
    fixture.run(ms(3_000));
    assert_eq!(exceeded(&fixture), None);
    assert!((fixture.true_rpm() + 100.0).abs() < 3.0);
}

#[test]
fn more_than_the_speed_limit_is_not_asked_for_alone_or_together_or_by_a_slider() {
    let mut fixture = limited(100, 2_700, 75);
    let above = Err(Refusal::AboveSpeedLimit(100));
    assert_eq!(fixture.drive(rpm(101)), above);
    let parts = GroupSetpoints::new(&[(ID, rpm(-101))]).unwrap();
    let consent = Consent::None;
    let together = Command::DriveGroup {
        setpoints: parts,
        consent,
    };
    assert_eq!(fixture.command(together), above);
    fixture.drive(rpm(100)).unwrap();
    let setpoint = rpm(150);
    let adjust = Command::Adjust {
        id: ID,
        setpoint,
        consent,
    };
    assert_eq!(fixture.command(adjust), above);
    fixture.run(ms(1_000));
    assert!(
        (fixture.true_rpm() - 100.0).abs() < 3.0,
        "as it was asked before"
    );
}

#[test]
fn a_limit_that_is_lowered_below_what_turns_stops_it() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(150)).unwrap();
    fixture.run(ms(1_500));
    let limits = Limits::new(100, 2_700, 75).unwrap();
    fixture
        .command(Command::Configure(BusSettings {
            limits,
            ..BusSettings::default()
        }))
        .unwrap();
    fixture.run(ms(100));
    assert!(matches!(
        exceeded(&fixture),
        Some(ExceededLimit::Speed { limit: 100, .. })
    ));
    assert_stopped_for_good(&mut fixture);
}

#[test]
fn a_current_above_its_limit_stops_after_half_a_second_and_not_before() {
    let mut fixture = limited(330, 1_000, 75);
    fixture.drive(rpm(60)).unwrap();
    fixture.run(ms(1_000));
    assert_eq!(exceeded(&fixture), None, "what a start takes is let pass");
    fixture.world.motor_mut(ID).unwrap().set_load_nm(1.2);
    let overloaded = |fixture: &Fixture| fixture.status(ID).current.unwrap().1.amps() > 1.0;
    fixture.run_until(ms(500), overloaded);
    fixture.run(ms(400));
    assert_eq!(exceeded(&fixture), None);
    fixture.run(ms(150));
    assert!(matches!(
        exceeded(&fixture),
        Some(ExceededLimit::Current { limit: 1_000, .. })
    ));
    fixture.world.motor_mut(ID).unwrap().set_load_nm(0.0);
    assert_stopped_for_good(&mut fixture);
}

#[test]
fn a_hot_motor_is_stopped_before_it_protects_itself_and_not_started_before_it_is_cooler() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(60)).unwrap();
    fixture.run(ms(500));
    heat(&mut fixture, &[72, 74, 76]);
    assert!(matches!(
        exceeded(&fixture),
        Some(ExceededLimit::Temperature { limit: 75, .. })
    ));
    assert_stopped_for_good(&mut fixture);
    heat(&mut fixture, &[77, 77]);
    assert!(matches!(
        fixture.drive(rpm(60)),
        Err(Refusal::TooHot { id: ID, .. })
    ));
    heat(&mut fixture, &[73, 71]);
    fixture.drive(rpm(60)).unwrap();
}

#[test]
fn the_other_motors_of_a_group_stop_too() {
    let config = WorldConfig::with_ids([ID, id(2)]);
    let mut fixture = Fixture::watching(config, &[ID, id(2)]);
    let limits = Limits::new(330, 1_000, 75).unwrap();
    fixture
        .command(Command::Configure(BusSettings {
            limits,
            ..BusSettings::default()
        }))
        .unwrap();
    let parts = GroupSetpoints::new(&[(ID, rpm(60)), (id(2), rpm(60))]).unwrap();
    let consent = Consent::None;
    fixture
        .command(Command::DriveGroup {
            setpoints: parts,
            consent,
        })
        .unwrap();
    fixture.run(ms(1_000));
    fixture.world.motor_mut(ID).unwrap().set_load_nm(1.2);
    fixture.run(ms(3_000));
    assert!(matches!(
        exceeded(&fixture),
        Some(ExceededLimit::Current { .. })
    ));
    assert_eq!(fixture.status(id(2)).activity, Activity::Idle);
}

#[test]
fn raw_frames_are_held_to_the_limits_as_any_driving_is() {
    let interval = RawInterval::new(20).unwrap();
    let consent = Consent::None;
    let send = |setpoint| Command::SendRaw {
        frame: Request::drive(ID, setpoint).frame(),
        repeat: Repeat::Times { count: 0, interval },
        consent,
    };
    let mut fixture = limited(50, 2_700, 75);
    assert_eq!(
        fixture.command(send(rpm(100))),
        Err(Refusal::AboveSpeedLimit(50))
    );
    fixture.switch(Mode::Current);
    fixture.command(send(amps(0.4))).unwrap();
    fixture.run(ms(2_000));
    assert!(matches!(
        exceeded(&fixture),
        Some(ExceededLimit::Speed { limit: 50, .. })
    ));
    assert_stopped_for_good(&mut fixture);
    heat(&mut fixture, &[72, 74, 76]);
    assert!(matches!(
        fixture.command(send(rpm(10))),
        Err(Refusal::TooHot { id: ID, .. })
    ));
}

#[test]
fn an_angle_is_gone_to_within_the_limits() {
    let mut fixture = Fixture::one_motor();
    fixture.switch(Mode::Position);
    fixture.drive(degrees(180.0)).unwrap();
    fixture.run(ms(2_000));
    assert_eq!(exceeded(&fixture), None);
}

#[test]
fn a_speed_limit_that_is_set_below_what_is_driven_stops_it_before_the_next_frame() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    fixture.forget_the_past();
    let limits = Limits::new(60, 2_700, 75).unwrap();
    fixture
        .command(Command::Configure(BusSettings {
            limits,
            ..BusSettings::default()
        }))
        .unwrap();
    fixture.run(ms(1_000));
    let fast = |sent: &Sent| sent.drive_of(ID).is_some_and(|drive| drive.signed() > 60);
    assert!(!fixture.sent.iter().any(fast));
    assert!(fixture.happened(|event| matches!(
        event,
        Event::Withdrawn {
            reason: WithdrawReason::Limit(ExceededLimit::Speed { limit: 60, .. }),
            ..
        }
    )));
    assert!(fixture.true_rpm().abs() < 1.0);
}

/// A wheel that starts, or is within what a wheel overshoots, does not exceed the limit by its replies yet.
#[test]
fn no_frame_exceeds_a_lowered_limit_though_no_reply_does() {
    for (driven_for, lowered_to) in [(ms(20), 100), (ms(2_000), 195)] {
        let mut fixture = Fixture::one_motor();
        fixture.drive(rpm(200)).unwrap();
        fixture.run(driven_for);
        fixture.forget_the_past();
        let limits = Limits::new(lowered_to, 2_700, 75).unwrap();
        fixture
            .command(Command::Configure(BusSettings {
                limits,
                ..BusSettings::default()
            }))
            .unwrap();
        fixture.run(ms(3_000));
        let speeds = fixture.sent.iter().filter_map(|sent| sent.drive_of(ID));
        let fastest = speeds.map(|drive| drive.signed().unsigned_abs()).max();
        assert!(
            fastest <= Some(lowered_to),
            "{fastest:?} after {lowered_to}"
        );
        assert_eq!(
            exceeded(&fixture).map(|exceeded| exceeded.to_string()),
            Some(format!("200 rpm, above your limit of {lowered_to} rpm"))
        );
        assert_stopped_for_good(&mut fixture);
    }
}

/// A motor that gets hot behind an old temperature.
#[test]
fn a_motor_whose_temperature_has_not_been_known_for_two_seconds_is_stopped() {
    let mut fixture = Fixture::one_motor();
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    fixture.loses_queries = true;
    let since = fixture.now;
    let is_withdrawn = |event: &Event| {
        let reason = WithdrawReason::TemperatureUnknown;
        *event == Event::Withdrawn { id: ID, reason }
    };
    let took = fixture.run_until(ms(3_000), |fixture| fixture.happened(is_withdrawn));
    assert!(
        took >= ms(1_800) && took <= ms(2_100),
        "{took:?} after {since:?}"
    );
    fixture.run(ms(1_000));
    assert!(fixture.true_rpm().abs() < 1.0);
}

#[test]
fn a_motor_that_raw_frames_drive_is_stopped_too_when_its_temperature_is_not_known() {
    let mut fixture = Fixture::one_motor();
    fixture
        .command(raw(drive_frame(ID, rpm(100)), every(0, 20)))
        .unwrap();
    fixture.run(ms(1_000));
    fixture.loses_queries = true;
    fixture.run(ms(2_200));
    let reason = WithdrawReason::TemperatureUnknown;
    assert!(fixture.happened(|event| *event == Event::Withdrawn { id: ID, reason }));
    fixture.run(ms(1_000));
    assert!(fixture.true_rpm().abs() < 1.0);
}

#[test]
fn a_raw_mode_switch_that_is_repeated_needs_no_temperature() {
    for model in Model::ALL {
        let mut fixture = driven_models::on(model);
        let switch = family::Request::SwitchMode {
            id: ID,
            mode: Mode::Velocity,
        };
        let frame = switch.frame(model).unwrap();
        fixture.command(raw(frame, every(0, 500))).unwrap();
        fixture.run(ms(4_000));
        assert!(
            !fixture.happened(|event| matches!(event, Event::Withdrawn { .. })),
            "{model}"
        );
    }
}
