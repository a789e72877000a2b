//! The places in the help that the page links to.

use motorlink_i18n::tr;
use motorlink_messages::bus::{Refusal, WithdrawReason};

/// A place in the help. Each is an `id` in every language's file, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum HelpTopic {
    Wiring,
    Pinout,
    FirstSpin,
    Specifications,
    Protocol,
    Faults,
    Ports,
    Keys,
    Troubleshooting,
    NoPortInList,
    PortDoesNotOpen,
    NoAnswer,
    WrongWay,
    StaysInLoop,
    DamagedBytes,
    TwoMotorsOneId,
    StrangerAnswers,
    AdapterSlow,
    StoppedByItself,
    StopNotConfirmed,
    TemperatureUnknown,
    Install,
}

impl HelpTopic {
    pub(crate) const ALL: [Self; 22] = [
        Self::Wiring,
        Self::Pinout,
        Self::FirstSpin,
        Self::Specifications,
        Self::Protocol,
        Self::Faults,
        Self::Ports,
        Self::Keys,
        Self::Troubleshooting,
        Self::NoPortInList,
        Self::PortDoesNotOpen,
        Self::NoAnswer,
        Self::WrongWay,
        Self::StaysInLoop,
        Self::DamagedBytes,
        Self::TwoMotorsOneId,
        Self::StrangerAnswers,
        Self::AdapterSlow,
        Self::StoppedByItself,
        Self::StopNotConfirmed,
        Self::TemperatureUnknown,
        Self::Install,
    ];

    /// Its `id` in the files.
    pub(crate) const fn id(self) -> &'static str {
        match self {
            Self::Wiring => "wiring",
            Self::Pinout => "pinout",
            Self::FirstSpin => "first-spin",
            Self::Specifications => "specifications",
            Self::Protocol => "protocol",
            Self::Faults => "faults",
            Self::Ports => "ports",
            Self::Keys => "keys",
            Self::Troubleshooting => "troubleshooting",
            Self::NoPortInList => "no-port-in-list",
            Self::PortDoesNotOpen => "port-does-not-open",
            Self::NoAnswer => "no-answer",
            Self::WrongWay => "wrong-way",
            Self::StaysInLoop => "stays-in-loop",
            Self::DamagedBytes => "damaged-bytes",
            Self::TwoMotorsOneId => "two-motors-one-id",
            Self::StrangerAnswers => "stranger-answers",
            Self::AdapterSlow => "adapter-slow",
            Self::StoppedByItself => "stopped-by-itself",
            Self::StopNotConfirmed => "stop-not-confirmed",
            Self::TemperatureUnknown => "temperature-unknown",
            Self::Install => "install",
        }
    }

    pub(crate) fn from_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|topic| topic.id() == id)
    }

    /// The label of a button that opens this place.
    pub(crate) fn link(self) -> String {
        tr!("Help: {topic}", topic = self.title())
    }

    fn title(self) -> &'static str {
        match self {
            Self::Wiring => tr!("wiring"),
            Self::Pinout => tr!("pinout"),
            Self::FirstSpin => tr!("first spin"),
            Self::Specifications => tr!("specifications"),
            Self::Protocol => tr!("protocol"),
            Self::Faults => tr!("faults"),
            Self::Ports => tr!("ports and drivers"),
            Self::Keys => tr!("shortcuts"),
            Self::Troubleshooting => tr!("troubleshooting"),
            Self::NoPortInList => tr!("no port in the list"),
            Self::PortDoesNotOpen => tr!("the port does not open"),
            Self::NoAnswer => tr!("no reply"),
            Self::WrongWay => tr!("wrong direction"),
            Self::StaysInLoop => tr!("loop does not switch"),
            Self::DamagedBytes => tr!("corrupted bytes"),
            Self::TwoMotorsOneId => tr!("two motors, one ID"),
            Self::StrangerAnswers => tr!("foreign frames"),
            Self::AdapterSlow => tr!("slow adapter"),
            Self::StoppedByItself => tr!("stopped by itself"),
            Self::StopNotConfirmed => tr!("stop not confirmed"),
            Self::TemperatureUnknown => tr!("no temperature"),
            Self::Install => tr!("install"),
        }
    }

    /// The place in the help about a refused command.
    pub(crate) const fn of_refusal(refusal: Refusal) -> Option<Self> {
        Some(match refusal {
            Refusal::NotAnswering(_) | Refusal::PageSilent => Self::NoAnswer,
            Refusal::OtherLoop { .. }
            | Refusal::SpeedUnknown(_)
            | Refusal::TooFast(_)
            | Refusal::Switching(_) => Self::StaysInLoop,
            Refusal::FaultActive { .. } => Self::Faults,
            Refusal::AboveSpeedLimit(_) | Refusal::TooHot { .. } => Self::StoppedByItself,
            Refusal::NotProvedAlone => Self::TwoMotorsOneId,
            // Their texts need no more explanation.
            _ => return None,
        })
    }

    /// The place in the help about a withdrawn setpoint.
    pub(crate) const fn of_withdrawal(reason: WithdrawReason) -> Self {
        match reason {
            WithdrawReason::Silent => Self::NoAnswer,
            WithdrawReason::Fault(_) => Self::Faults,
            WithdrawReason::OtherLoop { .. }
            | WithdrawReason::NotEnabled
            | WithdrawReason::TemperatureUnknown
            | WithdrawReason::AngleMisfits
            | WithdrawReason::Limit(_) => Self::StoppedByItself,
        }
    }
}
