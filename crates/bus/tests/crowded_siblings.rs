//! Several DDSM210 or DDSM400 share one line behind a slow adapter.

use std::iter;

use crate::fixture::{Fixture, driven_models::setpoint, id, longest_gap, ms};
use motorlink_bus::{Command, Consent};
use motorlink_protocol::{Instant, Mode, MotorId, family::Model};
use motorlink_simulator::{WireFaults, WorldConfig};

const SIBLINGS: [Model; 2] = [Model::Ddsm210, Model::Ddsm400];
/// Byte 1 of the odometry query and of the mode query.
const KINDS: [u8; 2] = [0x74, 0x75];

/// So many motors, all driven in this loop. The adapter holds bytes for so long.
fn driven(model: Model, count: u8, mode: Mode, hold_ms: u64) -> (Fixture, Vec<MotorId>) {
    let motors: Vec<MotorId> = (1..=count).map(id).collect();
    let mut config = WorldConfig::of(model, motors.iter().copied());
    config.faults = WireFaults {
        hold: ms(hold_ms),
        ..WireFaults::default()
    };
    let mut fixture = Fixture::watching(config, &motors);
    fixture.run(ms(3_000));
    for motor in &motors {
        if mode != Mode::Velocity {
            let switch = Command::SwitchMode { id: *motor, mode };
            fixture.command(switch).unwrap();
            fixture.run(ms(1_500));
        }
    }
    for motor in &motors {
        let drive = Command::Drive {
            id: *motor,
            setpoint: setpoint(mode),
            consent: Consent::None,
        };
        fixture
            .command(drive)
            .unwrap_or_else(|why| panic!("{model} {motor} {why:?}"));
    }
    fixture.run(ms(500));
    fixture.forget_the_past();
    (fixture, motors)
}

/// Outside the velocity loop a motor names its loop before a drive frame, if its last reply is older than 60 ms. On a slow
/// line every one is.
#[test]
fn every_motor_gets_its_drive_frames_in_every_loop_behind_a_slow_adapter() {
    for model in SIBLINGS {
        for mode in [Mode::OpenLoop, Mode::Velocity] {
            for (count, hold_ms) in [(1, 16), (2, 16), (4, 16), (8, 4), (8, 16)] {
                let (mut fixture, motors) = driven(model, count, mode, hold_ms);
                let from = fixture.now;
                fixture.run(ms(4_000));
                for motor in motors {
                    let times = fixture.drive_times(motor);
                    let ends: Vec<Instant> = iter::once(from)
                        .chain(times.iter().copied())
                        .chain([fixture.now])
                        .collect();
                    let gap = longest_gap(&ends);
                    assert!(
                        gap <= ms(700),
                        "{model} {mode}, {count} motors, {hold_ms} ms: {gap:?}"
                    );
                }
            }
        }
    }
}

/// The two kinds of queries alternate, also where motors are driven.
#[test]
fn every_motor_is_asked_for_angle_and_loop_in_time() {
    for model in SIBLINGS {
        for (count, lost, bound) in [
            (1, 0.0, 450),
            (4, 0.0, 450),
            (8, 0.0, 900),
            (1, 0.3, 900),
            (4, 0.3, 1_500),
        ] {
            let (mut fixture, motors) = driven(model, count, Mode::Velocity, 0);
            fixture.world.set_faults(WireFaults {
                lose_reply: lost,
                ..WireFaults::default()
            });
            let from = fixture.now;
            fixture.run(ms(10_000));
            for motor in motors {
                for kind in KINDS {
                    let is_its = |bytes: &[u8; 10]| (bytes[0], bytes[1]) == (motor.get(), kind);
                    let asked = fixture
                        .sent
                        .iter()
                        .filter(|sent| is_its(sent.frame.bytes()));
                    let asked = asked.map(|sent| sent.at);
                    let ends: Vec<Instant> =
                        iter::once(from).chain(asked).chain([fixture.now]).collect();
                    let gap = longest_gap(&ends);
                    let at = format!("{model}, {count} motors, {lost} lost, {kind:02X} to {motor}");
                    assert!(gap <= ms(bound), "{at}: {gap:?}");
                }
            }
        }
    }
}
