//! What crosses between the page and its workers: two enums each, and nothing else.
//!
//! The page sends [`ToWorker`], the worker that owns the port [`ToPage`]; for the worker that keeps the
//! packet log see [`recorder`]. Both cross as one buffer of bytes
//! (`postcard`), so that nothing is shared and the page can build on nothing inside the worker. The
//! vocabulary of motors and commands is that of `motorlink-protocol` and `motorlink-bus`.

use motorlink_bus::{
    Command, CommandKind, IdChangeOutcome, IdQueryOutcome, JobStatus, LeftDriven, LineStatus,
    MotorStatus, RawStatus, Refusal, Sample, ScanReport, StopReason, StopReport, WithdrawReason,
};
use motorlink_protocol::{AssignableId, Instant, Mode, MotorId, family::Model};
use serde::{Deserialize, Serialize, de::DeserializeOwned};

mod adapter;
mod awake_clock;
mod left_behind;
mod outbox;
pub mod recorder;
pub mod remote;
pub mod runs;
pub mod sessions;
pub mod stored_state;
mod virtual_line;

pub use adapter::{Adapter, UsbId};
pub use awake_clock::AwakeClock;
pub use left_behind::{Damaged, LeftBehind, NamedInFile};
pub use motorlink_bus as bus;
pub use motorlink_experiments as experiments;
pub use motorlink_protocol as protocol;
pub use motorlink_simulator::LineCondition;
pub use outbox::Outbox;
pub use virtual_line::{VirtualLine, VirtualMotors};

/// From the page to its worker.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ToWorker {
    /// Open a serial port, and stay at the first of these on which the wanted motor answers.
    ///
    /// Two adapters of one make cannot be told apart but by who answers on them. Where the wanted
    /// motor answers on none, the first that opens is taken.
    ConnectSerial {
        /// The ports to try, best first.
        candidates: Vec<PortRef>,
        /// The motor that the page would like to find.
        wanted: MotorId,
        /// The model of the motors.
        model: ModelChoice,
        /// What the page knows to have been driven over this adapter by a worker that has ended: stopped first.
        left: Vec<LeftDriven>,
    },
    /// Open the built-in virtual line, with these motors on it.
    ConnectVirtual(VirtualLine),
    /// Stop what is driven, then close the port.
    Disconnect,
    /// Ask this motor for telemetry, and those no more that have never answered.
    Select(MotorId),
    /// An operator's act.
    Command {
        /// What to do.
        command: Command,
        /// When the person did it: the event's `timeStamp`, milliseconds of the page's
        /// `performance.now()`. An old act starts no wheel.
        given_ms: f64,
    },
    /// The answer to [`ToPage::Ping`] and [`ToPage::Hello`], to be sent from the handler of that
    /// message.
    Pong {
        /// The page's `performance.now()` in milliseconds. The quickest of these tells the worker how
        /// the two clocks lie, without trust in a wall clock that may jump.
        page_ms: f64,
    },
    /// Make the virtual line ill in one way, or well. Starts no motion; nothing on a real line.
    VirtualWire(LineCondition),
    /// A message to the run of an experiment.
    Run {
        /// A [`ToRun`](runs::ToRun).
        message: Vec<u8>,
        /// When the person did it: see [`ToWorker::Command`]. An old act starts no run.
        given_ms: f64,
    },
}

/// Which model the motors of a line are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModelChoice {
    /// The model to begin with.
    pub model: Model,
    /// Whether the worker takes another model if none answers as this one. A DDSM115 and a DDSM315 cannot be
    /// told apart: it never takes one for the other.
    pub detect: bool,
}

impl Default for ModelChoice {
    fn default() -> Self {
        Self {
            model: Model::Ddsm115,
            detect: true,
        }
    }
}

/// A serial port as the page sees it. Port objects cannot be posted, but `getPorts()` lists them in
/// one order in page and worker at one moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PortRef {
    /// Its place in `getPorts()`.
    pub place: u16,
    /// What it must be, to notice that the order has changed meanwhile.
    pub usb: Option<UsbId>,
}

/// From the worker to its page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(
    clippy::large_enum_variant,
    reason = "there is one at a time, and nearly always the large one"
)]
pub enum ToPage {
    /// The worker runs. Said once, first.
    Hello {
        /// The worker's `performance.timeOrigin` in milliseconds: with it the page can read every
        /// [`Instant`] of the worker on its own clock.
        time_origin_ms: f64,
    },
    /// The worker has failed and does nothing any more: frames cease, and a driven wheel may keep turning.
    Died,
    /// Are you there? Without [`ToWorker::Pong`] for a second the worker stops all motors.
    Ping,
    /// Everything that the page shows. Sent when something has changed, at most once a frame.
    Update(Update),
    /// A [`FromRun`](runs::FromRun).
    Run(Vec<u8>),
}

