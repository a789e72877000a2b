//! Worlds in which a rule was once broken, with nothing left in them that the fault does not need.
//!
//! A seed means another world as soon as anything new is drawn, so what it had found is kept here.
#![cfg(test)]

use std::time::Duration;

use motorlink_bus::{
    BusSettings, Command, CommandRate, Consent, GroupSetpoints, Limits, Repeat, SetIdFrames,
};
use motorlink_fault_simulation::{
    Absence, Action, Coverage, Failure, LineFault, PendingInput, Scenario, play, trace_lines,
};
use motorlink_protocol::{
    AssignableId, CurrentTarget, Frame, Mode, MotorId, PositionTarget, Request, Setpoint,
    SpeedTarget, family::Model,
};
use motorlink_simulator::WhenSilent;

fn id(address: u8) -> MotorId {
    MotorId::new(address).unwrap()
}

fn pause(ms: u64) -> Action {
    Action::Pause(Duration::from_millis(ms))
}

fn amps(id: MotorId, amps: f32) -> Action {
    drive(id, Setpoint::Current(CurrentTarget::from_amps(amps)))
}

fn degrees(id: MotorId, degrees: f32) -> Action {
    drive(
        id,
        Setpoint::Position(PositionTarget::from_degrees(degrees)),
    )
}

fn raw(frame: Frame) -> Action {
    Action::Command(Command::SendRaw {
        frame,
        repeat: Repeat::Once,
        consent: Consent::None,
    })
}

fn away(cause: Absence, lasts_ms: u64, pending: Vec<PendingInput>) -> Action {
    Action::WorkerAbsent {
        cause,
        duration: Duration::from_millis(lasts_ms),
        pending,
    }
}

fn fresh(action: &Action) -> PendingInput {
    let Action::Command(command) = action else {
        panic!("{action:?}");
    };
    PendingInput::Command {
        command: *command,
        age: Duration::ZERO,
    }
}

fn rpm(id: MotorId, rpm: i32) -> Action {
    drive(id, Setpoint::velocity(SpeedTarget::clamped(rpm)))
}

fn drive(id: MotorId, setpoint: Setpoint) -> Action {
    Action::Command(Command::Drive {
        id,
        setpoint,
        consent: Consent::None,
    })
}

fn switch(id: MotorId, mode: Mode) -> Action {
    Action::Command(Command::SwitchMode { id, mode })
}

