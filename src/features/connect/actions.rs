//! From a press of Connect to a message that names ports.

use leptos::{prelude::*, task::spawn_local};
use motorlink_messages::{PortRef, ToWorker};

use crate::{
    link::serial_ports::{self, PickTrouble},
    model::{
        desk::Desk,
        notice_board::{Remedy, Topic},
        notice_texts as words,
        tab::Tab,
    },
};

impl Desk {
    /// Opens the ports that were permitted before, and the picker where there is none.
    pub(crate) fn connect(self) {
        let last = self.preferences.with_untracked(|chosen| chosen.adapter);
        spawn_local(async move {
            match serial_ports::permitted(last).await {
                Ok(ports) if ports.is_empty() => self.pick_and_open(true).await,
                Ok(ports) => self.open(ports),
                Err(trouble) => self.could_not_pick(trouble),
            }
        });
    }

    /// Opens the picker, whatever was permitted before.
    pub(crate) fn choose_port(self, filtered: bool) {
        spawn_local(self.pick_and_open(filtered));
    }

    pub(crate) fn connect_virtual(self) {
        self.ask_to_connect(ToWorker::ConnectVirtual);
    }

    pub(crate) fn disconnect(self) {
        self.post(&ToWorker::Disconnect);
    }

    pub(crate) fn remedy(self, remedy: Remedy) {
        match remedy {
            Remedy::ShowAllPorts => self.choose_port(false),
            Remedy::FullScan => {
                self.open_tab(Tab::IdManager);
                self.full_scan();
            }
            Remedy::TakeNewVersion => self.take_new_version(),
            Remedy::Install => self.install(),
            Remedy::Reload => {
                if let Some(window) = web_sys::window() {
                    // A page that cannot be reloaded stays as it is; there is nobody else to tell.
                    let _ = window.location().reload();
                }
            }
        }
    }

    async fn pick_and_open(self, filtered: bool) {
        match serial_ports::pick(filtered).await {
            Ok(port) => self.open(vec![port]),
            Err(trouble) => self.could_not_pick(trouble),
        }
    }

    fn open(self, candidates: Vec<PortRef>) {
        self.notices.update(|board| board.withdraw(Topic::Port));
        let wanted = self.selected.get_untracked();
        self.ask_to_connect(ToWorker::ConnectSerial { candidates, wanted });
    }

    /// The header can be used before the worker is there, which then begins with what was asked for last.
    fn ask_to_connect(self, to: ToWorker) {
        if self.link.with_value(Option::is_some) {
            self.post(&to);
        } else {
            self.connect_early.set_value(Some(to));
        }
    }

    pub(crate) fn connect_if_asked_early(self) {
        if let Some(to) = self.connect_early.try_update_value(Option::take).flatten() {
            self.post(&to);
        }
    }

    fn could_not_pick(self, trouble: PickTrouble) {
        self.say(words::of_pick_trouble(trouble));
    }
}
