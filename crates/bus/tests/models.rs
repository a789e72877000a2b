//! Every model on its own line: driven in each loop, scanned, limited, given another ID.

use motorlink_bus::{
    Activity, BusSettings, Command, Consent, Event, IdChangeOutcome, LimitOutOfRange, Limits,
    LineSamples, Refusal, SetIdFrames, WithdrawReason,
};
use motorlink_protocol::{Mode, MotorId, Setpoint, SpeedTarget, family::Model};
use motorlink_simulator::WorldConfig;

use crate::fixture::driven_models::{on, setpoint, stopped, switched};
use crate::fixture::{Fixture, ID, id, ms, rpm, scan_report, to};

#[test]
fn each_model_is_driven_in_each_of_its_loops_and_stopped_from_it() {
    for model in Model::ALL {
        for mode in model.modes().iter().copied() {
            let mut fixture = switched(model, mode);
            let turns = |fixture: &Fixture| fixture.world.motor(ID).unwrap().turns();
            let before = turns(&fixture);
            fixture.drive(setpoint(mode)).unwrap();
            // Without a speed loop a free wheel soon reaches the speed limit.
            let free = matches!(mode, Mode::OpenLoop | Mode::Current);
            fixture.run(ms(if free { 150 } else { 1_000 }));
            let (speed, turned) = (fixture.true_rpm(), turns(&fixture) - before);
            let moved = match mode {
                // 90 degrees to within two. At positive speed the angle of a DDSM115 falls.
                Mode::Position => (turned.abs() - 0.25).abs() < 0.006,
                Mode::Velocity => (speed - 60.0).abs() < 3.0 && turned > 0.5,
                Mode::OpenLoop | Mode::Current => speed > 10.0 && turned > 0.005,
            };
            assert!(
                moved,
                "{model} in the {mode}: {turned} turns, {speed} rpm at the end"
            );
            assert!(
                matches!(fixture.activity(), Activity::Driven { .. }),
                "{model} {mode}: {:?}",
                fixture.events
            );
            stopped(&mut fixture);
            assert!(fixture.true_rpm().abs() < 1.0, "{model} {mode}");
        }
    }
}

#[test]
fn each_model_reports_speed_current_temperature_and_angle() {
    for model in Model::ALL {
        let mut fixture = on(model);
        fixture.drive(rpm(50)).unwrap();
        fixture.run(ms(1_500));
        let status = fixture.status(ID);
        let reply = status.last.unwrap().reply;
        let (_, speed) = status.speed.unwrap();
        assert!((48..=52).contains(&speed.rpm()), "{model} {speed}");
        assert_eq!(reply.mode, Mode::Velocity);
        let (at, temperature) = status.temperature.unwrap();
        assert!(fixture.now.since(at) < ms(500), "{model}");
        assert!((20..=60).contains(&temperature.degrees()), "{model}");
        let (at, _) = status.position.unwrap();
        assert!(fixture.now.since(at) < ms(500), "{model}");
    }
}

#[test]
fn a_model_refuses_what_it_does_not_have() {
    let mut fixture = on(Model::Ddsm210);
    let (model, mode) = (Model::Ddsm210, Mode::Current);
    let refused = fixture.command(Command::SwitchMode { id: ID, mode });
    assert_eq!(refused, Err(Refusal::NoSuchLoop { model, mode }));
    let refused = fixture.drive(rpm(211));
    assert_eq!(refused, Err(Refusal::AboveSpeedOfModel(model)));
    fixture.drive(rpm(210)).unwrap();
    let mut fixture = on(Model::Ddsm115);
    let refused = fixture.drive(setpoint(Mode::OpenLoop));
    let (model, mode) = (Model::Ddsm115, Mode::OpenLoop);
    assert_eq!(refused, Err(Refusal::NoSuchLoop { model, mode }));
}

