//! The state of the port.

use motorlink_bus::IdQueryOutcome;
use motorlink_messages::{Adapter, ConnectError, Connection, ToWorker};
use motorlink_port::Host;
use motorlink_simulator::LineCondition;
use web_sys::ReadableStreamDefaultReader;

use crate::{
    asks_again::AsksAgain, driven_file::DrivenFile, line::Line, line_errors::LineErrors, serial,
};

/// The state of the port.
pub(crate) enum PortState {
    /// No port is open and none is wanted.
    Closed,
    /// The last attempt failed.
    Failed(ConnectError),
    /// A port is being opened.
    Opening {
        /// The adapter that was unplugged, if this is a reconnect.
        lost: Option<Adapter>,
    },
    /// A port is open.
    Open(Box<OpenPort>),
    /// The adapter was unplugged; the worker waits for it.
    Lost(Adapter),
}

impl PortState {
    /// The state as the page shows it.
    pub(crate) fn connection(&self) -> Connection {
        match self {
            Self::Closed => Connection::Disconnected,
            Self::Failed(error) => Connection::Failed(*error),
            Self::Opening { lost } => opening(*lost),
            Self::Lost(adapter) => Connection::Reconnecting(*adapter),
            Self::Open(open) => match open.stage {
                Stage::OnTrial { lost, .. } => opening(lost),
                Stage::Settled | Stage::Closing(_) => {
                    Connection::Connected(open.host.line.adapter())
                }
            },
        }
    }
}

fn opening(lost: Option<Adapter>) -> Connection {
    lost.map_or(Connection::Connecting, Connection::Reconnecting)
}

/// An open port with the bus on it.
pub(crate) struct OpenPort {
    pub(crate) host: Host<Line>,
    pub(crate) stage: Stage,
    /// The reader of the port; closing the port cancels it.
    pub(crate) reader: Option<ReadableStreamDefaultReader>,
    /// When the ID query is repeated, while no motor has answered.
    pub(crate) asks_again: AsksAgain,
    /// Remembers what is driven.
    pub(crate) driven_file: DrivenFile,
    pub(crate) line_errors: LineErrors,
    /// The fault of a virtual line that begins when its motors are stopped.
    pub(crate) next_wire: Option<LineCondition>,
}

/// What to do after a port is closed: open another one, or nothing.
#[derive(Debug, Default)]
pub(crate) struct AfterClosing(pub(crate) Option<ToWorker>);

/// What an open port is used for.
pub(crate) enum Stage {
    /// The wanted motor may be on another adapter of the same model: nothing drives, and the page
    /// gets no events yet.
    OnTrial {
        /// The adapter that was unplugged, if this is a reconnect.
        lost: Option<Adapter>,
        /// The outcome of the ID query, for the page once the port is settled.
        id_query: Option<IdQueryOutcome>,
    },
    /// The page may drive.
    Settled,
    /// The motors are being stopped; then the port is closed.
    Closing(AfterClosing),
}

impl OpenPort {
    pub(crate) fn new(host: Host<Line>, stage: Stage, driven_file: DrivenFile) -> Self {
        Self {
            host,
            stage,
            reader: None,
            asks_again: AsksAgain::default(),
            driven_file,
            line_errors: LineErrors::default(),
            next_wire: None,
        }
    }

    pub(crate) async fn close(self) {
        if let Line::Serial(serial) = self.host.line {
            serial::close(serial, self.reader).await;
        }
    }
}
