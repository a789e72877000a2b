//! The help in words, as far as they stand outside its files.

use crate::{doctor::Diagnosis, help_topic::HelpTopic};
use motorlink_i18n::tr;
use motorlink_messages::bus::{Refusal, WithdrawReason};

/// The language of the help, by the name of its file in `public/help/`.
pub(crate) fn help_language() -> &'static str {
    motorlink_i18n::spoken().key()
}

pub(crate) fn loading() -> &'static str {
    tr!("The help is being loaded.")
}
pub(crate) fn not_loaded() -> &'static str {
    tr!("The help could not be loaded. Check that you are online, then try again.")
}

/// In the graph, before any motor has answered.
pub(crate) fn no_graph() -> &'static str {
    tr!("What a motor reports is drawn here.")
}
/// Above the wheel, before a motor has answered.
pub(crate) fn no_motor() -> &'static str {
    tr!("No motor: press Connect")
}

/// What a button reads that leads to a place in the help.
pub(crate) fn link(topic: HelpTopic) -> String {
    tr!("Help: {topic}", topic = title(topic))
}

fn title(topic: HelpTopic) -> &'static str {
    match topic {
        HelpTopic::Wiring => tr!("wiring"),
        HelpTopic::Pinout => tr!("plugs"),
        HelpTopic::FirstSpin => tr!("first spin"),
        HelpTopic::Specifications => tr!("specifications"),
        HelpTopic::Protocol => tr!("protocol"),
        HelpTopic::Faults => tr!("protections"),
        HelpTopic::Ports => tr!("ports and drivers"),
        HelpTopic::Keys => tr!("keys"),
        HelpTopic::Troubleshooting => tr!("troubleshooting"),
        HelpTopic::NoPortInList => tr!("no port in the list"),
        HelpTopic::PortDoesNotOpen => tr!("the port does not open"),
        HelpTopic::NoAnswer => tr!("no answer"),
        HelpTopic::WrongWay => tr!("wrong way"),
        HelpTopic::StaysInLoop => tr!("it stays in its loop"),
        HelpTopic::DamagedBytes => tr!("damaged bytes"),
        HelpTopic::TwoMotorsOneId => tr!("two motors, one ID"),
        HelpTopic::StrangerAnswers => tr!("a stranger answers"),
        HelpTopic::AdapterSlow => tr!("slow adapter"),
        HelpTopic::StoppedByItself => tr!("stopped by itself"),
        HelpTopic::StopNotConfirmed => tr!("stop not confirmed"),
        HelpTopic::TemperatureUnknown => tr!("no temperature"),
        HelpTopic::Install => tr!("install"),
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
