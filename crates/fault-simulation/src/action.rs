//! Actions of a scenario: commands, faults and time.

use std::time::Duration;

use motorlink_bus::Command;
use motorlink_protocol::MotorId;
use motorlink_simulator::{Beside, Echo, Split, WhenSilent, WireFaults};

/// One action, carried out at once.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// A command of the operator. A refusal is a valid result.
    Command(Command),
    /// Time passes.
    Pause(Duration),
    /// Sets a line fault, or a healthy line.
    Line(LineFault),
    /// Switches the supply of a motor.
    Power {
        /// Which motor.
        id: MotorId,
        /// Whether it has supply.
        on: bool,
    },
    /// Loads a wheel; 0 releases it.
    Load {
        /// Which motor.
        id: MotorId,
        /// Load in tenths of a N.m.
        tenths_nm: u8,
    },
    /// Sets the temperature of a motor, up to its own protection.
    Heat {
        /// Which motor.
        id: MotorId,
        /// Degrees Celsius.
        celsius: u8,
    },
    /// Whether the page hangs: a hung page answers no ping.
    PageHangs(bool),
    /// The page is closed, reloaded or frozen. It sends a last stop.
    PageClosed,
    /// The adapter is pulled out.
    Unplug,
    /// The adapter is plugged in again: a new bus that knows only what was left driven.
    Replug,
    /// The page crashes, and its worker with it, without a stop. After this time a new page connects.
    PageCrashes {
        /// Time without a bus.
        back_after: Duration,
    },
    /// The worker dies without a stop. After this time the page has started another one.
    WorkerDies {
        /// Time without a bus.
        back_after: Duration,
    },
    /// The adapter is plugged into another computer, after the page here has crashed: a page that knows of nothing that
    /// was driven.
    AnotherComputer {
        /// Time without a bus.
        back_after: Duration,
    },
    /// A cable is loose: for this time nothing passes the line. The port stays open, and the motors keep their supply.
    LineDies {
        /// How long.
        lasts: Duration,
    },
    /// The worker does not run for a while; the motors do.
    WorkerAbsent {
        /// The cause.
        cause: Absence,
        /// The duration.
        duration: Duration,
        /// Inputs that it finds at the end, processed in this order at one moment.
        pending: Vec<PendingInput>,
    },
    /// The port refuses the next frames and reports it.
    PortRefuses {
        /// Number of frames.
        frames: u8,
    },
    /// The port truncates the next frames.
    PortTruncates {
        /// Number of frames.
        frames: u8,
        /// Bytes of each that reach the wire, 1-9.
        bytes: u8,
        /// Whether the port reports it.
        reported: bool,
    },
    /// Arms and starts a random sequence, unless one is running.
    RunSequence {
        /// The sequence follows from it.
        seed: u64,
    },
}

/// Why the worker does not run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Absence {
    /// The machine sleeps, for seconds to minutes.
    Sleep,
    /// The machine is busy, for up to half a minute.
    Delay,
}

/// An input that waits for the worker after an absence.
#[derive(Clone, Debug, PartialEq)]
pub enum PendingInput {
    /// The page has answered a ping.
    Pong,
    /// All bytes that were received meanwhile, as one chunk.
    Bytes,
    /// A timer is due.
    Poll,
    /// A command of the operator.
    Command {
        /// The command.
        command: Command,
        /// Its age; never older than the absence.
        age: Duration,
    },
}

/// Faults of the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LineFault {
    /// None.
    None,
    /// 15 % of replies are lost.
    LosesReplies,
    /// 5 % of requests are lost.
    LosesRequests,
    /// 15 % of replies have a wrong bit.
    CorruptsReplies,
    /// 5 % of requests have a wrong bit.
    CorruptsRequests,
    /// The adapter receives its own bytes.
    Echoes,
    /// The adapter receives this many bytes at the front of its own frames.
    CutsEchoes(u8),
    /// Replies arrive in pieces.
    Splits,
    /// The adapter holds received bytes for 16 ms.
    Holds,
    /// The adapter or the machine stalls and delivers received bytes 120 ms later.
    Stalls,
    /// Noise beside 10 % of the replies.
    Strays,
    /// A motor of another host replies too.
    Stranger,
    /// 45 % of replies and 10 % of requests are lost.
    LosesMuch,
    /// Simultaneous replies become a good frame that no motor sent.
    Mixes,
    /// The adapter delivers received bytes this many milliseconds later, several frames in one
    /// chunk.
    Gathers(u8),
    /// The adapter receives at random nothing, all, the first or the last bytes of each of its own frames.
    EchoesParts,
    /// This byte comes before every reply.
    ByteBefore(u8),
    /// This byte comes after every reply.
    ByteAfter(u8),
    /// The adapter delivers received bytes only in blocks of 32.
    Blocks,
    /// Nothing holds the pair at a level: a byte 00 comes every 2 to 19 ms.
    Floats,
}

