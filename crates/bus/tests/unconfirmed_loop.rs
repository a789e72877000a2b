//! A mode switch whose outcome is not known: the motor may be in the position loop, where zero moves
//! the wheel.

use crate::fixture;
use crate::fixture::{Fixture, ID, degrees, ms, rpm};
use motorlink_bus::{Activity, Command, StopReason};
use motorlink_protocol::{Drive, Mode, MotorId};
use motorlink_simulator::{MotorConfig, WireFaults, WorldConfig};

const STOP: Command = Command::StopAll(StopReason::Operator);

const fn switch_to(mode: Mode) -> Command {
    Command::SwitchMode { id: ID, mode }
}

/// A wheel that stands at 120 degrees in the velocity loop, far from where a zero would turn it.
/// The motor takes a mode switch after so many frames.
fn standing_at_120(mode_switch_frames: u8) -> Fixture {
    let motor = MotorConfig {
        mode_switch_frames,
        ..MotorConfig::new(MotorId::FIRST)
    };
    let mut fixture = Fixture::watching(
        WorldConfig {
            motors: vec![motor],
            ..WorldConfig::default()
        },
        &[ID],
    );
    fixture.switch(Mode::Position);
    fixture.drive(degrees(120.0)).unwrap();
    fixture.run(ms(2_000));
    fixture.command(Command::Stop(ID)).unwrap();
    fixture.run(ms(733));
    assert_eq!(fixture.activity(), Activity::Idle);
    assert_eq!(fixture.world.motor(ID).unwrap().mode(), Mode::Velocity);
    fixture
}

fn angle(fixture: &Fixture) -> f32 {
    fixture.world.motor(ID).unwrap().angle_deg()
}

/// The motor hears, but its replies are lost.
#[test]
fn a_stop_after_an_unconfirmed_switch_to_the_position_loop_does_not_move_the_wheel() {
    for wait in (0..1_000).step_by(25) {
        let mut fixture = standing_at_120(1);
        let before = angle(&fixture);
        fixture.command(switch_to(Mode::Position)).unwrap();
        fixture.world.motor_mut(ID).unwrap().mute(true);
        fixture.run(ms(wait));
        fixture.command(STOP).unwrap();
        fixture.run(ms(1_000));
        let after = angle(&fixture);
        assert!(
            (after - before).abs() < 2.0,
            "after {wait} ms: {before} to {after}"
        );
    }
}

#[test]
fn a_speed_is_not_sent_after_an_unconfirmed_switch_to_the_position_loop() {
    for wait in (300..700).step_by(10) {
        let mut fixture = standing_at_120(1);
        let before = angle(&fixture);
        fixture.command(switch_to(Mode::Position)).unwrap();
        fixture.world.motor_mut(ID).unwrap().mute(true);
        fixture.run(ms(wait));
        let _ = fixture.drive(rpm(50));
        fixture.run(ms(1_000));
        let after = angle(&fixture);
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
                let mut fixture = standing_at_120(frames);
                let before = angle(&fixture);
                fixture.command(switch_to(Mode::Position)).unwrap();
                fixture.run(ms(first_ms));
                fixture.command(switch_to(second)).unwrap();
                fixture.run(ms(second_ms));
                fixture.command(STOP).unwrap();
                fixture.run(ms(1_000));
                let after = angle(&fixture);
                assert!(
                    (after - before).abs() < 2.0,
                    "{frames} frames, {second} at {first_ms} ms, stop {second_ms} ms later: \
                     {before} to {after}"
                );
            }
        }
    }
}

/// An adapter begins to hold bytes, and the reply of before the switches is read as one behind them.
#[test]
fn a_late_reply_does_not_report_the_loop_of_after_a_switch() {
    for (hold, wait) in [60, 90, 120, 160]
        .into_iter()
        .flat_map(|hold| (60..200).step_by(5).map(move |wait| (hold, wait)))
    {
        let mut fixture = standing_at_120(5);
        fixture.run(ms(70));
        let before = angle(&fixture);
        fixture.world.set_faults(WireFaults {
            hold: ms(hold),
            ..WireFaults::default()
        });
        fixture.run(ms(60));
        fixture.command(switch_to(Mode::Position)).unwrap();
        fixture.run(ms(wait));
        fixture.command(STOP).unwrap();
        fixture.run(ms(1_000));
        let after = angle(&fixture);
        assert!(
            (after - before).abs() < 2.0,
            "held for {hold} ms, stop after {wait} ms: {before} to {after}"
        );
    }
}

/// Two of the five switches back are lost, and the reply of before the switch forth says that all is done.
#[test]
fn a_late_reply_does_not_confirm_a_switch_back() {
    let holding = |lose_request| WireFaults {
        hold: ms(120),
        lose_request,
        ..WireFaults::default()
    };
    let mut switched = 0;
    for wait in 60..180 {
        let mut fixture = standing_at_120(5);
        fixture.switch(Mode::Position);
        fixture.run(ms(85));
        fixture.world.set_faults(holding(0.0));
        fixture.run(ms(40));
        fixture.command(switch_to(Mode::Velocity)).unwrap();
        fixture.run(ms(wait));
        // If too few switches back have reached it, it stays in the position loop.
        let is_switched = fixture.world.motor(ID).unwrap().mode() == Mode::Velocity;
        switched += u32::from(is_switched);
        fixture.world.set_faults(holding(1.0));
        fixture.forget_the_past();
        fixture.command(switch_to(Mode::Position)).unwrap();
        fixture.drive(degrees(200.0)).unwrap();
        fixture.run(ms(30));
        fixture.world.set_faults(holding(0.0));
        let value = |sent: &fixture::Sent| sent.drive_of(ID).map_or(0, Drive::signed);
        for _ in 0..600 {
            fixture.run(ms(1));
            let mode = fixture.world.motor(ID).unwrap().mode();
            let angle = fixture.sent.iter().find(|sent| value(sent) != 0);
            assert!(
                angle.is_none() || mode == Mode::Position,
                "after {wait} ms: {angle:?} in {mode}"
            );
        }
    }
    assert!(switched > 60, "{switched}");
}
