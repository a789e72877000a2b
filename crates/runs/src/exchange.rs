//! What crosses between the two sides of a run.

use std::time::Duration;

use motorlink_bus::{
    CommandRate, GroupSetpoints, Refusal, Sample, StopReason, WithdrawReason, Withheld,
};
use motorlink_protocol::{Instant, MotorId, Setpoint};
use serde::{Deserialize, Serialize};

/// From the host to the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Input {
    /// The time of the last [`Output::wake`] has come.
    Tick,
    /// A motor has replied.
    Telemetry(Sample),
    /// The port has taken a drive frame.
    Sent {
        /// When the port had taken it.
        at: Instant,
        /// The motor.
        id: MotorId,
        /// What it tells the motor.
        setpoint: Setpoint,
    },
    /// A message of the page.
    Message {
        /// A [`ToRun`](motorlink_messages::runs::ToRun).
        bytes: Vec<u8>,
        /// Whether the person's act is too old to start something.
        is_old: bool,
        /// The state of the line.
        line: LineState,
    },
    /// The bus has withdrawn a setpoint.
    Withdrawn(MotorId, WithdrawReason),
    /// A stop has begun.
    StopBegan(StopReason),
    /// A person drives by hand; this motor, if it is a single one.
    Driven(Option<MotorId>),
    /// The bus has refused the setpoints of the last output.
    Refused(Refusal),
    /// The adapter is gone.
    Unplugged,
    /// The port is closed.
    Closed,
}

/// The state of the line when the page sends a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum LineState {
    /// No port is open.
    NotConnected,
    /// "Stop all motors" is in effect.
    Halted,
    /// Something is running.
    Busy,
    /// A run may be armed.
    Free,
}

/// From the program to the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Output {
    /// What to do now.
    pub act: Act,
    /// When the program needs [`Input::Tick`] next. `None`: no run is armed, running or paused, and the program needs
    /// nothing but messages.
    pub wake: Option<Instant>,
}

/// What the host does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[allow(
    clippy::large_enum_variant,
    reason = "there is one at a time, and nearly always the large one"
)]
pub enum Act {
    /// Nothing.
    Nothing,
    /// Start these motors, all or none.
    Start {
        /// Every motor of the run.
        setpoints: GroupSetpoints,
        /// The command rate during the run.
        rate: CommandRate,
    },
    /// Change the setpoints of the motors that the run drives.
    Follow(GroupSetpoints),
    /// Withhold frames of the motors that the run drives.
    Withhold {
        /// For how long, at most.
        time: Duration,
        /// Which frames.
        withheld: Withheld,
    },
    /// Stop the motors of the run.
    Stop,
}
