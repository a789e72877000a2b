//! What an earlier connection left driven is stopped before anything else.

use motorlink_bus::{
    Activity, Bus, Command, Consent, Event, LeftDriven, Refusal, Repeat, StopOutcome, StopReason,
    StopReport,
};
use motorlink_protocol::{
    Frame, Mode, MotorId,
    family::{Model, Request},
};
use motorlink_simulator::WorldConfig;

use crate::fixture::driven_models::{setpoint, switched};
use crate::fixture::{Fixture, ID, every, id, ms, raw, rpm};

/// The port is lost while the motors are driven, and comes back: a new bus on the same line.
fn reconnected(fixture: &mut Fixture) -> Vec<LeftDriven> {
    let left: Vec<LeftDriven> = fixture.bus.left_driven().collect();
    replace_bus(fixture, &left);
    left
}

fn replace_bus(fixture: &mut Fixture, left: &[LeftDriven]) {
    let model = fixture.bus.model();
    fixture.bus = Bus::with_model(fixture.now, model);
    fixture.bus.stop_first(fixture.now, left.iter().copied());
    fixture.forget_the_past();
}

fn driven_in(model: Model, mode: Mode) -> Fixture {
    let mut fixture = switched(model, mode);
    fixture.drive(setpoint(mode)).unwrap();
    // A free wheel in the current loop soon reaches its speed limit.
    let brief = matches!(mode, Mode::Position | Mode::Current);
    fixture.run(ms(if brief { 150 } else { 500 }));
    fixture
}

fn report(fixture: &Fixture) -> Option<&StopReport> {
    fixture.events.iter().find_map(|(_, event)| match event {
        Event::StopEnded(report) => Some(report),
        _ => None,
    })
}

fn run_until_stopped(fixture: &mut Fixture) -> StopReport {
    fixture.run_until(ms(3_500), |fixture| report(fixture).is_some());
    report(fixture).unwrap().clone()
}

fn request(model: Model, frame: &Frame) -> Request {
    Request::parse(model, frame).unwrap()
}

fn outcome(report: &StopReport) -> Vec<(MotorId, bool)> {
    let outcomes = report.motors.iter();
    outcomes.map(|it| (it.id, it.confirmed)).collect()
}

#[test]
fn a_motor_left_driven_in_any_loop_is_stopped_and_confirmed() {
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
            for known in [true, false] {
                let mut fixture = driven_in(model, mode);
                let mut left: Vec<LeftDriven> = fixture.bus.left_driven().collect();
                assert_eq!(
                    left,
                    [LeftDriven {
                        id: ID,
                        mode: Some(mode)
                    }],
                    "{model}"
                );
                if !known {
                    left = vec![LeftDriven { id: ID, mode: None }];
                }
                replace_bus(&mut fixture, &left);
                let began = fixture.now;
                let report = run_until_stopped(&mut fixture);
                let took = fixture.now.since(began);
                assert!(took <= ms(1_500), "{model} {mode} {known}: {took:?}");
                assert_eq!(report.reason, StopReason::LeftDriven);
                assert_eq!(outcome(&report), [(ID, true)], "{model} {mode}");
                assert!(fixture.true_rpm().abs() < 2.0, "{model} {mode}");
                assert_eq!(fixture.bus.left_driven().count(), 0, "{model} {mode}");
                assert!(!fixture.bus.is_halted());
            }
        }
    }
}

#[test]
fn no_drive_frame_goes_into_a_loop_that_may_be_the_position_loop() {
    for (model, mode) in [
        (Model::Ddsm115, Some(Mode::Position)),
        (Model::Ddsm115, None),
        (Model::Ddsm210, None),
        (Model::Ddsm400, None),
    ] {
        let mut fixture = driven_in(model, Mode::Position);
        replace_bus(&mut fixture, &[LeftDriven { id: ID, mode }]);
        let before = fixture.world.motor(ID).unwrap().angle_deg();
        run_until_stopped(&mut fixture);
        let frames = fixture.sent.iter().map(|sent| request(model, &sent.frame));
        let first_drive = frames
            .clone()
            .position(|it| matches!(it, Request::Drive { .. }));
        let first_switch = frames
            .clone()
            .position(|it| matches!(it, Request::SwitchMode { .. }));
        assert!(first_switch < first_drive, "{model} {mode:?}");
        let turned = fixture.world.motor(ID).unwrap().angle_deg() - before;
        assert!(turned.abs() < 60.0, "{model} {mode:?}: {turned} degrees");
    }
}

