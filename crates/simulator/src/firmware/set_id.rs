//! When a set-ID frame takes effect.

use motorlink_protocol::AssignableId;

/// Five in a row for the same ID, once per power cycle.
#[derive(Clone, Debug)]
pub(crate) enum SetIdCount {
    /// This many have come in a row.
    Open {
        /// Frames that it takes.
        needed: u8,
        /// The ID and how often.
        row: Option<(AssignableId, u8)>,
    },
    /// Done in this power cycle.
    Spent,
}

impl SetIdCount {
    pub(crate) const fn new(needed: u8) -> Self {
        Self::Open { needed, row: None }
    }

    /// The ID to store, if this frame completes the row.
    pub(crate) fn count(&mut self, id: AssignableId) -> Option<AssignableId> {
        let Self::Open { needed, row } = self else {
            return None;
        };
        let received = match *row {
            Some((same, received)) if same == id => received.saturating_add(1),
            _ => 1,
        };
        if received >= *needed {
            *self = Self::Spent;
            return Some(id);
        }
        *row = Some((id, received));
        None
    }

    /// Another frame came in between.
    pub(crate) const fn interrupt(&mut self) {
        if let Self::Open { row, .. } = self {
            *row = None;
        }
    }
}
