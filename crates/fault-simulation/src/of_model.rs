//! A scenario for motors of another model.
//!
//! The actions of a seed are those of a DDSM115, in the terms of the model: its loops, its greatest speed and its
//! frames. So one seed does the same to every model.

use motorlink_bus::{Command, GroupSetpoints};
use motorlink_protocol::{
    Frame, Mode, OpenLoopTarget, Request as Combined, Setpoint, SpeedTarget,
    family::{Model, Request},
};

use crate::action::{Action, LineFault, PendingInput};

/// The first byte of a frame for all motors.
const ALL: u8 = 0xC8;

/// The same actions for motors of this model.
pub(crate) fn in_terms_of(model: Model, actions: Vec<Action>) -> Vec<Action> {
    // The same in a whole scenario: a switch and the setpoints behind it belong together.
    let is_open =
        model.has(Mode::OpenLoop) && (!model.has(Mode::Current) || actions.len().is_multiple_of(2));
    let actions = actions.into_iter();
    let actions = actions.map(|action| action_for(model, is_open, action));
    let actions: Vec<_> = actions.collect();
    if model.replies_look_like_requests() {
        with_an_echo_from_the_start(actions)
    } else {
        actions
    }
}

/// An adapter echoes or it does not: its wiring decides that. An echo that looks like a reply, and begins while the
/// port is open, cannot always be told from one.
fn with_an_echo_from_the_start(actions: Vec<Action>) -> Vec<Action> {
    let echoes = |action: &Action| {
        matches!(
            action,
            Action::Line(LineFault::Echoes | LineFault::CutsEchoes(_) | LineFault::EchoesParts)
        )
    };
    let first = actions.iter().find(|action| echoes(action)).cloned();
    let others = actions.into_iter().filter(|action| !echoes(action));
    first.into_iter().chain(others).collect()
}

/// The same action for motors of this model. `is_open` if the open loop takes the place of the current loop.
fn action_for(model: Model, is_open: bool, mut action: Action) -> Action {
    match &mut action {
        Action::Command(given) => *given = command_for(model, is_open, *given),
        Action::WorkerAbsent { pending, .. } => {
            for input in pending {
                if let PendingInput::Command { command, .. } = input {
                    *command = command_for(model, is_open, *command);
                }
            }
        }
        _ => {}
    }
    action
}

/// The same command for motors of this model.
pub(crate) fn command_for(model: Model, is_open: bool, mut given: Command) -> Command {
    match &mut given {
        Command::Start { setpoint, .. }
        | Command::Drive { setpoint, .. }
        | Command::Adjust { setpoint, .. } => *setpoint = setpoint_for(model, is_open, *setpoint),
        Command::StartGroup { setpoints, .. }
        | Command::DriveGroup { setpoints, .. }
        | Command::AdjustGroup { setpoints, .. } => *setpoints = group(model, is_open, *setpoints),
        Command::SwitchMode { mode: asked, .. } => *asked = mode(is_open, *asked),
        Command::SendRaw { frame: drawn, .. } => *drawn = frame(model, is_open, *drawn),
        _ => {}
    }
    given
}

fn group(model: Model, is_open: bool, setpoints: GroupSetpoints) -> GroupSetpoints {
    let entries = setpoints.entries();
    let entries: Vec<_> = entries
        .map(|(id, asked)| (id, setpoint_for(model, is_open, asked)))
        .collect();
    GroupSetpoints::new(&entries).unwrap_or(setpoints)
}

/// The open loop takes the place of a current loop that the model does not have; of one that it has, in every other
/// scenario.
fn mode(is_open: bool, asked: Mode) -> Mode {
    match asked {
        Mode::Current if is_open => Mode::OpenLoop,
        other => other,
    }
}

fn setpoint_for(model: Model, is_open: bool, asked: Setpoint) -> Setpoint {
    let rpm_max = i32::from(model.spec().speed_rpm_max);
    match asked {
        Setpoint::Velocity {
            speed,
            acceleration,
        } => Setpoint::Velocity {
            speed: SpeedTarget::clamped(i32::from(speed.rpm()).clamp(-rpm_max, rpm_max)),
            acceleration,
        },
        Setpoint::Current(current) if is_open => {
            Setpoint::OpenLoop(OpenLoopTarget::nearest(current.raw()))
        }
        other => other,
    }
}

/// A well-formed frame as the model has it; any other as it was drawn.
fn frame(model: Model, is_open: bool, drawn: Frame) -> Frame {
    if !model.has_separate_frames() {
        return drawn;
    }
    let &[to, command, high, low, _, _, acceleration, brake, _, last] = drawn.bytes();
    match Combined::parse(&drawn) {
        Ok(Combined::SwitchMode { id, mode: asked }) => {
            let asked = mode(is_open, asked);
            let switch = Request::SwitchMode { id, mode: asked };
            switch.frame(model).unwrap_or(drawn)
        }
        Ok(Combined::Drive { .. }) => {
            let units = i16::from(model.spec().speed_units_per_rpm);
            let value = i16::from_be_bytes([high, low]).saturating_mul(units);
            let [high, low] = value.to_be_bytes();
            Frame::with_crc([to, command, high, low, 0, 0, acceleration, brake, 0])
        }
        // A mode switch to all.
        _ if to == ALL && command == 0xA0 => Frame::with_crc([to, command, last, 0, 0, 0, 0, 0, 0]),
        _ => drawn,
    }
}