/// What the worker knows, and what has happened since the last update.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Update {
    /// When this was put together, in microseconds since the worker's time origin.
    pub now: Instant,
    /// The state of the port.
    pub connection: Connection,
    /// Whether Stop all motors stands.
    pub halted: bool,
    /// Every motor that is asked for telemetry.
    pub motors: Vec<MotorStatus>,
    /// The scan or ID change that is under way.
    pub job: Option<JobStatus>,
    /// The last frame of the raw editor since the port was opened.
    pub raw: Option<RawStatus>,
    /// How the line works; `None` while no port is open.
    pub line: Option<LineStatus>,
    /// Every reply since the last update, oldest first.
    pub samples: Vec<Sample>,
    /// What has happened since the last update, oldest first.
    pub notices: Vec<Notice>,
}

impl Update {
    /// A line without motors, of which nothing else is known.
    #[must_use]
    pub const fn without_motors(now: Instant, connection: Connection) -> Self {
        Self {
            now,
            connection,
            halted: false,
            motors: Vec::new(),
            job: None,
            raw: None,
            line: None,
            samples: Vec::new(),
            notices: Vec::new(),
        }
    }
}

/// The state of the port.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Connection {
    /// No port is open and none is wanted.
    Disconnected,
    /// A port is being opened.
    Connecting,
    /// A port is open.
    Connected(Adapter),
    /// The adapter was pulled out and is waited for. Nothing drives when it is back.
    Reconnecting(Adapter),
    /// It could not be opened.
    Failed(ConnectError),
}

impl Connection {
    /// Whether this is the same state of the same line. Whether this page drives the motors of a server or watches them
    /// makes no difference.
    #[must_use]
    pub fn is_same_line(self, other: Self) -> bool {
        let is_remote = |connection| {
            matches!(
                connection,
                Self::Connected(Adapter::Remote | Adapter::Watched)
            )
        };
        self == other || is_remote(self) && is_remote(other)
    }

    /// The virtual line that is open.
    #[must_use]
    pub const fn virtual_line(self) -> Option<VirtualLine> {
        match self {
            Self::Connected(adapter) => adapter.virtual_line(),
            _ => None,
        }
    }
}

/// Why a port could not be opened or kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ConnectError {
    /// The browser has no Web Serial in its workers.
    NoWebSerial,
    /// The port is not there any more, or the list of ports has changed: choose again.
    PortGone,
    /// The browser says "failed to open", which is one and the same for: held by another program or
    /// tab, no permission on the device, device gone.
    OpenFailed,
    /// The port is open already, in this very page.
    AlreadyOpen,
    /// The browser gave another error.
    Other,
    /// Another tab of this page has the adapter, and all others of its make.
    OtherTab,
    /// The browser forbids serial ports to this page.
    Forbidden,
}

/// Something that a person should know of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Notice {
    /// A command was not carried out.
    Refused {
        /// The command.
        command: CommandKind,
        /// Why.
        refusal: Refusal,
    },
    /// A command that could move a wheel came too long after it was given.
    TooLate(CommandKind),
    /// A command needs an open port.
    NotConnected,
    /// Who answered the ID query.
    IdQueryEnded(IdQueryOutcome),
    /// A full scan has ended.
    ScanEnded(ScanReport),
    /// An ID change has ended.
    IdChangeEnded {
        /// The ID that the motor had.
        from: MotorId,
        /// The ID that it was to get.
        to: AssignableId,
        /// How it ended.
        outcome: IdChangeOutcome,
    },
    /// A motor reports the loop that was asked for.
    ModeSwitched {
        /// Which motor.
        id: MotorId,
        /// The loop.
        mode: Mode,
    },
    /// A motor does not report the loop that was asked for.
    ModeSwitchFailed {
        /// Which motor.
        id: MotorId,
        /// The loop that was asked for.
        asked: Mode,
        /// The loop that it reports.
        reported: Option<Mode>,
    },
    /// A setpoint was taken back and its motor is being stopped.
    Withdrawn {
        /// Which motor.
        id: MotorId,
        /// Why.
        reason: WithdrawReason,
    },
    /// Replies show motors of another model; what was driven is being stopped.
    OtherModel {
        /// The model of the line.
        expected: Model,
        /// The model that the replies show.
        found: Model,
    },
    /// Another device than a motor sends text on this port.
    SendsText {
        /// Whether it is JSON, as of a driver board.
        is_json: bool,
    },
    /// A motor has not answered for two seconds.
    MotorSilent {
        /// Which motor.
        id: MotorId,
        /// Whether invalid bytes came in most of its reply windows since.
        garbled: bool,
    },
    /// A silent motor answers again.
    MotorBack(MotorId),
    /// A stop has begun.
    StopBegan(StopReason),
    /// A stop has ended.
    StopEnded(StopReport),
    /// The adapter was pulled out. What was driven may keep turning.
    AdapterLost {
        /// Which motors were driven then.
        driven: Vec<MotorId>,
    },
    /// The adapter is back; nothing drives.
    AdapterBack,
    /// The browser reported an error of the line; the port lives on.
    LineError {
        /// What it reported last.
        error: LineError,
        /// How often such errors came since the port was opened.
        count: u32,
    },
    /// The browser does not keep what is driven: after a crash of the page the motors that were driven are not known.
    NotRemembered,
    /// The connection to the server was too slow: line events and notices before this one were left out.
    Missed,
}

