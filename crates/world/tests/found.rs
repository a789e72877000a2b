//! Worlds in which a rule was once broken, with nothing left in them that the fault does not need.
//!
//! A seed means another world as soon as anything new is drawn, so what it had found is kept here.
#![allow(clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::unwrap_used, reason = "the numbers are good ones")]

use std::time::Duration;

use motorlink_bus::{Command, CommandRate, Consent, Repeat};
use motorlink_protocol::{
    CurrentTarget, Mode, MotorId, PositionTarget, Request, Setpoint, SpeedTarget,
};
use motorlink_world::{Act, Coverage, LineFault, Story, play, what_passed};

fn id(address: u8) -> MotorId {
    MotorId::new(address).unwrap()
}

fn pause(ms: u64) -> Act {
    Act::Pause(Duration::from_millis(ms))
}

fn rpm(id: MotorId, rpm: i32) -> Act {
    drive(id, Setpoint::velocity(SpeedTarget::clamped(rpm)))
}

fn drive(id: MotorId, setpoint: Setpoint) -> Act {
    Act::Command(Command::Drive {
        id,
        setpoint,
        consent: Consent::None,
    })
}

fn switch(id: MotorId, mode: Mode) -> Act {
    Act::Command(Command::SwitchMode { id, mode })
}

/// The seed is that of the noise on the line, and the one that found it.
fn holds(seed: u64, motors: u8, acts: Vec<Act>) {
    let story = Story {
        seed,
        motors: (1..=motors).map(id).collect(),
        acts,
    };
    if let Err(failure) = play(&story, &mut Coverage::default()) {
        let passed = what_passed(&story, 20).join("\n  ");
        panic!("step {}: {}\n  {passed}", failure.step, failure.violation);
    }
}

/// Rule `SilentIsWithdrawn`: a setpoint that was given during the switch was given 200 ms of its own.
#[test]
fn a_motor_that_loses_power_before_its_switch_is_driven_by_its_old_silence() {
    holds(
        20_482,
        3,
        vec![
            pause(300),
            Act::Command(Command::SetRate(CommandRate::new(149).unwrap())),
            pause(150),
            switch(id(1), Mode::Position),
            pause(60),
            Act::Power {
                id: id(1),
                on: false,
            },
            drive(
                id(1),
                Setpoint::Position(PositionTarget::new(23_327).unwrap()),
            ),
            pause(700),
        ],
    );
}

/// The same for a motor that was driven before its switch.
#[test]
fn a_driven_motor_that_loses_power_in_its_switch_is_withdrawn_by_its_old_silence() {
    let current = CurrentTarget::new(1_695).unwrap();
    holds(
        33_226,
        3,
        vec![
            pause(2_500),
            rpm(id(1), 48),
            switch(id(1), Mode::Current),
            drive(id(1), Setpoint::Current(current)),
            pause(30),
            Act::Power {
                id: id(1),
                on: false,
            },
            pause(180),
        ],
    );
}

/// Rule `TelemetryIsTrue`: of two good frames in one chunk and a third that is made of their halves, the
/// third was read.
#[test]
fn a_frame_made_of_the_halves_of_two_others_is_not_read() {
    let raw = Request::SwitchMode {
        id: id(1),
        mode: Mode::Current,
    };
    holds(
        4_636,
        2,
        vec![
            pause(3_200),
            rpm(id(1), 0),
            pause(2_650),
            Act::Heat {
                id: id(1),
                celsius: 90,
            },
            switch(id(2), Mode::Position),
            pause(700),
            Act::Command(Command::SendRaw {
                frame: raw.frame(),
                repeat: Repeat::Once,
                consent: Consent::None,
            }),
            pause(700),
            switch(id(1), Mode::Current),
            pause(700),
            Act::Heat {
                id: id(1),
                celsius: 90,
            },
            drive(
                id(2),
                Setpoint::Position(PositionTarget::new(17_181).unwrap()),
            ),
            pause(30),
            Act::Command(Command::FullScan),
            pause(5_000),
            Act::Command(Command::Stop(id(2))),
            pause(700),
            rpm(id(2), 0),
            pause(30),
            Act::Line(LineFault::Stalls),
            pause(2_500),
        ],
    );
}

/// Rule `TelemetryIsTrue`: the answers of four motors at once were read as one of another that nobody gave.
#[test]
fn answers_that_collide_into_a_good_frame_are_not_read() {
    holds(
        28_115,
        4,
        vec![
            pause(150),
            rpm(id(1), -134),
            Act::Heat {
                id: id(3),
                celsius: 90,
            },
            pause(2_650),
            Act::Command(Command::IdQuery),
            pause(700),
        ],
    );
}
