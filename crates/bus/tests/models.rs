//! Every model on its own line: driven in each loop, stopped from each, scanned, given another ID.
#![cfg(test)]

mod fixture;

use std::time::Duration;

use motorlink_bus::{
    Activity, BusSettings, Command, Consent, Event, IdChangeOutcome, LimitOutOfRange, Limits,
    LineEventKind, Refusal, SetIdFrames, WithdrawReason,
};
use motorlink_protocol::{
    CurrentTarget, Detail, Instant, Layout, Mode, MotorId, OpenLoopTarget, PositionTarget, Reply,
    Setpoint, SpeedTarget, family::Model,
};
use motorlink_simulator::{WireFaults, WorldConfig};

use fixture::{Fixture, ID, id, ms, rpm, scan_report, to};

fn on(model: Model) -> Fixture {
    let mut fixture = Fixture::watching(WorldConfig::of(model, [ID]), &[ID]);
    // A DDSM400 is enabled meanwhile.
    fixture.run(ms(700));
    fixture.forget_the_past();
    fixture
}

/// A setpoint that turns a free wheel of this model.
fn setpoint(mode: Mode) -> Setpoint {
    match mode {
        Mode::OpenLoop => Setpoint::OpenLoop(OpenLoopTarget::new(12_000).unwrap()),
        Mode::Current => Setpoint::Current(CurrentTarget::from_amps(0.4)),
        Mode::Velocity => rpm(60),
        Mode::Position => Setpoint::Position(PositionTarget::from_degrees(90.0)),
    }
}

fn switched(model: Model, mode: Mode) -> Fixture {
    let mut fixture = on(model);
    if mode != Mode::Velocity {
        fixture
            .command(Command::SwitchMode { id: ID, mode })
            .unwrap();
        fixture.run(ms(600));
        assert!(
            fixture.happened(|event| *event == Event::ModeSwitched { id: ID, mode }),
            "{model} {mode}: {:?}",
            fixture.events
        );
    }
    fixture
}

fn stopped(fixture: &mut Fixture) -> Duration {
    fixture.command(Command::Stop(ID)).unwrap();
    fixture.run_until(ms(3_500), |fixture| {
        fixture.happened(|event| {
            matches!(event, Event::StopEnded(report) if report.motors.iter().all(|motor| motor.confirmed))
        })
    })
}

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
fn each_model_stands_soon_after_a_stop_from_its_nominal_speed() {
    for model in Model::ALL {
        let mut fixture = on(model);
        let nominal = model.spec().nominal;
        let rated = nominal.rated_rpm.unwrap_or(100);
        fixture.drive(rpm(rated.into())).unwrap();
        fixture.run(ms(3_000));
        let took = stopped(&mut fixture);
        assert!(took <= ms(400), "{model} from {rated} rpm: {took:?}");
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
        assert!((48..=52).contains(&reply.speed.rpm()), "{model} {reply:?}");
        assert_eq!(reply.mode, Mode::Velocity);
        let (at, temperature) = status.temperature.unwrap();
        assert!(fixture.now.since(at) < ms(500), "{model}");
        assert!((20..=60).contains(&temperature.degrees()), "{model}");
        let (at, _) = status.position.unwrap();
        assert!(fixture.now.since(at) < ms(500), "{model}");
    }
}

