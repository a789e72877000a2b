//! What an operator does in the tab `ID Manager`, and what the page does about it.

use leptos::prelude::{Update as _, *};
use motorlink_messages::{
    Notice,
    bus::{Command, IdChangeOutcome},
};

use crate::{
    features::ids::state::IdManager,
    model::{
        desk::{Desk, Dialog},
        guards::why_not_scan,
        notice_board::Topic,
        snapshot::Session,
        tab::Tab,
    },
    ui::tool_entry::{NO_NEW_ID, assignable},
};

impl Desk {
    /// Turns to a tab. Whoever leaves the ID manager wants no ID changed any more.
    pub(crate) fn open_tab(self, tab: Tab) {
        if tab == Tab::IdManager {
            // It says so itself.
            self.notices.update(|board| board.withdraw(Topic::Survey));
        } else {
            self.give_up_id_change();
        }
        self.tab.set(tab);
    }

    /// Asks who is there, by the ID query.
    pub(crate) fn scan(self) {
        self.change_ids(IdManager::scan);
        self.command(Command::IdQuery);
    }

    /// Asks every address who is there.
    pub(crate) fn full_scan(self) {
        self.change_ids(IdManager::scan);
        self.command(Command::FullScan);
    }

    /// Ends a scan or an ID change, and whatever was to follow.
    pub(crate) fn cancel_scan(self) {
        self.give_up_id_change();
        self.command(Command::CancelSurvey);
    }

    /// Begins to give the only motor the entered ID: a full scan has to prove that it is one.
    pub(crate) fn set_id(self) {
        let Some(to) = assignable(self.targets.new_id.get_untracked()) else {
            return;
        };
        // One that runs now would be taken for ours.
        if self
            .latest
            .with_value(|session| why_not_scan(session).is_none())
        {
            self.change_ids(|ids| ids.wish_for(to));
            self.command(Command::FullScan);
        }
    }

    /// Begins to send more frames to a motor that has kept its ID: with the same proof and question.
    pub(crate) fn set_id_with_more(self) {
        let may_scan = |session: &Session| why_not_scan(session).is_none();
        if self.latest.with_value(may_scan) {
            let mut wished = false;
            self.change_ids(|ids| wished = ids.wish_for_more());
            if wished {
                self.command(Command::FullScan);
            }
        }
    }

    /// The person has agreed to the ID change.
    pub(crate) fn set_proved_id(self) {
        let mut command = None;
        self.change_ids(|ids| command = ids.agree());
        if let Some(command) = command {
            self.command(command);
        }
    }

    pub(crate) fn give_up_id_change(self) {
        self.change_ids(IdManager::give_up);
    }

    /// The port is closed or lost.
    pub(crate) fn forget_scans(self) {
        self.change_ids(IdManager::disconnected);
        self.notices.update(|board| board.withdraw(Topic::Survey));
    }

    /// What the worker tells of scans and ID changes.
    pub(crate) fn hear_of_ids(self, notice: &Notice) {
        self.change_ids(|ids| ids.hear(notice));
        if let Notice::IdChangeEnded {
            to,
            outcome: IdChangeOutcome::Changed,
            ..
        } = notice
        {
            // The next one wants another ID than this.
            self.targets.new_id.set(NO_NEW_ID);
            self.prefer(|preferences| preferences.motor = to.id());
            self.select(to.id());
        }
    }

    /// Takes in whether the bus scans, behind all notices of one message.
    pub(crate) fn look_after_ids(self) {
        self.latest.with_value(|session| {
            let survey = session.survey.as_ref();
            self.ids.maybe_update(|ids| ids.look(survey));
        });
    }

    /// The question is open as long as it stands.
    fn change_ids(self, change: impl FnOnce(&mut IdManager)) {
        self.ids.update(change);
        let asked = self.ids.with_untracked(IdManager::question);
        let asked = asked.map(Dialog::ChangeId);
        let open = self.dialog.get_untracked();
        let is_ours = matches!(open, Some(Dialog::ChangeId(_)));
        if open != asked && (asked.is_some() || is_ours) {
            self.dialog.set(asked);
        }
    }
}