impl LineFault {
    /// The faults of the virtual wire.
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
            Self::EchoesParts => WireFaults {
                echo: Echo::Parts,
                ..good
            },
            Self::ByteBefore(byte) => WireFaults {
                beside: Some(Beside::Before(byte)),
                ..good
            },
            Self::ByteAfter(byte) => WireFaults {
                beside: Some(Beside::After(byte)),
                ..good
            },
            Self::Blocks => WireFaults { block: 32, ..good },
            Self::Floats => WireFaults {
                floating: true,
                ..good
            },
        }
    }
}

/// Kinds of fault, for the coverage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    /// A line fault. Truncated echoes of any length are one kind, and so are adapters that gather, and bytes beside
    /// replies.
    Line(LineFault),
    /// A supply was cut.
    PowerCut,
    /// A supply came back.
    PowerBack,
    /// A wheel was loaded.
    Load,
    /// A motor was hot.
    Heat,
    /// The page hung.
    PageHung,
    /// The page was closed.
    PageWent,
    /// The adapter was pulled out.
    Unplugged,
    /// The adapter was plugged in again.
    Replugged,
    /// The page crashed.
    PageCrashed,
    /// The worker died.
    WorkerDied,
    /// The adapter was plugged into another computer.
    AnotherComputer,
    /// Nothing passed the line for a while.
    LineDied,
    /// The worker did not run for a while.
    Away(Absence),
    /// The port refused frames.
    Refused,
    /// The port truncated frames.
    Cut,
    /// A motor needs all five mode switches.
    NeedsFiveSwitches,
    /// A motor reports -0.1 rpm at all times.
    SpeedStuck,
    /// A motor obeys drive frames to 0xC8.
    ObeysAll,
    /// Motors have the firmware `WhenSilent::Keep`.
    KeepsItsCommand,
    /// Motors have the firmware `WhenSilent::CoastAfter`.
    CoastsWhenSilent,
    /// Motors have the firmware `WhenSilent::BrakeAfter`.
    BrakesWhenSilent,
}

impl Fault {
    /// The fault that this firmware counts as.
    #[must_use]
    pub const fn of_firmware(when_silent: WhenSilent) -> Self {
        match when_silent {
            WhenSilent::Keep => Self::KeepsItsCommand,
            WhenSilent::CoastAfter(_) => Self::CoastsWhenSilent,
            WhenSilent::BrakeAfter(_) => Self::BrakesWhenSilent,
        }
    }
}

impl Action {
    /// The fault that this action counts as.
    #[must_use]
    pub const fn fault(&self) -> Option<Fault> {
        match self {
            Self::Line(LineFault::None)
            | Self::Command(_)
            | Self::Pause(_)
            | Self::RunSequence { .. }
            | Self::PageHangs(false) => None,
            Self::Line(LineFault::CutsEchoes(_)) => Some(Fault::Line(LineFault::CutsEchoes(0))),
            Self::Line(LineFault::Gathers(_)) => Some(Fault::Line(LineFault::Gathers(0))),
            Self::Line(LineFault::ByteBefore(_)) => Some(Fault::Line(LineFault::ByteBefore(0))),
            Self::Line(LineFault::ByteAfter(_)) => Some(Fault::Line(LineFault::ByteAfter(0))),
            Self::Line(line) => Some(Fault::Line(*line)),
            Self::Power { on: false, .. } => Some(Fault::PowerCut),
            Self::Power { on: true, .. } => Some(Fault::PowerBack),
            Self::Load { .. } => Some(Fault::Load),
            Self::Heat { .. } => Some(Fault::Heat),
            Self::PageHangs(true) => Some(Fault::PageHung),
            Self::PageClosed => Some(Fault::PageWent),
            Self::Unplug => Some(Fault::Unplugged),
            Self::Replug => Some(Fault::Replugged),
            Self::PageCrashes { .. } => Some(Fault::PageCrashed),
            Self::WorkerDies { .. } => Some(Fault::WorkerDied),
            Self::AnotherComputer { .. } => Some(Fault::AnotherComputer),
            Self::LineDies { .. } => Some(Fault::LineDied),
            Self::WorkerAbsent { cause, .. } => Some(Fault::Away(*cause)),
            Self::PortRefuses { .. } => Some(Fault::Refused),
            Self::PortTruncates { .. } => Some(Fault::Cut),
        }
    }
}
