//! The records of a session.

use std::time::Duration;

use motorlink_bus::{LineEvent, LineEventKind, StopOutcome};
use motorlink_messages::Update;
use motorlink_protocol::Instant;
use strum::{EnumString, IntoStaticStr, VariantArray};

/// A line that is open has a record in a shorter time. If none came for so long, the page was closed, or its worker
/// stood still.
pub(crate) const STATE_HOLDS: Duration = Duration::from_secs(5);

/// A motor that has not answered for so long is silent.
pub(crate) const SILENT_AFTER: Duration = Duration::from_secs(2);

/// One event of a session.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Time on the monotonic clock of the session.
    pub at: Instant,
    /// Nanoseconds since 1970, UTC.
    pub utc_ns: u64,
    /// What happened.
    pub what: What,
}

/// What happened.
#[derive(Clone, Debug, PartialEq)]
pub enum What {
    /// An event of the bus, as in the packet log.
    Line(LineEventKind),
    /// An event between frames.
    Event(Event),
    /// What the page showed from now on.
    State(Box<Update>),
}

impl Record {
    /// The event of the bus, if it is one.
    #[must_use]
    pub const fn line(&self) -> Option<LineEvent> {
        match self.what {
            What::Line(kind) => Some(LineEvent { at: self.at, kind }),
            What::Event(_) | What::State(_) => None,
        }
    }
}

/// An event between frames.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Event {
    /// Kind of the event.
    pub kind: EventKind,
    /// Whether it is an error.
    pub error: bool,
    /// Its text, in English.
    pub text: String,
    /// For a stop: what each motor confirmed.
    pub motors: Vec<StopOutcome>,
}

/// Kinds of events.
#[derive(
    Clone,
    Copy,
    Debug,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    EnumString,
    IntoStaticStr,
    VariantArray,
)]
#[strum(serialize_all = "snake_case")]
pub enum EventKind {
    /// A port was opened.
    Connected,
    /// A port was closed or lost.
    Disconnected,
    /// A stop began.
    StopBegan,
    /// A stop ended.
    StopEnded,
    /// A limit stopped a motor.
    Limit,
    /// The faults of a motor changed. The writer derives these from replies.
    Fault,
    /// An automatic run began or ended.
    Run,
    /// A note by the user.
    Bookmark,
    /// Any other notice or line of the packet log.
    Notice,
}

impl EventKind {
    /// Its name in the file.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// The kind of this name. An unknown kind of a later version becomes a notice.
    #[must_use]
    pub fn from_name(name: &str) -> Self {
        name.parse().unwrap_or(Self::Notice)
    }
}

impl Event {
    /// An event without outcomes.
    #[must_use]
    pub fn new(kind: EventKind, text: impl Into<String>) -> Self {
        Self {
            kind,
            error: false,
            text: text.into(),
            motors: Vec::new(),
        }
    }

    /// The same event as an error.
    #[must_use]
    pub fn bad(self) -> Self {
        Self {
            error: true,
            ..self
        }
    }
}
