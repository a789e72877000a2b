//! What the driver tells the program that opened it.

use motorlink_bus::{CommandKind, Event, JobStatus, LineStatus, MotorStatus, RawStatus, Refusal};
use motorlink_messages::runs::FromRun;
use motorlink_protocol::{Instant, MotorId};

/// What happened, in order.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// An event of the bus. [`Event::PingPage`] is answered by taking the entry and is not among them.
    Event(Event),
    /// The bus refuses a command.
    Refused {
        /// Which kind of command.
        command: CommandKind,
        /// Why.
        refusal: Refusal,
    },
    /// The command is over half a second old, and may move a wheel: it was dropped.
    TooLate(CommandKind),
    /// The command needs a port, and the port is lost.
    NotConnected(CommandKind),
    /// The port is gone. The driver waits for it.
    PortLost {
        /// The motors that may turn on.
        driven: Vec<MotorId>,
    },
    /// The port is open again. What was driven is being stopped.
    PortBack,
    /// What the run of an experiment says.
    Run(Box<FromRun>),
    /// What is driven cannot be written to its file: if this process is killed, the next one does not know that these
    /// motors turn.
    NotRemembered,
}

/// The state of the line at one moment.
#[derive(Clone, Debug)]
pub struct Status {
    /// The moment, by the clock of the driver.
    pub now: Instant,
    /// Whether the port is open.
    pub is_open: bool,
    /// Whether Stop all motors is in force.
    pub is_halted: bool,
    /// How many stops have begun, for any reason.
    pub stops_begun: u64,
    /// Every watched motor.
    pub motors: Vec<MotorStatus>,
    /// The scan or ID change that runs.
    pub job: Option<JobStatus>,
    /// The raw frame that is being sent, or the last one.
    pub raw: Option<RawStatus>,
    /// The use of the line; `None` while the port is lost.
    pub line: Option<LineStatus>,
}

impl Status {
    /// This motor, if it is watched.
    #[must_use]
    pub fn motor(&self, id: MotorId) -> Option<&MotorStatus> {
        self.motors.iter().find(|motor| motor.id == id)
    }
}
