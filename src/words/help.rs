//! The help in words, as far as they stand outside its files.

use crate::{doctor::Diagnosis, help_topic::HelpTopic};
use motorlink_messages::bus::{Refusal, WithdrawReason};

/// The language of the help, by the name of its file in `public/help/`. English until the page itself
/// has a language: the one place to change then.
pub(crate) const fn help_language() -> &'static str {
    "en"
}

pub(crate) const LOADING: &str = "The help is being loaded.";
pub(crate) const NOT_LOADED: &str =
    "The help could not be loaded. Check that you are online, then try again.";

/// In the graph, before any motor has answered.
pub(crate) const NO_GRAPH: &str = "What a motor reports is drawn here.";
/// Above the wheel, before a motor has answered.
pub(crate) const NO_MOTOR: &str = "No motor: press Connect";

/// What a button reads that leads to a place in the help.
pub(crate) fn link(topic: HelpTopic) -> String {
    format!("Help: {}", title(topic))
}

const fn title(topic: HelpTopic) -> &'static str {
    match topic {
        HelpTopic::Wiring => "wiring",
        HelpTopic::Pinout => "plugs",
        HelpTopic::FirstSpin => "first spin",
        HelpTopic::Specifications => "specifications",
        HelpTopic::Protocol => "protocol",
        HelpTopic::Faults => "protections",
        HelpTopic::Ports => "ports and drivers",
        HelpTopic::Keys => "keys",
        HelpTopic::Troubleshooting => "troubleshooting",
        HelpTopic::NoPortInList => "no port in the list",
        HelpTopic::PortDoesNotOpen => "the port does not open",
        HelpTopic::NoAnswer => "no answer",
        HelpTopic::WrongWay => "wrong way",
        HelpTopic::StaysInLoop => "it stays in its loop",
        HelpTopic::DamagedBytes => "damaged bytes",
        HelpTopic::TwoMotorsOneId => "two motors, one ID",
        HelpTopic::StrangerAnswers => "a stranger answers",
        HelpTopic::AdapterSlow => "slow adapter",
        HelpTopic::StoppedByItself => "stopped by itself",
        HelpTopic::StopNotConfirmed => "stop not confirmed",
        HelpTopic::TemperatureUnknown => "no temperature",
        HelpTopic::Install => "install",
    }
}

/// Where the help says more about a refused command.
pub(crate) const fn of_refusal(refusal: Refusal) -> Option<HelpTopic> {
    Some(match refusal {
        Refusal::NotHeard(_) | Refusal::PageSilent => HelpTopic::NoAnswer,
        Refusal::OtherLoop { .. }
        | Refusal::SpeedUnknown(_)
        | Refusal::TooFast(_)
        | Refusal::Switching(_) => HelpTopic::StaysInLoop,
        Refusal::FaultActive { .. } => HelpTopic::Faults,
        Refusal::AboveSpeedLimit(_) | Refusal::TooHot { .. } => HelpTopic::StoppedByItself,
        Refusal::NotProvedAlone => HelpTopic::TwoMotorsOneId,
        // These say all there is to say.
        _ => return None,
    })
}

/// Where the help says more about a setpoint that was taken back.
pub(crate) const fn of_withdrawal(reason: WithdrawReason) -> HelpTopic {
    match reason {
        WithdrawReason::Silent => HelpTopic::NoAnswer,
        WithdrawReason::Fault(_) => HelpTopic::Faults,
        WithdrawReason::OtherLoop { .. } | WithdrawReason::Limit(_) => HelpTopic::StoppedByItself,
    }
}

/// Where the help says more about what is wrong with the line.
pub(crate) const fn of_diagnosis(diagnosis: Diagnosis) -> HelpTopic {
    match diagnosis {
        Diagnosis::Nothing | Diagnosis::EchoOnly | Diagnosis::Silent(_) => HelpTopic::NoAnswer,
        Diagnosis::SharedId(_) => HelpTopic::TwoMotorsOneId,
        Diagnosis::NoiseGrowsWithSpeed | Diagnosis::Lossy => HelpTopic::DamagedBytes,
        Diagnosis::Stranger => HelpTopic::StrangerAnswers,
        Diagnosis::LatencyTimer => HelpTopic::AdapterSlow,
    }
}
