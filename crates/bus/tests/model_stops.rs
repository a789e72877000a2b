//! Every model comes to a stop, also on a bad line and after a power cut.

use motorlink_bus::{Activity, BusSettings, Command, Consent, Event, Refusal, StopReason};
use motorlink_protocol::{Detail, Instant, Mode, PositionTarget, Setpoint, family::Model};
use motorlink_simulator::{WireFaults, WorldConfig};

use crate::fixture::driven_models::{on, setpoint, stopped, switched};
use crate::fixture::{Fixture, ID, id, longest_gap, ms, rpm};

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

/// The speed of a wheel that is not driven follows from its angle.
#[test]
fn a_coasting_wheel_is_not_taken_to_stand() {
    for model in [Model::Ddsm210, Model::Ddsm400] {
        let mut fixture = on(model);
        fixture.world.motor_mut(ID).unwrap().set_push_nm(0.3);
        fixture.run(ms(1_500));
        let reply = fixture.status(ID).last.unwrap().reply;
        assert!(matches!(reply.detail, Detail::Odometry { .. }));
        assert!(reply.speed.unwrap().magnitude() > 20, "{model} {reply:?}");
        let mode = Mode::Position;
        let refused = fixture.command(Command::SwitchMode { id: ID, mode });
        assert!(matches!(refused, Err(Refusal::TooFast(_))), "{model}");
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

fn slow_brake_frames(fixture: &mut Fixture) {
    fixture
        .command(Command::Configure(BusSettings {
            slow_brake_frames: true,
            ..BusSettings::default()
        }))
        .unwrap();
}

fn brakes(fixture: &Fixture) -> Vec<Instant> {
    let brakes = fixture
        .sent
        .iter()
        .filter(|sent| sent.drive_of(ID) == Some(Setpoint::Brake.into()));
    brakes.map(|sent| sent.at).collect()
}

#[test]
fn a_ddsm315_is_braked_like_a_ddsm115() {
    for model in [Model::Ddsm115, Model::Ddsm315] {
        let mut fixture = on(model);
        fixture.drive(rpm(100)).unwrap();
        fixture.run(ms(2_000));
        fixture.forget_the_past();
        stopped(&mut fixture);
        let gap = longest_gap(&brakes(&fixture));
        assert!(gap <= ms(10), "{model}: {gap:?}");
    }
}

#[test]
fn slow_brake_frames_are_300_ms_apart_and_confirm_the_stop() {
    let mut fixture = on(Model::Ddsm315);
    slow_brake_frames(&mut fixture);
    fixture.drive(rpm(100)).unwrap();
    fixture.run(ms(2_000));
    fixture.forget_the_past();
    let took = stopped(&mut fixture);
    assert!(took <= ms(1_500), "{took:?}");
    let brakes = brakes(&fixture);
    let gaps = brakes.windows(2).map(|pair| pair[1].since(pair[0]));
    assert!(
        brakes.len() >= 3 && gaps.clone().all(|gap| gap >= ms(300)),
        "{brakes:?}"
    );
}

/// A brake frame that is lost is sent again at once, not 300 ms later.
#[test]
fn slow_brake_frames_that_are_lost_are_sent_again_at_once() {
    for seed in 0..20 {
        let mut fixture = on(Model::Ddsm315);
        slow_brake_frames(&mut fixture);
        fixture.drive(rpm(100)).unwrap();
        fixture.run(ms(2_000));
        fixture.world.set_faults(WireFaults {
            lose_request: 0.4,
            ..WireFaults::default()
        });
        fixture.run(ms(seed * 7));
        fixture.forget_the_past();
        fixture.command(Command::Stop(ID)).unwrap();
        fixture.run(ms(600));
        assert!(
            fixture.true_rpm().abs() < 10.0,
            "seed {seed}: {}",
            fixture.true_rpm()
        );
    }
}

/// The other motor, whose last frame is older, was answered and gets no frame for 300 ms.
#[test]
fn a_lost_slow_brake_frame_does_not_wait_for_the_one_of_another_motor() {
    for seed in 0..20 {
        let ids = [id(1), id(2)];
        let mut fixture = Fixture::watching(WorldConfig::of(Model::Ddsm315, ids), &ids);
        slow_brake_frames(&mut fixture);
        for id in ids {
            let (setpoint, consent) = (rpm(100), Consent::None);
            fixture
                .command(Command::Drive {
                    id,
                    setpoint,
                    consent,
                })
                .unwrap();
        }
        fixture.run(ms(2_000));
        fixture.world.set_faults(WireFaults {
            lose_request: 0.4,
            ..WireFaults::default()
        });
        fixture.run(ms(seed * 7));
        fixture
            .command(Command::StopAll(StopReason::Operator))
            .unwrap();
        fixture.run(ms(600));
        for id in ids {
            let rpm = fixture.world.motor(id).unwrap().speed_rpm();
            assert!(rpm.abs() < 10.0, "seed {seed}, {id}: {rpm}");
        }
    }
}

/// Of slow brake frames, one goes out every 300 ms. The first comes before the switch and only coasts.
#[test]
fn a_motor_with_slow_brake_frames_is_braked_as_soon_as_it_reports_the_velocity_loop() {
    let mut fixture = switched(Model::Ddsm315, Mode::Current);
    slow_brake_frames(&mut fixture);
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

/// Its replies to a brake do not name the loop. A switch of the stop before was not confirmed, so none of them counted.
#[test]
fn a_stop_after_one_on_a_stalling_line_is_confirmed() {
    for model in [Model::Ddsm210, Model::Ddsm400] {
        let mut fixture = on(model);
        fixture.run(ms(2_000));
        fixture.world.set_faults(WireFaults {
            hold: ms(120),
            ..WireFaults::default()
        });
        fixture.run(ms(450));
        fixture.command(Command::Stop(ID)).unwrap();
        fixture.run(ms(600));
        fixture.world.set_faults(WireFaults::default());
        fixture.run(ms(1_000));
        fixture.forget_the_past();
        let took = stopped(&mut fixture);
        assert!(took <= ms(1_500), "{model}: {took:?}");
    }
}

/// The loop is unknown after a silence. The angle was asked for in turns with the brake, and the loop never.
#[test]
fn a_stop_of_a_motor_that_is_silent_for_a_moment_is_confirmed() {
    for model in [Model::Ddsm210, Model::Ddsm400] {
        for answered_ms in 4..40 {
            let mut fixture = on(model);
            fixture.run(ms(2_000));
            fixture.forget_the_past();
            fixture.command(Command::Stop(ID)).unwrap();
            fixture.run(ms(answered_ms));
            fixture.world.set_faults(WireFaults {
                lose_reply: 1.0,
                ..WireFaults::default()
            });
            fixture.run(ms(400));
            fixture.world.set_faults(WireFaults::default());
            fixture.run(ms(1_000));
            let confirmed = fixture.happened(|event| match event {
                Event::StopEnded(report) => report.motors.iter().all(|motor| motor.confirmed),
                _ => false,
            });
            assert!(confirmed, "{model}, silent after {answered_ms} ms");
        }
    }
}
