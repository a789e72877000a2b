//! The binary messages, decoded. `docs/socket.md` has the tables.

use motorlink_protocol::MotorId;

/// The version of the messages. Another one is refused.
pub(super) const VERSION: u16 = 1;
/// How both sides begin. No text begins so.
pub(super) const MAGIC: [u8; 4] = *b"\x89MLS";
/// The size of the first message in each direction.
pub(super) const HELLO: usize = 8;
/// The size of every later message of a client.
pub(super) const FROM_CLIENT: usize = 56;
/// The size of every later message of the server.
pub(super) const FROM_SERVER: usize = 416;
/// Motors in a message.
pub(super) const MOTORS_MAX: usize = 8;

/// Motors, each with a speed in rad/s.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Order {
    /// Chosen by the client: the state repeats that of its newest ARM.
    pub(crate) number: u32,
    /// The newest challenge that the client has read.
    pub(crate) challenge: u64,
    /// Each motor once. A speed is as it came: any number, or none.
    pub(crate) speeds: Vec<(MotorId, f32)>,
}

/// A message of a client.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum FromClient {
    Arm(Order),
    Setpoints(Order),
    Disarm,
}

/// Why a connection is closed. The numbers are those of an error message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wrong {
    /// The client speaks another version.
    Version(u16),
    /// The first bytes are no hello.
    Magic,
    /// A message of no known kind.
    Kind(u8),
    /// A number of motors beyond 1 to 8, a number that is no ID, or an ID that appears twice.
    Motors,
    /// There are too many clients.
    TooMany,
    /// Too many messages in a second.
    Floods,
    /// No hello in time.
    Silent,
}

impl Wrong {
    pub(super) const fn code(self) -> u8 {
        match self {
            Self::Version(_) => 1,
            Self::Magic => 2,
            Self::Kind(_) => 3,
            Self::Motors => 4,
            Self::TooMany => 5,
            Self::Floods => 6,
            Self::Silent => 7,
        }
    }
}

impl std::fmt::Display for Wrong {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Version(theirs) => write!(
                f,
                "the client speaks version {theirs} of the socket, this motorlink version {VERSION}: use those of the same release"
            ),
            Self::Magic => f.write_str("neither a hello nor a command: write help"),
            Self::Kind(kind) => write!(f, "no message is of kind {kind}"),
            Self::Motors => f.write_str("name 1 to 8 motors, IDs 1 to 254, each once"),
            Self::TooMany => f.write_str("too many clients: close one of them"),
            Self::Floods => f.write_str("more than 2000 messages in a second"),
            Self::Silent => f.write_str("no hello within 5 s"),
        }
    }
}

/// What becomes of the drive of a client. The numbers are those of the state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum DriveState {
    /// It has not armed anything.
    #[default]
    None = 0,
    /// Its motors are stopped or switched to the velocity loop first.
    Starting = 1,
    /// Its motors follow its setpoints.
    Driven = 2,
    /// The drive has ended, and its motors are being stopped.
    Stopping = 3,
    /// They stand, by their replies.
    Stands = 4,
    /// The stop has ended, and not every motor has confirmed that it stands.
    NotConfirmed = 5,
}

/// Why the drive of a client has ended. The numbers are those of the state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum EndReason {
    /// It has not ended.
    #[default]
    None = 0,
    /// By its DISARM.
    Disarmed = 1,
    /// Its lease has ended: no answer to a challenge of the last 100 ms.
    LeaseEnded = 2,
    /// A page has taken control.
    Taken = 3,
    /// A person has stopped the motors.
    Stopped = 4,
    /// The server has stopped the motors for a reason of its own, such as a computer that slept.
    ServerStopped = 5,
    /// A motor reports a fault.
    Fault = 6,
    /// A motor does not reply.
    Silent = 7,
    /// A motor has exceeded a limit.
    Limit = 8,
    /// A motor is in another loop, is not enabled any more, or its temperature is unknown.
    OtherWithdrawal = 9,
    /// The motors were not started: the log of the server says why.
    NotStarted = 10,
    /// A setpoint is no finite number.
    NotFinite = 11,
    /// Setpoints for other motors than those of ARM.
    OtherMotors = 12,
    /// The port is gone.
    PortLost = 13,
}

/// Why an ARM has no effect. The numbers are those of the state; 0 is an ARM that was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NotArmed {
    /// A page has control.
    PageHasControl = 1,
    /// Another client of the socket has control.
    OtherHasControl = 2,
    /// Its challenge is too old, was never made, or is from before a stop.
    Late = 3,
    /// A speed is not zero.
    NotZero = 4,
    /// What this client has armed is still driven: DISARM first.
    StillDriven = 5,
    /// A person has stopped all motors, and nobody has released them since.
    StoppedByPerson = 6,
}

/// Who has control, for one client. The numbers are those of the state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Holder {
    #[default]
    Nobody = 0,
    Page = 1,
    OtherClient = 2,
    You = 3,
}

/// A state, ready to be sent.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct State {
    pub(super) is_halted: bool,
    pub(super) is_open: bool,
    pub(super) drive: DriveState,
    pub(super) ended: EndReason,
    /// The number of the client's newest ARM, and what became of it.
    pub(super) arm: (u32, Option<NotArmed>),
    pub(super) challenge: u64,
    /// The monotonic clock of the computer, in microseconds.
    pub(super) sent_us: u64,
    pub(super) holder: (Holder, u32),
    pub(super) motors: Vec<Motor>,
}

/// What is known of a motor at the moment of sending. Ages are in microseconds.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Motor {
    pub(super) id: u8,
    pub(super) activity: u8,
    pub(super) flags: u8,
    pub(super) faults: u8,
    pub(super) reply_age: Option<u32>,
    /// In rad, with its age.
    pub(super) position: Option<(f64, u32)>,
    /// In rad/s.
    pub(super) velocity: Option<(f32, u32)>,
    /// In A.
    pub(super) current: Option<(f32, u32)>,
    /// In degrees Celsius.
    pub(super) temperature: Option<(f32, u32)>,
}
