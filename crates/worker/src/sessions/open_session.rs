//! A session that is open.

use motorlink_session::{NotASession, Overview, Problems, Session};

use super::source::Source;

/// A session that is open.
#[derive(Debug)]
pub(super) struct OpenSession {
    /// The name of the file.
    pub(super) name: String,
    pub(super) session: Session,
    pub(super) source: Source,
    pub(super) overview: Overview,
    /// What is missing or unreadable.
    pub(super) problems: Problems,
}

/// Why no session is open now, or was not exported.
pub(super) enum NotOpened {
    NotASession(NotASession),
    /// The browser cannot read the file.
    Unreadable,
    /// The browser has no room for what is made of the file.
    NoRoom,
    /// Another file was opened, or the user has cancelled it.
    Ended,
}
