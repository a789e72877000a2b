//! The places in the help that the page links to.

use motorlink_i18n::tr;
use motorlink_messages::bus::{Refusal, WithdrawReason};
use strum::{IntoStaticStr, VariantArray};

/// A place in the help. Each is an `id` in every language's file, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case", const_into_str)]
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
    /// Its `id` in the files.
    pub(crate) const fn id(self) -> &'static str {
        self.into_str()
    }

    pub(crate) fn from_id(id: &str) -> Option<Self> {
        let mut all = Self::VARIANTS.iter().copied();
        all.find(|topic| topic.id() == id)
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