#[test]
fn the_id_query_and_queries_of_others_wait_until_the_stop_has_ended() {
    let ids = [ID, id(2), id(3)];
    let mut fixture = Fixture::watching(WorldConfig::with_ids(ids), &ids);
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(1_000));
    reconnected(&mut fixture);
    for motor in ids {
        fixture.command(Command::Watch(motor)).unwrap();
    }
    fixture.command(Command::IdQuery).unwrap();
    run_until_stopped(&mut fixture);
    let is_end = |event: &&(_, Event)| matches!(event.1, Event::StopEnded(_));
    let (ended, _) = *fixture.events.iter().find(is_end).unwrap();
    for sent in fixture.sent.iter().filter(|sent| sent.at < ended) {
        let own = sent.frame.bytes().starts_with(&[ID.get()]);
        assert!(own, "{} before the stop has ended", sent.frame);
    }
    fixture.run(ms(300));
    assert!(fixture.happened(|event| matches!(event, Event::IdQueryEnded(_))));
    assert!(
        fixture
            .sent
            .iter()
            .any(|sent| sent.is_query() && sent.frame.bytes().starts_with(&[3]))
    );
}

#[test]
fn nothing_drives_until_the_stop_has_ended() {
    let mut fixture = driven_in(Model::Ddsm115, Mode::Velocity);
    fixture.run(ms(300));
    reconnected(&mut fixture);
    let position = Command::SwitchMode {
        id: id(2),
        mode: Mode::Current,
    };
    let hazard = raw(
        "01 64 00 32 00 00 00 00 00 D3".parse().unwrap(),
        Repeat::Once,
    );
    assert_eq!(fixture.drive(rpm(50)), Err(Refusal::StopsFirst));
    for command in [position, hazard, Command::FullScan] {
        assert_eq!(fixture.command(command), Err(Refusal::StopsFirst));
    }
    // A frame that moves nothing waits.
    let query = raw(
        "01 74 00 00 00 00 00 00 00 04".parse().unwrap(),
        every(1, 20),
    );
    fixture.command(query).unwrap();
    assert_eq!(fixture.bus.raw().unwrap().sent, 0);
    run_until_stopped(&mut fixture);
    fixture.run(ms(300));
    fixture.drive(rpm(50)).unwrap();
}

#[test]
fn a_motor_that_never_answers_stays_unconfirmed_and_the_rest_goes_on() {
    let mut fixture = Fixture::new(WorldConfig::default());
    let left = LeftDriven {
        id: id(9),
        mode: Some(Mode::Current),
    };
    fixture.bus.stop_first(fixture.now, [left]);
    fixture.command(Command::Watch(ID)).unwrap();
    let report = run_until_stopped(&mut fixture);
    assert_eq!(
        report.motors,
        [StopOutcome {
            id: id(9),
            confirmed: false,
            speed: None
        }]
    );
    assert_eq!(fixture.bus.left_driven().collect::<Vec<_>>(), [left]);
    assert!(fixture.status(id(9)).may_turn);
    fixture.run(ms(300));
    assert!(fixture.status(ID).last.is_some());
    fixture.drive(rpm(50)).unwrap();
}

#[test]
fn a_halted_bus_stays_halted_and_a_stop_of_the_operator_joins() {
    let mut fixture = driven_in(Model::Ddsm115, Mode::Velocity);
    let left: Vec<LeftDriven> = fixture.bus.left_driven().collect();
    fixture.bus = Bus::halted(fixture.now);
    fixture.bus.stop_first(fixture.now, left);
    fixture.forget_the_past();
    run_until_stopped(&mut fixture);
    assert!(fixture.bus.is_halted());

    let mut fixture = driven_in(Model::Ddsm115, Mode::Velocity);
    reconnected(&mut fixture);
    fixture.run(ms(20));
    fixture
        .command(Command::StopAll(StopReason::Operator))
        .unwrap();
    let report = run_until_stopped(&mut fixture);
    assert_eq!(report.reason, StopReason::Operator);
    assert_eq!(outcome(&report), [(ID, true)]);
    assert!(fixture.bus.is_halted());
    assert!(fixture.happened(|event| *event == Event::StopBegan(StopReason::LeftDriven)));
}

