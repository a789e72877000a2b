//! A new version of the page: announced, and taken when the person says so, never while a port is open.

use leptos::prelude::*;

use crate::{
    features::install::{Install, call, new_version_texts},
    model::{guards::is_in_use, notice_board::Topic},
    ui::reactive::{effect, memo},
};

impl Install {
    /// Offers a version that waits whenever no port is open.
    pub(crate) fn watch_versions(self) {
        let open = memo(move || {
            self.page
                .shown
                .with(|session| is_in_use(session.connection))
        });
        effect(move || {
            if !self.new_version.get() {
                return;
            }
            let open = open.get();
            self.page.notices.update(|board| {
                if open {
                    board.withdraw(Topic::NewVersion);
                } else {
                    board.post(new_version_texts::is_ready());
                }
            });
        });
    }

    /// Loads the page anew when it was taken: not under a port that was opened meanwhile, but when that is
    /// closed.
    pub(crate) fn reload_when_taken(self) {
        let open = memo(move || {
            self.page
                .shown
                .with(|session| is_in_use(session.connection))
        });
        effect(move || {
            if self.taken.get() && !open.get() {
                let _ = document().location().map(|location| location.reload());
            }
        });
    }

    /// Takes it, which loads the page anew.
    pub(crate) fn take_new_version(self) {
        // A port may have been opened since the offer was drawn.
        let connection = self.page.latest.with_value(|session| session.connection);
        if is_in_use(connection) {
            self.page
                .notices
                .update(|board| board.post(new_version_texts::not_while_open()));
        } else {
            call("takeNewVersion");
        }
    }

    /// Another tab has the page too, which may drive.
    pub(crate) fn refuse_new_version_beside_others(self) {
        self.page
            .notices
            .update(|board| board.post(new_version_texts::not_beside_others()));
    }
}