#[test]
fn limits_hold_for_each_model() -> Result<(), LimitOutOfRange> {
    for model in Model::ALL {
        let mut fixture = on(model);
        let limits = Limits::new(40, 2_700, 75)?;
        fixture
            .command(Command::Configure(BusSettings {
                limits,
                ..BusSettings::default()
            }))
            .unwrap();
        assert_eq!(fixture.drive(rpm(41)), Err(Refusal::AboveSpeedLimit(40)));
        fixture.drive(rpm(40)).unwrap();
        fixture.run(ms(1_000));
        assert!(
            matches!(fixture.activity(), Activity::Driven { .. }),
            "{model}"
        );
        // Something turns the wheel faster than its limit.
        fixture.world.motor_mut(ID).unwrap().set_push_nm(6.0);
        fixture.run(ms(1_000));
        assert!(
            fixture.happened(|event| matches!(
                event,
                Event::Withdrawn {
                    reason: WithdrawReason::Limit(_),
                    ..
                }
            )),
            "{model}: {:?}",
            fixture.events
        );
    }
    Ok(())
}

#[test]
fn each_model_is_found_by_a_scan_and_takes_an_id() {
    for model in Model::ALL {
        let motors: Vec<MotorId> = [3, 90].map(id).to_vec();
        let mut fixture = Fixture::new(WorldConfig::of(model, motors.iter().copied()));
        let report = scan_report(&mut fixture);
        assert_eq!(report.found, motors, "{model}");
        let mut fixture = Fixture::new(WorldConfig::of(model, [ID]));
        assert_eq!(scan_report(&mut fixture).found, [ID], "{model}");
        fixture
            .command(Command::SetId {
                from: ID,
                to: to(7),
                frames: SetIdFrames::default(),
            })
            .unwrap();
        fixture.run(ms(5_000));
        assert!(
            fixture.happened(|event| matches!(
                event,
                Event::IdChangeEnded {
                    outcome: IdChangeOutcome::Changed,
                    ..
                }
            )),
            "{model}: {:?}",
            fixture.events
        );
    }
}

#[test]
fn a_speed_means_the_same_on_each_model() {
    let target = SpeedTarget::new(-90).unwrap();
    for model in Model::ALL {
        let mut fixture = on(model);
        let command = Command::Drive {
            id: ID,
            setpoint: Setpoint::velocity(target),
            consent: Consent::None,
        };
        fixture.command(command).unwrap();
        fixture.run(ms(2_500));
        assert!((fixture.true_rpm() + 90.0).abs() < 3.0, "{model}");
    }
}

/// A DDSM Driver HAT whose switch is not set to its plain bridge.
#[test]
fn a_driver_board_that_answers_in_json_is_reported_once() {
    let mut fixture = Fixture::new(WorldConfig::with_ids([]));
    fixture.command(Command::Watch(ID)).unwrap();
    for _ in 0..30 {
        fixture.run(ms(100));
        let text = b"{\"T\":1005,\"id\":1,\"typ\":115}\r\n";
        fixture.bus.receive(fixture.now, text);
    }
    let said = fixture.events.iter();
    let said = said.filter(|(_, event)| *event == Event::SendsText { is_json: true });
    assert_eq!(said.count(), 1);
}

#[test]
fn the_samples_of_recorded_events_are_those_of_the_bus() {
    for model in Model::ALL {
        for mode in model.modes().iter().copied() {
            let mut fixture = Fixture::new(WorldConfig::of(model, [ID]));
            fixture.command(Command::Watch(ID)).unwrap();
            fixture.run(ms(1_000));
            if mode != Mode::Velocity {
                let command = Command::SwitchMode { id: ID, mode };
                fixture.command(command).unwrap();
                fixture.run(ms(600));
            }
            fixture.drive(setpoint(mode)).unwrap();
            fixture.run(ms(150));
            fixture.command(Command::Stop(ID)).unwrap();
            fixture.run(ms(2_000));
            let mut reader = LineSamples::default();
            let (mut recorded, mut live) = (Vec::new(), Vec::new());
            for (_, event) in &fixture.events {
                match event {
                    Event::Line(event) => recorded.extend(reader.add_event(event)),
                    Event::Telemetry(sample) => live.push(*sample),
                    _ => {}
                }
            }
            assert_eq!(recorded, live, "{model} {mode}");
            let drives = live.iter().filter(|sample| sample.reply.mode == mode);
            assert!(drives.count() > 5, "{model} {mode}");
        }
    }
}
