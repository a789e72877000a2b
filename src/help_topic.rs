//! What the help speaks of: every place in it that something on the page leads to.

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

    /// As the files of the help have it.
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
}

#[cfg(test)]
#[path = "help_topic_tests.rs"]
mod tests;
