//! What is done with the session that the browser keeps.

use motorlink_messages::recorder::SavedSession;

/// A session that the browser keeps, and what is done with it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Offer {
    /// There is none, or the person has turned away from it: then it is offered again with the next visit.
    #[default]
    None,
    /// It can be restored or forgotten.
    Open(SavedSession),
    /// It is being restored.
    Restoring(SavedSession),
}
