//! Offers a new version of the page; the user activates it, but never while a port is open.

use leptos::prelude::*;

use crate::{
    features::install::{Install, call, new_version_texts},
    model::{guards::is_in_use, notice_board::Topic},
    ui::reactive::{effect, memo},
};

impl Install {
    /// Offers an available version while no port is open.
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

    /// Reloads the page after the activation. If a port was opened meanwhile, waits until it is closed.
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

    /// Activates it, which reloads the page.
    pub(crate) fn take_new_version(self) {
        // A port may have been opened since the offer was shown.
        let connection = self.page.latest.with_value(|session| session.connection);
        if is_in_use(connection) {
            self.page
                .notices
                .update(|board| board.post(new_version_texts::not_while_open()));
        } else {
            call("takeNewVersion");
        }
    }

    /// Another tab with the page is open and may drive.
    pub(crate) fn refuse_new_version_beside_others(self) {
        self.page
            .notices
            .update(|board| board.post(new_version_texts::not_beside_others()));
    }
}
