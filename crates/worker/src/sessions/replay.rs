//! A replay: its player, and what it waits for.

use std::rc::Rc;

use motorlink_protocol::Instant;
use motorlink_session::{Player, Todo};

use super::open_session::OpenSession;
use crate::turn_scheduler::TurnScheduler;

/// A replay of an open session.
pub(super) struct Replay {
    pub(super) open: Rc<OpenSession>,
    pub(super) player: Player,
    pub(super) scheduler: TurnScheduler,
    /// Whether bytes of the file are being read.
    pub(super) is_reading: bool,
}

impl Replay {
    pub(super) fn poll(&mut self, now: Instant) -> Todo {
        self.player.poll(&self.open.session, now)
    }
}
