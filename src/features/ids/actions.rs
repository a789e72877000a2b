//! Actions of the tab `ID Manager`.

use leptos::prelude::{Update as _, *};
use motorlink_messages::{
    Notice,
    bus::{Command, IdChangeOutcome},
    protocol::{AssignableId, MotorId},
};

use crate::{
    features::ids::state::IdManager,
    model::{
        guards::id_change_blocked_by,
        notice_board::Topic,
        page::{Change, Dialog, Listener, Page},
        place::Place,
        snapshot::{Reading, Session},
        tool_entry::{NO_NEW_ID, assignable},
    },
    ui::target::Target,
};

/// The tab `ID Manager`: scans, and the new ID.
#[derive(Clone, Copy)]
pub(crate) struct Ids {
    pub(crate) page: Page,
    pub(crate) manager: RwSignal<IdManager>,
    /// The new ID.
    pub(crate) new_id: Target,
}

impl Ids {
    pub(crate) fn new(page: Page) -> Self {
        Self {
            page,
            manager: RwSignal::new(IdManager::default()),
            new_id: Target::new(NO_NEW_ID),
        }
    }

    /// Follows the bus and the page from now on.
    pub(crate) fn listen(self) {
        let act = move |change: Change<'_>| match change {
            Change::Notice(notice) => self.notice(notice),
            Change::Updated => self.check_scan(),
            Change::Disconnected => self.disconnected(),
            Change::Declined => self.give_up(),
            Change::Place(place) => self.place_opened(place),
            Change::Motor | Change::Model | Change::Geometry => {}
        };
        self.page.listen(Listener::Ids, Box::new(act));
    }

    /// Selects the only motor that a scan has found, if the selected one does not answer.
    fn select_if_alone(self, found: MotorId) {
        let page = self.page;
        let selected = page.selected.get_untracked();
        let answers = |session: &Session| {
            session
                .mode(selected)
                .as_ref()
                .is_some_and(Reading::is_fresh)
        };
        let is_answering = page.latest.with_value(answers);
        if found != selected && !is_answering && !page.is_anything_driven() {
            page.select(found);
        }
    }

    /// Another place is opened. Leaving the ID manager cancels the ID change.
    fn place_opened(self, place: Place) {
        if place == Place::Setup {
            // It reports that itself.
            self.page
                .notices
                .update(|board| board.withdraw(Topic::Survey));
        } else {
            self.give_up();
        }
    }

    /// Sends the ID query.
    pub(crate) fn scan(self) {
        self.change_ids(IdManager::scan);
        self.page.command(Command::IdQuery);
    }

    /// Starts a full scan.
    pub(crate) fn full_scan(self) {
        self.change_ids(IdManager::scan);
        self.page.command(Command::FullScan);
    }

    /// Ends a scan or an ID change.
    pub(crate) fn cancel_scan(self) {
        self.give_up();
        self.page.command(Command::CancelJob);
    }

    /// Starts to set the entered ID: first, a full scan has to prove that there is only one motor.
    pub(crate) fn set_id(self) {
        if let Some(to) = assignable(self.new_id.get_untracked()) {
            self.request(to);
        }
    }

    /// The same for this ID. Returns whether the scan was asked for.
    pub(crate) fn request(self, to: AssignableId) -> bool {
        // A running scan would be mistaken for ours.
        let may_change = |session: &Session| id_change_blocked_by(session).is_none();
        let may_change = self.page.latest.with_value(may_change);
        if may_change {
            self.change_ids(|ids| ids.request(to));
            self.page.command(Command::FullScan);
        }
        may_change
    }

    /// Starts to send more frames to a motor that has kept its ID, with the same proof and question.
    /// Returns whether the scan was asked for.
    pub(crate) fn set_id_with_more(self) -> bool {
        let mut requested = false;
        let may_change = |session: &Session| id_change_blocked_by(session).is_none();
        if self.page.latest.with_value(may_change) {
            self.change_ids(|ids| requested = ids.request_more());
            if requested {
                self.page.command(Command::FullScan);
            }
        }
        requested
    }

    /// The user has confirmed the ID change.
    pub(crate) fn agree(self) {
        let mut command = None;
        self.change_ids(|ids| command = ids.agree());
        if let Some(command) = command {
            self.page.command(command);
        }
    }

    fn give_up(self) {
        self.change_ids(IdManager::give_up);
    }

    /// The port is closed or lost.
    fn disconnected(self) {
        self.change_ids(IdManager::disconnected);
        self.page
            .notices
            .update(|board| board.withdraw(Topic::Survey));
    }

    /// Handles notices about scans and ID changes.
    fn notice(self, notice: &Notice) {
        if let Notice::ScanEnded(report) = notice
            && let [only] = report.found.as_slice()
        {
            self.select_if_alone(*only);
        }
        self.change_ids(|ids| ids.on_notice(notice));
        if let Notice::IdChangeEnded {
            to,
            outcome: IdChangeOutcome::Changed,
            ..
        } = notice
        {
            // The next change needs another ID.
            self.new_id.set(NO_NEW_ID);
            self.page.prefer(|preferences| preferences.motor = to.id());
            self.page.select(to.id());
        }
    }

    /// Updates the job of the bus, after all notices of one message.
    fn check_scan(self) {
        self.page.latest.with_value(|session| {
            let job = session.job.as_ref();
            self.manager.maybe_update(|ids| ids.update(job));
        });
    }

    /// Opens or closes the question.
    fn change_ids(self, change: impl FnOnce(&mut IdManager)) {
        self.manager.update(change);
        let asked = self.manager.with_untracked(IdManager::question);
        let asked = asked.map(Dialog::ChangeId);
        let open = self.page.dialog.get_untracked();
        let is_ours = matches!(open, Some(Dialog::ChangeId(_)));
        if open != asked && (asked.is_some() || is_ours) {
            self.page.dialog.set(asked);
        }
    }
}
