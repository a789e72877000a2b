//! A new version of the page: announced, and taken when the person says so, never while a port is open.

use leptos::prelude::*;
use motorlink_messages::Connection;

use crate::{
    features::install::{call, new_version_texts as words},
    model::{desk::Desk, notice_board::Topic},
    ui::reactive::{follow, memo},
};

/// Whether a port is open, being opened, or waited for.
pub(crate) fn is_in_use(connection: Connection) -> bool {
    match connection {
        Connection::Disconnected | Connection::Failed(_) => false,
        Connection::Connecting | Connection::Connected(_) | Connection::Reconnecting(_) => true,
    }
}

impl Desk {
    /// Offers a version that waits whenever no port is open.
    pub(crate) fn watch_versions(self) {
        let open = memo(move || self.shown.with(|session| is_in_use(session.connection)));
        follow(move || {
            if !self.installing.new_version.get() {
                return;
            }
            let open = open.get();
            self.notices.update(|board| {
                if open {
                    board.withdraw(Topic::NewVersion);
                } else {
                    board.post(words::is_ready());
                }
            });
        });
    }

    /// Loads the page anew when it was taken: not under a port that was opened meanwhile, but when that is
    /// closed.
    pub(crate) fn reload_when_taken(self) {
        let open = memo(move || self.shown.with(|session| is_in_use(session.connection)));
        follow(move || {
            if self.installing.taken.get() && !open.get() {
                let _ = document().location().map(|location| location.reload());
            }
        });
    }

    /// Takes it, which loads the page anew.
    pub(crate) fn take_new_version(self) {
        // A port may have been opened since the offer was drawn.
        let connection = self.latest.with_value(|session| session.connection);
        if is_in_use(connection) {
            self.notices
                .update(|board| board.post(words::not_while_open()));
        } else {
            call("takeNewVersion");
        }
    }

    /// Another tab has the page too, which may drive.
    pub(crate) fn refuse_new_version_beside_others(self) {
        self.notices
            .update(|board| board.post(words::not_beside_others()));
    }
}
