//! What can happen in this world.

use std::time::Duration;

use motorlink_bus::Command;
use motorlink_protocol::MotorId;
use motorlink_simulator::{Echo, Split, WireFaults};

/// One thing that happens, at once.
#[derive(Clone, Debug, PartialEq)]
pub enum Act {
    /// The operator asks for something. A refusal is as good an end as any.
    Command(Command),
    /// Time passes.
    Pause(Duration),
    /// The line becomes bad in one way, or good.
    Line(LineFault),
    /// A motor's supply is cut, or comes back.
    Power {
        /// Which motor.
        id: MotorId,
        /// Whether it has supply.
        on: bool,
    },
    /// Something holds a wheel back; 0 lets it go.
    Load {
        /// Which motor.
        id: MotorId,
        /// How hard, in tenths of a N.m.
        tenths_nm: u8,
    },
    /// A motor gets so hot that it protects itself, or cools down.
    Heat {
        /// Which motor.
        id: MotorId,
        /// Degrees Celsius.
        celsius: u8,
    },
    /// The page does not answer its pings, or answers them again.
    PageHangs(bool),
    /// The page is closed, reloaded or frozen: it says so with its last breath.
    PageGoes,
    /// The adapter is pulled out.
    Unplug,
    /// It is put back: a new bus, on which nothing is known.
    Replug,
}

/// How a line is bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LineFault {
    /// It is not.
    None,
    /// 15 % of replies do not come.
    LosesReplies,
    /// 5 % of requests are not heard.
    LosesRequests,
    /// 15 % of replies have a wrong bit.
    CorruptsReplies,
    /// 5 % of requests have a wrong bit.
    CorruptsRequests,
    /// The adapter hears itself.
    Echoes,
    /// It hears the front of what it sends.
    CutsEchoes(u8),
    /// Replies come in pieces.
    Splits,
    /// The adapter holds what it receives for 16 ms.
    Holds,
    /// Adapter or machine are held up, and hand out what they received 120 ms later.
    Stalls,
    /// Noise stands beside 10 % of the replies.
    Strays,
    /// Another host's motor answers too.
    Stranger,
}

impl LineFault {
    /// The same for the virtual wire.
    #[must_use]
    pub fn faults(self) -> WireFaults {
        let good = WireFaults::default();
        match self {
            Self::None => good,
            Self::LosesReplies => WireFaults {
                lose_reply: 0.15,
                ..good
            },
            Self::LosesRequests => WireFaults {
                lose_request: 0.05,
                ..good
            },
            Self::CorruptsReplies => WireFaults {
                corrupt_reply: 0.15,
                ..good
            },
            Self::CorruptsRequests => WireFaults {
                corrupt_request: 0.05,
                ..good
            },
            Self::Echoes => WireFaults {
                echo: Echo::Whole,
                ..good
            },
            Self::CutsEchoes(bytes) => WireFaults {
                echo: Echo::Cut(bytes.into()),
                ..good
            },
            Self::Splits => WireFaults {
                split: Some(Split::default()),
                ..good
            },
            Self::Holds => WireFaults {
                hold: Duration::from_millis(16),
                ..good
            },
            Self::Stalls => WireFaults {
                hold: Duration::from_millis(120),
                ..good
            },
            Self::Strays => WireFaults { stray: 0.1, ..good },
            Self::Stranger => WireFaults {
                stranger: MotorId::new(99).ok(),
                ..good
            },
        }
    }
}

/// The kinds of fault, as they are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    /// The line; cut echoes are one kind, however long.
    Line(LineFault),
    /// A supply was cut.
    PowerCut,
    /// A supply came back.
    PowerBack,
    /// A wheel was held back.
    Load,
    /// A motor was hot.
    Heat,
    /// The page hung.
    PageHung,
    /// The page went.
    PageWent,
    /// The adapter was pulled out.
    Unplugged,
    /// The adapter was put back.
    Replugged,
}

impl Act {
    /// As which fault it is counted.
    #[must_use]
    pub const fn fault(&self) -> Option<Fault> {
        match self {
            Self::Line(LineFault::None)
            | Self::Command(_)
            | Self::Pause(_)
            | Self::PageHangs(false) => None,
            Self::Line(LineFault::CutsEchoes(_)) => Some(Fault::Line(LineFault::CutsEchoes(0))),
            Self::Line(line) => Some(Fault::Line(*line)),
            Self::Power { on: false, .. } => Some(Fault::PowerCut),
            Self::Power { on: true, .. } => Some(Fault::PowerBack),
            Self::Load { .. } => Some(Fault::Load),
            Self::Heat { .. } => Some(Fault::Heat),
            Self::PageHangs(true) => Some(Fault::PageHung),
            Self::PageGoes => Some(Fault::PageWent),
            Self::Unplug => Some(Fault::Unplugged),
            Self::Replug => Some(Fault::Replugged),
        }
    }
}
