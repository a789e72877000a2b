//! Events of the bus as causes that end a run.

use motorlink_bus::{Refusal, StopReason, WithdrawReason};
use motorlink_experiments::runner::{Cause, ExceededLimit};
use motorlink_protocol::MotorId;

use crate::exchange::Input;

/// The cause that ends a run by this input, if there is one. `first` stands for a run of several motors.
pub(crate) fn cause(input: &Input, first: MotorId) -> Option<Cause> {
    Some(match input {
        Input::Withdrawn(id, reason) => withdrawn(*id, *reason),
        Input::StopBegan(reason) => stopped(*reason),
        Input::Driven(id) => Cause::Driven(id.unwrap_or(first)),
        Input::Refused(refusal) => refused(*refusal, first),
        Input::Unplugged => Cause::Unplugged,
        Input::Closed => Cause::PortClosed,
        Input::Tick | Input::Telemetry(_) | Input::Sent { .. } | Input::Message { .. } => {
            return None;
        }
    })
}

const fn withdrawn(id: MotorId, reason: WithdrawReason) -> Cause {
    match reason {
        WithdrawReason::Silent | WithdrawReason::NotEnabled => Cause::Silent(id),
        WithdrawReason::Fault(faults) => Cause::Fault(id, faults),
        WithdrawReason::OtherLoop { reported } => Cause::OtherLoop(id, reported),
        WithdrawReason::Limit(_) | WithdrawReason::TemperatureUnknown => {
            Cause::Limit(id, ExceededLimit::OfBus)
        }
        // A person has pressed Hold.
        WithdrawReason::AngleMisfits => Cause::Stopped,
    }
}

const fn stopped(reason: StopReason) -> Cause {
    match reason {
        StopReason::PageGone => Cause::TabClosed,
        StopReason::PageSilent => Cause::PageSilent,
        StopReason::OperatorLost => Cause::OperatorLost,
        StopReason::PageHidden => Cause::FocusLost,
        StopReason::ComputerSlept => Cause::Slept,
        StopReason::LoopDelayed => Cause::Late,
        StopReason::Disconnect => Cause::PortClosed,
        StopReason::Job => Cause::Scan,
        StopReason::OtherModel => Cause::OtherModel,
        StopReason::LeftDriven => Cause::LeftDriven,
        StopReason::Operator | StopReason::OneMotor => Cause::Stopped,
    }
}

fn refused(refusal: Refusal, first: MotorId) -> Cause {
    match refusal {
        Refusal::Halted => Cause::Stopped,
        Refusal::PageSilent => Cause::PageSilent,
        Refusal::NotAnswering(id) => Cause::Silent(id),
        Refusal::OtherLoop { id, reported, .. } => Cause::OtherLoop(id, reported),
        Refusal::FaultActive { id, faults } => Cause::Fault(id, faults),
        Refusal::TooHot { id, .. } => Cause::Limit(id, ExceededLimit::OfBus),
        Refusal::SpeedUnknown(id)
        | Refusal::Stopping(id)
        | Refusal::NotStopped(id)
        | Refusal::NotDriven(id)
        | Refusal::InGroup(id)
        | Refusal::Switching(id) => Cause::Refused(id),
        _ => Cause::Refused(first),
    }
}