/// An error of the line that the browser reports. The port lives on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum LineError {
    /// The line was low for longer than a byte.
    Break,
    /// A byte without its stop bit.
    Framing,
    /// A byte with a wrong parity bit.
    Parity,
    /// Bytes came faster than the adapter or the browser took them.
    Overrun,
    /// Another one.
    Other,
}

/// The bytes of a message.
///
/// # Errors
/// A message of ours always encodes; the error is that of the encoder.
pub fn encode<T: Serialize>(message: &T) -> Result<Vec<u8>, postcard::Error> {
    postcard::to_allocvec(message)
}

/// The message in these bytes.
///
/// # Errors
/// The bytes are none: page and worker are not of one build.
pub fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, postcard::Error> {
    postcard::from_bytes(bytes)
}

#[cfg(test)]
mod tests {
    use motorlink_bus::{Consent, StopOutcome};
    use motorlink_protocol::{CurrentTarget, Rpm, Setpoint, family::Model};

    use super::*;

    fn round_trip<T: Serialize + DeserializeOwned + PartialEq + std::fmt::Debug>(message: &T) {
        assert_eq!(&decode::<T>(&encode(message).unwrap()).unwrap(), message);
    }

    #[test]
    fn messages_arrive_as_they_were_sent() {
        let id = MotorId::new(7).unwrap();
        let setpoint = Setpoint::Current(CurrentTarget::new(-25_001).unwrap());
        let command = Command::Drive {
            id,
            setpoint,
            consent: Consent::HighCurrent,
        };
        round_trip(&ToWorker::Command {
            command,
            given_ms: 1_234.5,
        });
        round_trip(&ToWorker::ConnectSerial {
            candidates: vec![PortRef {
                place: 1,
                usb: Some(UsbId {
                    vendor: 0x1A86,
                    product: 0x7523,
                }),
            }],
            wanted: id,
            model: ModelChoice::default(),
            left: vec![LeftDriven { id, mode: None }],
        });
        let outcome = StopOutcome {
            id,
            confirmed: false,
            speed: Some(Rpm::new(-3)),
        };
        let report = StopReport {
            reason: StopReason::PageSilent,
            motors: vec![outcome],
        };
        round_trip(&ToPage::Update(Update {
            now: Instant::from_micros(123_456_789),
            connection: Connection::Failed(ConnectError::OpenFailed),
            halted: true,
            motors: vec![],
            job: None,
            raw: None,
            line: None,
            samples: vec![],
            notices: vec![Notice::StopEnded(report)],
        }));
        for wire in LineCondition::ALL {
            round_trip(&ToWorker::VirtualWire(*wire));
        }
        for motors in VirtualMotors::ALL {
            for model in Model::ALL {
                let line = VirtualLine { motors, model };
                round_trip(&ToWorker::ConnectVirtual(line));
                round_trip(&Connection::Connected(Adapter::Virtual(line)));
            }
        }
        round_trip(&ToPage::Hello {
            time_origin_ms: 1.5,
        });
    }

    /// A value outside its range cannot cross, even from a page of another build.
    #[test]
    fn a_setpoint_out_of_range_does_not_arrive() {
        #[derive(Serialize)]
        enum Loose {
            Current(i32),
        }
        assert!(decode::<CurrentTarget>(&encode(&40_000_i32).unwrap()).is_err());
        assert!(decode::<CurrentTarget>(&encode(&32_767_i32).unwrap()).is_ok());
        assert!(decode::<MotorId>(&encode(&0_u8).unwrap()).is_err());
        assert!(decode::<Setpoint>(&encode(&Loose::Current(1)).unwrap()).is_err());
    }
}