/// The speed of a wheel that is not driven follows from its angle.
#[test]
fn a_coasting_wheel_is_not_taken_to_stand() {
    for model in [Model::Ddsm210, Model::Ddsm400] {
        let mut fixture = on(model);
        fixture.world.motor_mut(ID).unwrap().set_push_nm(0.3);
        fixture.run(ms(1_500));
        let reply = fixture.status(ID).last.unwrap().reply;
        assert!(matches!(reply.detail, Detail::Odometry { .. }));
        assert!(reply.speed.magnitude() > 20, "{model} {reply:?}");
        let mode = Mode::Position;
        let refused = fixture.command(Command::SwitchMode { id: ID, mode });
        assert!(matches!(refused, Err(Refusal::TooFast(_))), "{model}");
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

/// A power cut shorter than the bus needs to call a motor silent. A motor back in the velocity loop would read the
/// angle of 180 degrees as 1,638 rpm.
#[test]
fn a_short_power_cut_in_the_position_loop_turns_no_wheel_fast() {
    for cut in [15, 25, 40, 60, 90] {
        let mut fixture = switched(Model::Ddsm210, Mode::Position);
        let half = Setpoint::Position(PositionTarget::from_degrees(180.0));
        fixture.drive(half).unwrap();
        fixture.run(ms(2_000));
        fixture.world.motor_mut(ID).unwrap().power(false);
        fixture.run(ms(cut));
        fixture.world.motor_mut(ID).unwrap().power(true);
        let mut fastest = 0.0_f32;
        for _ in 0..300 {
            fixture.run(ms(5));
            fastest = fastest.max(fixture.true_rpm().abs());
        }
        assert!(fastest < 20.0, "{cut} ms without power: {fastest} rpm");
        assert_eq!(fixture.activity(), Activity::Idle, "{cut} ms");
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

/// A brake frame that is lost is sent again at once, not 300 ms later.
#[test]
fn a_ddsm315_is_stopped_on_a_line_that_loses_requests() {
    for seed in 0..20 {
        let mut fixture = on(Model::Ddsm315);
        fixture.drive(rpm(100)).unwrap();
        fixture.run(ms(2_000));
        fixture.world.set_faults(WireFaults {
            lose_request: 0.4,
            ..WireFaults::default()
        });
        fixture.run(ms(seed * 7));
        let took = stopped(&mut fixture);
        assert!(took <= ms(600), "seed {seed}: {took:?}");
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
    let said = said.filter(|(_, event)| *event == Event::AnswersInJson);
    assert_eq!(said.count(), 1);
}

/// The recording has one set of units: it gets each frame of a model with separate frames a second time, as a DDSM115
/// would send it.
#[test]
fn commands_and_readings_are_given_to_the_recording_in_the_units_of_the_bus() {
    for model in [Model::Ddsm210, Model::Ddsm400] {
        let mut fixture = on(model);
        fixture.drive(rpm(60)).unwrap();
        fixture.run(ms(2_000));
        let lines = fixture.events.iter().filter_map(|(_, event)| match event {
            Event::Line(line) => Some(line.kind),
            _ => None,
        });
        let mut commanded = lines.clone().filter_map(|kind| match kind {
            LineEventKind::Commanded { frame, mode } => Some((frame, mode)),
            _ => None,
        });
        let (frame, mode) = commanded.next_back().unwrap();
        assert_eq!(mode, Some(Mode::Velocity));
        assert_eq!(frame, fixture::drive_frame(ID, rpm(60)), "{model}");
        let mut layouts = Vec::new();
        let mut last = None;
        for kind in lines {
            if let LineEventKind::Reading { frame, asked } = kind {
                layouts.extend(asked);
                last = Reply::decode(&frame, asked).ok();
            }
        }
        let reply = last.unwrap();
        assert!((58..=62).contains(&reply.speed.rpm()), "{model} {reply:?}");
        assert!(layouts.contains(&Layout::Drive) && layouts.contains(&Layout::Query));
    }
}

/// Of the brake frames of a DDSM315, one goes out every 300 ms. The first comes before the switch and only coasts.
#[test]
fn a_ddsm315_is_braked_as_soon_as_it_reports_the_velocity_loop() {
    let mut fixture = switched(Model::Ddsm315, Mode::Current);
    fixture.drive(setpoint(Mode::Current)).unwrap();
    fixture.run(ms(1_500));
    fixture.forget_the_past();
    let began = fixture.now;
    fixture.command(Command::Stop(ID)).unwrap();
    let mut in_velocity_loop = None;
    for _ in 0..100 {
        fixture.run(ms(5));
        if in_velocity_loop.is_none() && fixture.world.motor(ID).unwrap().mode() == Mode::Velocity {
            in_velocity_loop = Some(fixture.now);
        }
    }
    let in_velocity_loop = in_velocity_loop.unwrap();
    let brakes = fixture
        .sent
        .iter()
        .filter(|sent| sent.drive_of(ID).is_some());
    let after = |at: &Instant| *at >= in_velocity_loop - ms(5);
    let first = brakes.map(|sent| sent.at).find(after).unwrap();
    let waited = first.since(in_velocity_loop);
    assert!(
        waited <= ms(25),
        "{waited:?} of {:?}",
        in_velocity_loop.since(began)
    );
}
