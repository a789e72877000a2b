//! From a press of Connect to the message to the worker.

use leptos::{prelude::*, task::spawn_local};
use motorlink_messages::{PortRef, ToWorker, VirtualLine};

use crate::{
    link::{
        address::{parameter, virtual_line},
        serial_ports::{self, PickTrouble},
    },
    model::{connect_texts, notice_board::Topic, page::Page, preferences::Preferences},
};

/// Opens and closes ports.
#[derive(Clone, Copy)]
pub(crate) struct Connect {
    pub(crate) page: Page,
}

impl Connect {
    /// Opens a permitted port, or the picker if there is none.
    pub(crate) fn connect(self) {
        self.open_permitted(true);
    }

    /// Opens the port again that is open, because another model was chosen.
    pub(crate) fn reconnect(self) {
        self.open_permitted(false);
    }

    fn open_permitted(self, or_pick: bool) {
        let chosen = self.page.preferences;
        let last = chosen.with_untracked(|chosen| chosen.adapter);
        spawn_local(async move {
            match serial_ports::permitted(last).await {
                Ok(ports) if ports.is_empty() && or_pick => self.pick_and_open(true).await,
                Ok(ports) => self.open(ports),
                Err(trouble) => self.could_not_pick(trouble),
            }
        });
    }

    /// Opens the picker.
    pub(crate) fn choose_port(self, filtered: bool) {
        spawn_local(self.pick_and_open(filtered));
    }

    /// Connects the virtual motors that were chosen last.
    pub(crate) fn connect_virtual(self) {
        let chosen = self.page.preferences;
        self.connect_line(chosen.with_untracked(|chosen| chosen.virtual_line));
    }

    /// Connects the virtual motors that the address asks for, if it does. They do not become the last choice.
    pub(crate) fn connect_as_addressed(self) {
        match virtual_line(parameter) {
            Some(Ok(line)) => {
                self.page.worker.opens_by_itself.set_value(true);
                self.connect_line(line);
            }
            Some(Err(bad)) => {
                let page = self.page;
                page.notify(&move || connect_texts::of_bad_parameter(&bad));
            }
            None => {}
        }
    }

    fn connect_line(self, line: VirtualLine) {
        let board = self.page.notices;
        board.update(|board| board.withdraw(Topic::Port));
        self.ask_to_connect(ToWorker::ConnectVirtual(line));
    }

    pub(crate) fn disconnect(self) {
        self.page.worker.opens_by_itself.set_value(false);
        self.page.post(&ToWorker::Disconnect);
    }

    async fn pick_and_open(self, filtered: bool) {
        match serial_ports::pick(filtered).await {
            Ok(port) => self.open(vec![port]),
            Err(trouble) => self.could_not_pick(trouble),
        }
    }

    fn open(self, candidates: Vec<PortRef>) {
        self.page
            .notices
            .update(|board| board.withdraw(Topic::Port));
        let wanted = self.page.selected.get_untracked();
        self.ask_to_connect(ToWorker::ConnectSerial {
            candidates,
            wanted,
            model: self
                .page
                .preferences
                .with_untracked(Preferences::model_choice),
            left: Vec::new(),
        });
    }

    /// Sends the last request that was made before the worker was ready.
    fn ask_to_connect(self, to: ToWorker) {
        if self.page.worker.link.with_value(Option::is_some) {
            self.page.post(&to);
        } else {
            self.page.worker.connect_early.set_value(Some(to));
        }
    }

    pub(crate) fn connect_if_asked_early(self) {
        if let Some(to) = self
            .page
            .worker
            .connect_early
            .try_update_value(Option::take)
            .flatten()
        {
            self.page.post(&to);
        }
    }

    fn could_not_pick(self, trouble: PickTrouble) {
        self.page
            .notify(&|| connect_texts::of_pick_trouble(trouble));
    }
}
