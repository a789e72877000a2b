//! The binary messages, decoded.

use motorlink_protocol::{MotorId, family::Model};

/// The version of the messages. Another one is refused.
pub const VERSION: u16 = 1;
/// How both sides begin. No text begins so.
pub const MAGIC: [u8; 4] = *b"\x89MLS";
/// The size of the first message in each direction.
pub const HELLO: usize = 8;
/// The size of every later message of a client.
pub const FROM_CLIENT: usize = 56;
/// The size of every later message of the server.
pub const FROM_SERVER: usize = 416;
/// Motors in a message.
pub const MOTORS_MAX: usize = 8;

/// Enums whose values stand in a message as numbers.
macro_rules! numbered {
    (
        $(#[$about:meta])*
        pub enum $name:ident {
            $($(#[$of_value:meta])* $value:ident = $number:literal,)*
        }
    ) => {
        $(#[$about])*
        pub enum $name {
            $($(#[$of_value])* $value = $number,)*
        }

        impl $name {
            /// That of this number; `None` if there is none.
            #[must_use]
            pub const fn of_number(number: u8) -> Option<Self> {
                match number {
                    $($number => Some(Self::$value),)*
                    _ => None,
                }
            }
        }
    };
}

/// Motors, each with a speed in rad/s.
#[derive(Clone, Debug, PartialEq)]
pub struct Setpoints {
    /// Chosen by the client: the state repeats that of its newest ARM.
    pub number: u32,
    /// The newest challenge that the client has read.
    pub challenge: u64,
    /// Each motor once. A speed is as it came: any number, or none.
    pub speeds: Vec<(MotorId, f32)>,
}

/// A message of a client.
#[derive(Clone, Debug, PartialEq)]
pub enum FromClient {
    /// Asks for control, and starts these motors at 0 rpm.
    Arm(Setpoints),
    /// Moves the motors of ARM, and renews the lease.
    Setpoints(Setpoints),
    /// Stops the motors and gives up control.
    Disarm,
}

/// Why a connection is closed. The numbers are those of an error message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
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

impl Refusal {
    /// Its number.
    #[must_use]
    pub const fn code(self) -> u8 {
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

impl std::fmt::Display for Refusal {
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

numbered! {
    /// What becomes of the drive of a client. The numbers are those of the state.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum DriveState {
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
}

numbered! {
    /// Why the drive of a client has ended. The numbers are those of the state.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum EndReason {
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
}

numbered! {
    /// Why an ARM has no effect. The numbers are those of the state; 0 is an ARM that was done.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum NotArmed {
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
}

numbered! {
    /// What the server does with a motor. The numbers are those of the state.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Activity {
        /// Nothing drives it.
        #[default]
        Idle = 0,
        /// It is driven.
        Driven = 1,
        /// It is being stopped.
        Stopping = 2,
        /// It is switched to another loop.
        Switching = 3,
        /// It is driven by a raw frame.
        DrivenRaw = 4,
    }
}

numbered! {
    /// Who has control, for one client. The numbers are those of the state.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Holder {
        #[default]
        /// Nobody.
        Nobody = 0,
        /// A page.
        Page = 1,
        /// Another client of the socket.
        OtherClient = 2,
        /// This client.
        You = 3,
    }
}

/// A state, ready to be sent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// All motors are stopped until an ARM that is done, or Release on a page.
    pub is_halted: bool,
    /// The port is open.
    pub is_open: bool,
    /// What becomes of the drive of this client.
    pub drive: DriveState,
    /// Why it has ended.
    pub ended: EndReason,
    /// The number of the client's newest ARM, and what became of it.
    pub arm: (u32, Option<NotArmed>),
    /// The newest challenge.
    pub challenge: u64,
    /// The monotonic clock of the computer, in microseconds.
    pub sent_us: u64,
    /// Who has control, and the number of that page or client.
    pub holder: (Holder, u32),
    /// The model of the motors, once their replies have shown it.
    pub model: Option<Model>,
    /// The motors of the newest ARM first.
    pub motors: Vec<Motor>,
}

/// What is known of a motor at the moment of sending. Ages are in microseconds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motor {
    /// 1 to 254; 0 where there is none.
    pub id: u8,
    /// What the server does with it.
    pub activity: Activity,
    /// It has not replied for 2 s.
    pub is_silent: bool,
    /// It was driven, and has not confirmed since that it stands.
    pub may_turn: bool,
    /// It turns, or draws current, though nothing here drives it.
    pub turns_unasked: bool,
    /// As the model reports them; `None` if they are not known.
    pub faults: Option<u8>,
    /// The age of the newest reply.
    pub reply_age: Option<u32>,
    /// In rad, with its age.
    pub position: Option<(f64, u32)>,
    /// In rad/s.
    pub velocity: Option<(f32, u32)>,
    /// In A.
    pub current: Option<(f32, u32)>,
    /// In degrees Celsius.
    pub temperature: Option<(f32, u32)>,
}

/// A message of the server.
#[derive(Clone, Debug, PartialEq)]
pub enum FromServer {
    /// The state.
    State(State),
    /// The last message: why the server closes the connection.
    Closes(String),
}

impl std::fmt::Display for EndReason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::None => "it has not ended",
            Self::Disarmed => "disarmed",
            Self::LeaseEnded => "the lease has ended: no answer for 100 ms",
            Self::Taken => "a page has taken control",
            Self::Stopped => "a person has stopped the motors",
            Self::ServerStopped => "motorlink has stopped the motors: its log says why",
            Self::Fault => "a motor reports a fault",
            Self::Silent => "a motor does not reply",
            Self::Limit => "a motor has exceeded a limit",
            Self::OtherWithdrawal => {
                "a motor is in another loop or not enabled, or its temperature is unknown"
            }
            Self::NotStarted => "the motors were not started: the log of motorlink says why",
            Self::NotFinite => "a setpoint is no finite number",
            Self::OtherMotors => "setpoints for other motors than those of ARM",
            Self::PortLost => "the port is gone",
        })
    }
}

impl std::fmt::Display for NotArmed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::PageHasControl => "a page has control",
            Self::OtherHasControl => "another client has control",
            Self::Late => "the challenge is too old, or from before a stop",
            Self::NotZero => "a speed is not zero",
            Self::StillDriven => "the motors are driven already",
            Self::StoppedByPerson => {
                "a person has stopped the motors, and nobody has released them"
            }
        })
    }
}