/// The seed is that of the noise on the line, and the one that found it.
#[allow(
    clippy::needless_pass_by_value,
    reason = "each scenario is a literal list"
)]
fn holds(seed: u64, motors: u8, actions: Vec<Action>) {
    for when_silent in WhenSilent::ALL {
        let scenario = Scenario {
            seed,
            model: Model::Ddsm115,
            motors: (1..=motors).map(id).collect(),
            need_five_switches: Vec::new(),
            obey_all: false,
            when_silent,
            speed_stuck: Vec::new(),
            angle_deg: 0.0,
            actions: actions.clone(),
        };
        if let Err(failure) = play(&scenario, &mut Coverage::default()) {
            let passed = trace_lines(&scenario, 20).join("\n  ");
            let Failure { step, violation } = failure;
            panic!("{when_silent:?}, step {step}: {violation}\n  {passed}");
        }
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
            Action::Command(Command::Configure(BusSettings {
                rate: CommandRate::new(149).unwrap(),
                ..BusSettings::default()
            })),
            pause(150),
            switch(id(1), Mode::Position),
            pause(60),
            Action::Power {
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
            Action::Power {
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
    let to_current = Request::SwitchMode {
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
            Action::Heat {
                id: id(1),
                celsius: 90,
            },
            switch(id(2), Mode::Position),
            pause(700),
            raw(to_current.frame()),
            pause(700),
            switch(id(1), Mode::Current),
            pause(700),
            Action::Heat {
                id: id(1),
                celsius: 90,
            },
            drive(
                id(2),
                Setpoint::Position(PositionTarget::new(17_181).unwrap()),
            ),
            pause(30),
            Action::Command(Command::FullScan),
            pause(5_000),
            Action::Command(Command::Stop(id(2))),
            pause(700),
            rpm(id(2), 0),
            pause(30),
            Action::Line(LineFault::Stalls),
            pause(2_500),
        ],
    );
}

/// Rule `TelemetryIsTrue`: four simultaneous replies were read as a reply of another motor.
#[test]
fn answers_that_collide_into_a_good_frame_are_not_read() {
    holds(
        28_115,
        4,
        vec![
            pause(150),
            rpm(id(1), -134),
            Action::Heat {
                id: id(3),
                celsius: 90,
            },
            pause(2_650),
            Action::Command(Command::IdQuery),
            pause(700),
        ],
    );
}

/// Rule `TelemetryIsTrue`: the same where the CRC holds whatever the seed.
#[test]
fn mixed_answers_with_a_good_crc_are_not_read() {
    holds(
        5,
        3,
        vec![
            pause(600),
            Action::Line(LineFault::Mixes),
            Action::Command(Command::IdQuery),
            pause(200),
        ],
    );
}

/// Rule `GapWithdraws`: after ten minutes of sleep a wheel at rest was driven at its old speed.
#[test]
fn a_wheel_that_was_driven_before_the_machine_slept_is_not_driven_after() {
    let turns = [PendingInput::Pong, PendingInput::Bytes, PendingInput::Poll];
    for (first, second, third) in [
        (0, 1, 2),
        (0, 2, 1),
        (1, 0, 2),
        (1, 2, 0),
        (2, 0, 1),
        (2, 1, 0),
    ] {
        let pending = [first, second, third].map(|place: usize| turns.get(place).unwrap().clone());
        holds(
            1,
            2,
            vec![
                pause(600),
                rpm(id(1), 100),
                pause(1_000),
                away(Absence::Sleep, 600_000, pending.to_vec()),
                pause(700),
            ],
        );
    }
}

/// The same for a worker that was delayed, whose page answers before the timer.
#[test]
fn a_wheel_that_was_driven_before_a_delay_is_not_driven_after() {
    for lasts_ms in [1_000, 2_000, 30_000] {
        holds(
            1,
            1,
            vec![
                pause(600),
                rpm(id(1), 100),
                pause(1_000),
                away(
                    Absence::Delay,
                    lasts_ms,
                    vec![PendingInput::Pong, PendingInput::Poll, PendingInput::Bytes],
                ),
                pause(700),
            ],
        );
    }
}

/// Rule `TelemetryIsTrue`: a reply that had waited through the sleep was taken as of now.
#[test]
fn a_reply_from_before_a_sleep_is_no_reading_of_now() {
    // One of these falls between a query and its reply.
    for phase_ms in 0..100 {
        holds(
            714,
            1,
            vec![
                Action::Heat {
                    id: id(1),
                    celsius: 90,
                },
                pause(600 + phase_ms),
                away(
                    Absence::Sleep,
                    120_000,
                    vec![PendingInput::Bytes, PendingInput::Pong, PendingInput::Poll],
                ),
                pause(100),
            ],
        );
    }
}

/// Rule `IdChangeIsProved`: an ID change went on behind minutes of sleep, by a scan that was too old.
#[test]
fn an_id_change_does_not_go_on_behind_a_sleep() {
    let to = AssignableId::new(id(9)).unwrap();
    holds(
        1,
        1,
        vec![
            Action::Command(Command::FullScan),
            pause(8_000),
            Action::Command(Command::SetId {
                from: id(1),
                to,
                frames: SetIdFrames::Five,
            }),
            away(
                Absence::Sleep,
                172_000,
                vec![PendingInput::Pong, PendingInput::Bytes, PendingInput::Poll],
            ),
            pause(700),
        ],
    );
}

/// Rule `StopIsNext`: a stop frame that the port refused was counted, and the stop ended unchecked.
#[test]
fn a_refused_stop_is_not_over_because_time_has_passed() {
    holds(
        1,
        2,
        vec![
            pause(600),
            rpm(id(1), 80),
            Action::PortRefuses { frames: 24 },
            Action::Command(Command::Stop(id(1))),
            pause(150),
            away(
                Absence::Delay,
                8_000,
                vec![
                    PendingInput::Pong,
                    PendingInput::Bytes,
                    PendingInput::Poll,
                    fresh(&rpm(id(1), 0)),
                ],
            ),
            pause(300),
        ],
    );
}

/// Rule `StopMovesNothing`: refused mode switches counted towards the five, and the brake went into the
/// position loop, where it means 0 degrees.
#[test]
fn a_stop_whose_switches_are_refused_turns_no_wheel_at_an_angle() {
    for frames in 1..=30 {
        holds(
            1,
            1,
            vec![
                pause(600),
                switch(id(1), Mode::Position),
                pause(450),
                degrees(id(1), 175.0),
                pause(291),
                Action::PortRefuses { frames },
                Action::Command(Command::Stop(id(1))),
                pause(900),
            ],
        );
    }
}

/// Rule `HoldHolds`: a hold waited for the next reply, and drove on until it came.
#[test]
fn a_hold_without_replies_does_not_go_on() {
    for seed in 0..60 {
        holds(
            seed,
            1,
            vec![
                pause(600),
                switch(id(1), Mode::Position),
                pause(450),
                degrees(id(1), 170.0),
                pause(100 + seed * 5),
                Action::Line(LineFault::LosesMuch),
                Action::Command(Command::Hold(id(1))),
                pause(1_000),
            ],
        );
    }
}

/// Rule `HoldHolds`: a wheel whose frames ceased just before the hold coasted, and the rule took that for a drive.
#[test]
fn a_hold_that_the_port_refuses_may_coast() {
    let slow = BusSettings {
        rate: CommandRate::new(1).unwrap(),
        ramp: None,
        ..BusSettings::default()
    };
    for ms in (200..500).step_by(2) {
        holds(
            9707,
            1,
            vec![
                pause(600),
                Action::Command(Command::Configure(slow)),
                switch(id(1), Mode::Position),
                pause(1_500),
                degrees(id(1), 170.0),
                pause(ms),
                Action::PortRefuses { frames: 37 },
                Action::Command(Command::Hold(id(1))),
                pause(1_000),
            ],
        );
    }
}

/// Rule `NothingAboveALimit`: a frame to all with a value was taken for a question.
#[test]
fn a_raw_frame_to_all_is_under_the_speed_limit() {
    let frame = Frame::with_crc([0xC8, 0x64, 0x01, 0x92, 0, 0, 0, 0, 0]);
    holds(1, 2, vec![pause(600), raw(frame), pause(100)]);
}

/// The same for a value that was taken for no speed.
#[test]
fn a_raw_frame_beyond_every_speed_is_under_the_speed_limit() {
    for value in [331_i16, 2_000, i16::MAX, i16::MIN] {
        let [high, low] = value.to_be_bytes();
        let frame = Frame::with_crc([1, 0x64, high, low, 0, 0, 0, 0, 0]);
        let limits = Limits::new(20, 2_700, 75).unwrap();
        let limits = Action::Command(Command::Configure(BusSettings {
            limits,
            ..BusSettings::default()
        }));
        holds(1, 1, vec![pause(600), limits, raw(frame), pause(100)]);
    }
}

/// The same for a limit that is lowered under what is driven.
#[test]
fn a_lowered_speed_limit_holds_for_what_is_driven() {
    let limits = Limits::new(20, 2_700, 75).unwrap();
    holds(
        1,
        1,
        vec![
            pause(600),
            rpm(id(1), 100),
            pause(30),
            Action::Command(Command::Configure(BusSettings {
                limits,
                ..BusSettings::default()
            })),
            pause(300),
        ],
    );
}

/// Rule `ReversalPassesZero`: a zero that was refused, cut or lost counted as passed.
#[test]
fn a_torque_is_not_reversed_behind_a_zero_that_did_not_arrive() {
    let cut = |reported| Action::PortTruncates {
        frames: 1,
        bytes: 5,
        reported,
    };
    for disturbance in [Action::PortRefuses { frames: 1 }, cut(true), cut(false)] {
        holds(
            1,
            1,
            vec![
                pause(600),
                switch(id(1), Mode::Current),
                pause(450),
                amps(id(1), 0.5),
                pause(100),
                disturbance,
                amps(id(1), -0.5),
                pause(100),
            ],
        );
    }
}

/// The same where an older reply comes in place of the answer.
#[test]
fn a_torque_is_not_reversed_behind_a_late_reply() {
    holds(
        1,
        1,
        vec![
            switch(id(1), Mode::Current),
            pause(133),
            Action::Line(LineFault::Gathers(59)),
            amps(id(1), -0.16),
            pause(147),
            Action::PortRefuses { frames: 2 },
            amps(id(1), 0.16),
            pause(30),
        ],
    );
}

/// Rule `StopMovesNothing` was wrong here: the drive frame is on the wire when the page goes, and the worker is
/// not called before the wheel has obeyed it and run down.
#[test]
fn a_frame_on_the_wire_when_a_stop_comes_explains_what_the_wheel_does() {
    holds(
        39_562,
        3,
        vec![
            pause(10),
            rpm(id(3), 28),
            Action::PageClosed,
            away(
                Absence::Delay,
                25_631,
                vec![PendingInput::Bytes, PendingInput::Poll],
            ),
        ],
    );
}

/// Rule `StopIsNext` was wrong here: three motors are withdrawn at one moment, one event each, and the last
/// comes behind the windows of the other two.
#[test]
fn the_last_of_three_withdrawn_motors_waits_for_the_windows_of_two() {
    let velocity = |rpm| Setpoint::velocity(SpeedTarget::clamped(rpm));
    let parts = [
        (id(1), velocity(56)),
        (id(2), velocity(-56)),
        (id(3), velocity(56)),
    ];
    holds(
        54_626,
        3,
        vec![
            pause(2_474),
            rpm(id(1), 0),
            Action::Line(LineFault::Stalls),
            pause(2_500),
            Action::Command(Command::DriveGroup {
                setpoints: GroupSetpoints::new(&parts).unwrap(),
                consent: Consent::HighCurrent,
            }),
            Action::PortTruncates {
                frames: 4,
                bytes: 4,
                reported: false,
            },
            pause(700),
        ],
    );
}

/// Rule `StopIsNext`: the first frame of the stop of motor 4, which the port truncates silently, comes before the event
/// that reports its stop. The bus repeats it in turn with the stops of the other two.
#[test]
fn a_silently_truncated_first_frame_of_a_stop_is_repeated_in_its_turn() {
    holds(
        4_126,
        4,
        vec![
            switch(id(1), Mode::Current),
            pause(150),
            Action::LineDies {
                lasts: Duration::from_millis(22_452),
            },
            pause(874),
            switch(id(4), Mode::Position),
            pause(450),
            drive(id(4), Setpoint::Position(PositionTarget::new(976).unwrap())),
            Action::Command(Command::Stop(id(1))),
            Action::Command(Command::Stop(id(2))),
            Action::Command(Command::Stop(id(3))),
            pause(2_500),
            rpm(id(1), -27),
            rpm(id(2), 79),
            rpm(id(3), 62),
            Action::Line(LineFault::Gathers(25)),
            pause(3_795),
            pause(299),
            Action::PortTruncates {
                frames: 5,
                bytes: 1,
                reported: false,
            },
            pause(2_500),
        ],
    );
}
