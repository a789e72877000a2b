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
    /// The worker does nothing for a while, and the motors live on.
    Away {
        /// Why.
        because: Absence,
        /// How long.
        lasts: Duration,
        /// What it does at its end, in this order, all at one moment.
        then: Vec<Turn>,
    },
    /// The port refuses the next frames, and says so.
    Refuses {
        /// How many.
        frames: u8,
    },
    /// Of the next frames the port sends only the front.
    Cuts {
        /// How many frames.
        frames: u8,
        /// How many bytes of each reach the wire, 1-9.
        bytes: u8,
        /// Whether the port says so.
        told: bool,
    },
}

/// Why a worker does nothing for a while.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Absence {
    /// The machine sleeps, for seconds to minutes.
    Sleep,
    /// The machine is busy, for up to half a minute.
    Delay,
}

/// One of the things that a worker finds to do behind an absence.
#[derive(Clone, Debug, PartialEq)]
pub enum Turn {
    /// The page has answered a ping.
    Pong,
    /// All bytes that were received meanwhile, as one chunk.
    Bytes,
    /// A timer is due.
    Poll,
    /// An act of the operator.
    Command {
        /// What was asked for.
        command: Command,
        /// How long ago; never before the absence.
        age: Duration,
    },
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
    /// 45 % of replies do not come, and 10 % of requests are not heard.
    LosesMuch,
    /// Answers at once become a good frame that nobody sent.
    Mixes,
    /// The adapter hands out what it received so many milliseconds later, several frames in one chunk.
    Gathers(u8),
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
            Self::LosesMuch => WireFaults {
                lose_reply: 0.45,
                lose_request: 0.1,
                ..good
            },
            Self::Mixes => WireFaults {
                mix_answers: 1.0,
                ..good
            },
            Self::Gathers(ms) => WireFaults {
                hold: Duration::from_millis(ms.into()),
                ..good
            },
        }
    }
}

/// The kinds of fault, as they are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    /// The line; cut echoes are one kind, however long, and so are adapters that gather.
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
    /// The worker did nothing for a while.
    Away(Absence),
    /// The port refused frames.
    Refused,
    /// The port sent only the front of frames.
    Cut,
    /// A motor needs all five mode switches.
    NeedsFiveSwitches,
    /// A motor obeys drive frames to 0xC8.
    ObeysAll,
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
            Self::Line(LineFault::Gathers(_)) => Some(Fault::Line(LineFault::Gathers(0))),
            Self::Line(line) => Some(Fault::Line(*line)),
            Self::Power { on: false, .. } => Some(Fault::PowerCut),
            Self::Power { on: true, .. } => Some(Fault::PowerBack),
            Self::Load { .. } => Some(Fault::Load),
            Self::Heat { .. } => Some(Fault::Heat),
            Self::PageHangs(true) => Some(Fault::PageHung),
            Self::PageGoes => Some(Fault::PageWent),
            Self::Unplug => Some(Fault::Unplugged),
            Self::Replug => Some(Fault::Replugged),
            Self::Away { because, .. } => Some(Fault::Away(*because)),
            Self::Refuses { .. } => Some(Fault::Refused),
            Self::Cuts { .. } => Some(Fault::Cut),
        }
    }
}
