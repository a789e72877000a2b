//! What the ID manager does, for other features that scan or set an ID by it.

use motorlink_messages::{bus::SetIdFrames, protocol::MotorId};

use crate::model::notice_board::NoticeText;

/// How a full scan or an ID change ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// A complete scan without noise, or a verified change: exactly these motors answer, in the order of IDs.
    Scanned {
        /// After a change, the motor with its new ID.
        motors: Vec<MotorId>,
    },
    /// The motor has kept its ID.
    Kept,
    /// Anything else: the message says what.
    Failed,
}

/// The present scan or ID change, or the last one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct IdProgress {
    /// Whether an ID change is requested, asked about or carried out.
    pub(crate) is_changing: bool,
    /// How the last one ended; `None` while one runs, after it was cancelled, and before the first.
    pub(crate) end: Option<End>,
    /// What the tab `ID Manager` says.
    pub(crate) message: NoticeText,
    /// Number of set-ID frames for the next try, if a motor has kept its ID.
    pub(crate) more: Option<SetIdFrames>,
}
