//! Adapters that echo at random nothing, all, the first or the last bytes of each frame.

use motorlink_bus::{Activity, Command, Event};
use motorlink_protocol::{Mode, family::Model};
use motorlink_simulator::{Echo, WireFaults, WorldConfig};

use crate::fixture::{Fixture, ID, hostile_line, ms, rpm};

/// A motor at this angle. The echo comes alone, later than the earliest reply, or in one chunk with the reply.
fn echoing(model: Model, echo: Echo, seed: u64, angle_deg: f32) -> Fixture {
    let mut config = WorldConfig {
        seed,
        ..WorldConfig::of(model, [ID])
    };
    config.faults = WireFaults {
        echo,
        hold: ms(seed % 3),
        ..WireFaults::default()
    };
    for motor in &mut config.motors {
        motor.angle_deg = angle_deg;
    }
    let mut fixture = Fixture::new(config);
    fixture.command(Command::Watch(ID)).unwrap();
    fixture
}

/// The echo of its mode query says that a DDSM210 is in the open loop.
#[test]
fn a_driven_motor_is_never_read_in_another_loop_by_an_echo() {
    for model in [Model::Ddsm210, Model::Ddsm400] {
        for seed in 0..100 {
            let mut fixture = echoing(model, Echo::Parts, seed, 30.0);
            fixture.run(ms(1_000));
            fixture.drive(rpm(60)).unwrap();
            fixture.run(ms(2_000));
            let is_wrong = |event: &Event| match event {
                Event::Telemetry(sample) => sample.reply.mode != Mode::Velocity,
                Event::Withdrawn { .. } | Event::OtherModel { .. } => true,
                _ => false,
            };
            assert!(!fixture.happened(is_wrong), "{model} seed {seed}");
            let is_driven = matches!(fixture.activity(), Activity::Driven { .. });
            assert!(is_driven, "{model} seed {seed}");
        }
    }
}

/// At angle zero the odometry reply of a DDSM210 is identical to its request, and in the open loop that to the mode
/// query.
#[test]
fn a_motor_whose_reply_is_its_request_is_read_whatever_the_adapter_echoes() {
    let cut = [1, 2, 5, 9].map(Echo::Cut);
    let echoes = [Echo::Off, Echo::Whole, Echo::Parts].into_iter().chain(cut);
    for echo in echoes {
        for seed in 0..6 {
            let mut fixture = echoing(Model::Ddsm210, echo, seed, 0.0);
            fixture.run(ms(1_500));
            let status = fixture.status(ID);
            assert!(!status.is_silent(), "{echo:?} seed {seed}");
            assert!(status.position.is_some(), "{echo:?} seed {seed}");
            // The odometry of a wheel that has moved differs from its request.
            fixture.drive(rpm(30)).unwrap();
            fixture.run(ms(700));
            fixture.command(Command::Stop(ID)).unwrap();
            fixture.run(ms(700));
            let mode = Mode::OpenLoop;
            fixture
                .command(Command::SwitchMode { id: ID, mode })
                .unwrap();
            fixture.run(ms(600));
            let named = fixture.happened(|event| matches!(event, Event::ModeSwitched { .. }));
            assert!(named, "{echo:?} seed {seed}: {:?}", fixture.activity());
        }
    }
}

/// Its odometry reply is identical to its request, and the adapter has echoed.
#[test]
fn a_motor_at_angle_zero_is_stopped_as_fast_once_the_adapter_has_ceased_to_echo() {
    let cut = [1, 2, 5, 9].map(Echo::Cut);
    for echo in [Echo::Whole, Echo::Parts].into_iter().chain(cut) {
        for seed in 0..6 {
            let mut fixture = echoing(Model::Ddsm210, echo, seed, 0.0);
            fixture.run(ms(1_500));
            fixture.world.set_faults(WireFaults::default());
            fixture.run(ms(50));
            fixture.forget_the_past();
            fixture.command(Command::Stop(ID)).unwrap();
            fixture.run(ms(1_500));
            let confirmed = fixture.happened(|event| match event {
                Event::StopEnded(report) => report.motors.iter().all(|motor| motor.confirmed),
                _ => false,
            });
            assert!(confirmed, "{echo:?} seed {seed}");
        }
    }
}

/// Nothing but the echo comes back, whole, and later than the earliest reply.
#[test]
fn an_echo_of_a_motor_without_power_is_never_read() {
    for model in Model::ALL {
        for seed in 0..20 {
            let mut fixture = echoing(model, Echo::Whole, seed, 30.0);
            fixture.world.motor_mut(ID).unwrap().power(false);
            fixture.run(ms(10_000));
            let read = fixture.happened(|event| matches!(event, Event::Telemetry(_)));
            assert!(!read, "{model} seed {seed}");
            assert!(fixture.status(ID).is_silent(), "{model} seed {seed}");
            let sent = fixture.sent.len();
            assert!(sent < 150, "{model} seed {seed}: {sent} frames in 10 s");
        }
    }
}

/// A byte of noise and nine bytes of an echo have a good CRC by chance, as a frame of an address that no motor has.
#[test]
fn noise_before_and_behind_echoes_is_no_motor_of_another_model() {
    for model in Model::ALL {
        let mut chance = 1_u32;
        let mut below = |bound: u32| {
            chance = chance.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (chance >> 8) % bound
        };
        let mut fixture = echoing(model, Echo::Off, 1, 30.0);
        fixture.run(ms(1_500));
        fixture.drive(rpm(60)).unwrap();
        for _ in 0..3_000 {
            let sent = fixture.sent.len();
            fixture.run_until(ms(2_000), |fixture| fixture.sent.len() > sent);
            let frame = *fixture.sent.last().unwrap().frame.bytes();
            let mut noise = |count| -> Vec<u8> {
                let count = below(count);
                (0..count)
                    .map(|_| u8::try_from(below(256)).unwrap())
                    .collect()
            };
            let bytes = [noise(3), frame.to_vec(), noise(3)].concat();
            fixture.bus.receive(fixture.now, &bytes);
        }
        let is_wrong = |event: &Event| matches!(event, Event::OtherModel { .. });
        assert!(!fixture.happened(is_wrong), "{model}");
        let read =
            |event: &Event| matches!(event, Event::Telemetry(sample) if sample.reply.id != ID);
        assert!(!fixture.happened(read), "{model}");
    }
}

/// The figures of a million exchanges: `cargo run --release -p motorlink-bus --example hostile_lines -- 1000000`.
#[test]
fn no_value_is_read_that_no_motor_has_said() {
    for (name, faults) in hostile_line::lines() {
        for model in Model::ALL {
            let found = hostile_line::run(model, &faults, 7, 3_000);
            assert_eq!((found.wrong, found.other_model), (0, 0), "{name}, {model}");
        }
    }
}
