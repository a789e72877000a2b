//! A mode switch whose outcome is not known: the motor may be in the position loop, where zero moves
//! the wheel.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test fails by panicking, in its helpers too"
)]

mod bench;

use bench::{Bench, ID, degrees, ms, rpm};
use motorlink_bus::{Activity, Command, StopReason};
use motorlink_protocol::{Mode, MotorId};
use motorlink_simulator::{MotorConfig, WorldConfig};

const STOP: Command = Command::StopAll(StopReason::Operator);

const fn switch_to(mode: Mode) -> Command {
    Command::SwitchMode { id: ID, mode }
}

/// A wheel that stands at 120 degrees in the velocity loop, far from where a zero would turn it.
/// The motor takes a mode switch after so many frames.
fn standing_at_120(mode_switch_frames: u8) -> Bench {
    let motor = MotorConfig {
        mode_switch_frames,
        ..MotorConfig::new(MotorId::FIRST)
    };
    let mut bench = Bench::watching(
        WorldConfig {
            motors: vec![motor],
            ..WorldConfig::default()
        },
        &[ID],
    );
    bench.switch(Mode::Position);
    bench.drive(degrees(120.0)).unwrap();
    bench.run(ms(2_000));
    bench.command(Command::Stop(ID)).unwrap();
    bench.run(ms(733));
    assert_eq!(bench.activity(), Activity::Idle);
    assert_eq!(bench.world.motor(ID).unwrap().mode(), Mode::Velocity);
    bench
}

fn angle(bench: &Bench) -> f32 {
    bench.world.motor(ID).unwrap().angle_deg()
}

/// The motor hears, but its replies are lost.
#[test]
fn a_stop_after_an_unconfirmed_switch_to_the_position_loop_does_not_move_the_wheel() {
    for wait in (0..1_000).step_by(25) {
        let mut bench = standing_at_120(1);
        let before = angle(&bench);
        bench.command(switch_to(Mode::Position)).unwrap();
        bench.world.motor_mut(ID).unwrap().mute(true);
        bench.run(ms(wait));
        bench.command(STOP).unwrap();
        bench.run(ms(1_000));
        let after = angle(&bench);
        assert!(
            (after - before).abs() < 2.0,
            "after {wait} ms: {before} to {after}"
        );
    }
}

#[test]
fn a_speed_is_not_sent_after_an_unconfirmed_switch_to_the_position_loop() {
    for wait in (300..700).step_by(10) {
        let mut bench = standing_at_120(1);
        let before = angle(&bench);
        bench.command(switch_to(Mode::Position)).unwrap();
        bench.world.motor_mut(ID).unwrap().mute(true);
        bench.run(ms(wait));
        let _ = bench.drive(rpm(50));
        bench.run(ms(1_000));
        let after = angle(&bench);
        assert!(
            (after - before).abs() < 2.0,
            "after {wait} ms: {before} to {after}"
        );
    }
}

#[test]
fn a_stop_during_a_second_switch_does_not_move_the_wheel() {
    for frames in [1, 5] {
        for second in [Mode::Velocity, Mode::Current] {
            for (first_ms, second_ms) in (0..140)
                .step_by(9)
                .flat_map(|a| [0, 3, 10, 20].map(|b| (a, b)))
            {
                let mut bench = standing_at_120(frames);
                let before = angle(&bench);
                bench.command(switch_to(Mode::Position)).unwrap();
                bench.run(ms(first_ms));
                bench.command(switch_to(second)).unwrap();
                bench.run(ms(second_ms));
                bench.command(STOP).unwrap();
                bench.run(ms(1_000));
                let after = angle(&bench);
                assert!(
                    (after - before).abs() < 2.0,
                    "{frames} frames, {second} at {first_ms} ms, stop {second_ms} ms later: \
                     {before} to {after}"
                );
            }
        }
    }
}