#[test]
fn a_port_on_trial_is_stopped_first_as_well() {
    let mut fixture = driven_in(Model::Ddsm400, Mode::Velocity);
    let left: Vec<LeftDriven> = fixture.bus.left_driven().collect();
    fixture.bus = Bus::with_model(fixture.now, Model::Ddsm400).on_trial();
    fixture.bus.stop_first(fixture.now, left);
    fixture.forget_the_past();
    assert_eq!(outcome(&run_until_stopped(&mut fixture)), [(ID, true)]);
}

/// Fault simulation, seed 62073: another computer has left it running, and it is too hot to obey the brake.
#[test]
fn a_motor_that_answers_only_during_its_stop_is_remembered_until_it_stands() {
    let mut fixture = driven_in(Model::Ddsm115, Mode::Velocity);
    replace_bus(&mut fixture, &[]);
    fixture.world.motor_mut(ID).unwrap().set_temperature_c(90.0);
    fixture.command(Command::Watch(ID)).unwrap();
    fixture.command(Command::Stop(ID)).unwrap();
    fixture.run(ms(50));
    let left = reconnected(&mut fixture);
    assert_eq!(left.len(), 1);
    assert_eq!(
        run_until_stopped(&mut fixture).reason,
        StopReason::LeftDriven
    );
}

#[test]
fn without_a_motor_that_was_left_driven_nothing_waits() {
    let mut fixture = Fixture::one_motor();
    reconnected(&mut fixture);
    assert!(!fixture.bus.is_stopping());
    fixture.command(Command::Watch(ID)).unwrap();
    fixture.run(ms(300));
    fixture.drive(rpm(50)).unwrap();
}

/// What is remembered must be written before the frame that starts the motion.
#[test]
fn a_motor_is_listed_before_its_first_drive_frame_and_until_its_standstill_is_confirmed() {
    let mut fixture = Fixture::one_motor();
    let listed = |fixture: &Fixture| fixture.bus.left_driven().next();
    assert_eq!(listed(&fixture), None);
    assert!(!fixture.status(ID).may_turn);
    let consent = Consent::None;
    let drive = Command::Drive {
        id: ID,
        setpoint: rpm(60),
        consent,
    };
    fixture.bus.command(fixture.now, drive).unwrap();
    let mode = Some(Mode::Velocity);
    assert_eq!(listed(&fixture), Some(LeftDriven { id: ID, mode }));
    fixture.run(ms(500));
    assert!(fixture.status(ID).may_turn);
    fixture.command(Command::Stop(ID)).unwrap();
    fixture.run(ms(5));
    assert_eq!(listed(&fixture), Some(LeftDriven { id: ID, mode }));
    run_until_stopped(&mut fixture);
    assert_eq!(listed(&fixture), None);
    assert!(!fixture.status(ID).may_turn);

    // A raw frame, from before it goes out.
    let spin = raw(
        "01 64 00 64 00 00 00 00 00 4F".parse().unwrap(),
        Repeat::Once,
    );
    fixture.bus.command(fixture.now, spin).unwrap();
    assert_eq!(listed(&fixture), Some(LeftDriven { id: ID, mode }));
    fixture.run(ms(500));
    assert_eq!(listed(&fixture), Some(LeftDriven { id: ID, mode }));
    assert_eq!(fixture.activity(), Activity::Idle);
    fixture.forget_the_past();
    fixture.command(Command::StopRaw).unwrap();
    run_until_stopped(&mut fixture);
    fixture.run(ms(10));
    assert_eq!(listed(&fixture), None);
}

/// No stop has proved that its wheel stands.
#[test]
fn a_motor_that_is_switched_while_it_is_driven_needs_a_stop_before_the_port_is_closed() {
    let mut fixture = Fixture::one_motor();
    assert!(!fixture.bus.needs_stop(fixture.now));
    fixture.drive(rpm(-5)).unwrap();
    fixture.switch(Mode::Position);
    fixture.run(ms(1_000));
    assert!(!fixture.bus.is_active(fixture.now));
    assert!(fixture.bus.needs_stop(fixture.now));
    fixture.command(Command::Stop(ID)).unwrap();
    run_until_stopped(&mut fixture);
    fixture.run(ms(10));
    assert!(!fixture.bus.needs_stop(fixture.now));
}

#[test]
fn a_stop_of_a_motor_that_does_not_exist_leaves_nothing_to_remember() {
    let mut fixture = Fixture::one_motor();
    fixture.command(Command::Stop(id(9))).unwrap();
    fixture.run(ms(3_500));
    assert_eq!(fixture.bus.left_driven().count(), 0);
}
