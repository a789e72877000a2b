//! The state of the saved session.

use motorlink_messages::recorder::SavedSession;

/// The saved session and its state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Offer {
    /// None, or the user has ignored it: then it is offered again at the next visit.
    #[default]
    None,
    /// It can be restored or removed.
    Open(SavedSession),
    /// It is being restored.
    Restoring(SavedSession),
}
