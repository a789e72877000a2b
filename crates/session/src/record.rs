//! What a session holds, one by one.

use motorlink_bus::{LineEvent, LineEventKind, StopOutcome};
use motorlink_protocol::Instant;

/// One thing that happened.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// On the monotonic clock of the session.
    pub at: Instant,
    /// Nanoseconds since 1970, UTC.
    pub utc_ns: u64,
    /// What happened.
    pub what: What,
}

/// What happened.
#[derive(Clone, Debug, PartialEq)]
pub enum What {
    /// Something on the line, as the packet log has it.
    Line(LineEventKind),
    /// Something between frames.
    Event(Event),
}

impl Record {
    /// The event of the line, where it is one.
    #[must_use]
    pub const fn line(&self) -> Option<LineEvent> {
        match self.what {
            What::Line(kind) => Some(LineEvent { at: self.at, kind }),
            What::Event(_) => None,
        }
    }
}

/// Something that happened between frames.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Event {
    /// Of what kind.
    pub kind: EventKind,
    /// Whether it is bad news.
    pub error: bool,
    /// In words, in English.
    pub text: String,
    /// Of a stop: what each motor confirmed.
    pub motors: Vec<StopOutcome>,
}

/// Kinds of events.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
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
    /// A person's note.
    Bookmark,
    /// Any other notice or line of the packet log.
    Notice,
}

impl EventKind {
    /// Every kind.
    pub const ALL: [Self; 9] = [
        Self::Connected,
        Self::Disconnected,
        Self::StopBegan,
        Self::StopEnded,
        Self::Limit,
        Self::Fault,
        Self::Run,
        Self::Bookmark,
        Self::Notice,
    ];

    /// Its name in the file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Connected => "connected",
            Self::Disconnected => "disconnected",
            Self::StopBegan => "stop_began",
            Self::StopEnded => "stop_ended",
            Self::Limit => "limit",
            Self::Fault => "fault",
            Self::Run => "run",
            Self::Bookmark => "bookmark",
            Self::Notice => "notice",
        }
    }

    /// The kind of this name. One that a later version has is a notice.
    #[must_use]
    pub fn from_name(name: &str) -> Self {
        let named = Self::ALL.into_iter().find(|kind| kind.name() == name);
        named.unwrap_or(Self::Notice)
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

    /// The same, as bad news.
    #[must_use]
    pub fn bad(self) -> Self {
        Self {
            error: true,
            ..self
        }
    }
}
