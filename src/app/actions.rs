//! Actions of the operator that concern several features.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    bus::{Command, CommandRate, Consent, Limits, StopReason},
    experiments::vehicle::Geometry,
    protocol::{Setpoint, family::Model},
    recorder::ToRecorder,
};

use crate::{
    app::features::Features,
    features::{help::tour_view::TourAction, saved_session::offer::Offer},
    model::{
        keys::KeyAction,
        local_storage::forget_all,
        names_and_sides::NamesAndSides,
        notice_board::Remedy,
        page::{Change, Dialog},
        place::Place,
        preferences::Preferences,
        replay::{self, Crossing},
        setup::Setup,
    },
};

impl Features {
    /// Stops all motors. The message is posted before anything else is done.
    pub(crate) fn stop_all(self, reason: StopReason) {
        // It pauses a recording: no port is open then.
        if replay::keeps(Crossing::Stop) {
            return;
        }
        if reason == StopReason::Operator && self.page.worker.link.with_value(Option::is_none) {
            self.page.worker.stopped_early.set_value(true);
        }
        self.page.command(Command::StopAll(reason));
        self.page.dialog.set(None);
        self.page.announce(Change::Declined);
        self.raw.forget_pending();
        self.groups.forget();
    }

    /// Sends a stop that was pressed before the worker ran, before anything can be driven.
    pub(crate) fn stop_if_asked_early(self) {
        if self.page.worker.stopped_early.get_value() {
            self.page.command(Command::StopAll(StopReason::Operator));
        }
    }

    /// The operator accepts the question of the open dialog, which closes: consent counts once.
    pub(crate) fn agree(self) {
        let asked = self.page.dialog.get_untracked();
        self.page.dialog.set(None);
        match asked {
            Some(Dialog::HighCurrent { id, target }) => {
                self.drive
                    .drive_with(id, Setpoint::Current(target), Consent::HighCurrent);
            }
            Some(Dialog::ChangeId(_)) => self.ids.agree(),
            Some(Dialog::Hazard(order)) => self.raw.send_hazard(order),
            Some(Dialog::HighRawCurrent { order, .. }) => {
                self.raw.send_order(order, Consent::HighCurrent);
            }
            Some(Dialog::EraseKept) => self.erase_stored_data(),
            Some(Dialog::Help(_) | Dialog::NameAndSide(_)) | None => {}
        }
    }

    /// Runs the action of a key. While the group is chosen, no key turns one of its wheels, or shows its controls.
    pub(crate) fn run_key_action(self, action: KeyAction) {
        match action {
            KeyAction::Stop => self.drive.stop_motor(),
            KeyAction::Help => self.page.dialog.set(Some(Dialog::Help(None))),
            KeyAction::Brake => self.drive.drive(Setpoint::Brake),
            _ if self.page.group.get_untracked() => {}
            KeyAction::Forward => self.drive.drive_at(self.drive.targets.preset_rpm()),
            KeyAction::Backward => self.drive.drive_at(-self.drive.targets.preset_rpm()),
            KeyAction::Preset(rpm) => self.drive.drive_at(rpm),
            KeyAction::Show(mode) => self.drive.show(mode),
        }
    }

    pub(crate) fn remedy(self, remedy: Remedy) {
        match remedy {
            Remedy::ShowAllPorts => self.connect.choose_port(false),
            Remedy::FullScan => {
                self.page.open(Place::Setup);
                self.ids.full_scan();
            }
            Remedy::TakeNewVersion => self.install.take_new_version(),
            Remedy::Install => self.install.install(),
            Remedy::Reload => {
                if let Some(window) = web_sys::window() {
                    // A page that cannot be reloaded stays as it is; no further report is possible.
                    let _ = window.location().reload();
                }
            }
        }
    }

    /// Erases what is kept, and continues like a first visit.
    pub(crate) fn erase_stored_data(self) {
        // Driving or recording may have begun while the question was open.
        let in_use = untrack(|| self.settings.import_blocked_by(&self.page.present()));
        let in_use = in_use.or_else(|| self.page.side_changes_blocked_by());
        if let Some(reason) = untrack(|| self.settings.erase_blocked_by(in_use)) {
            self.page.refuse(tr!("Nothing deleted").to_owned(), reason);
            return;
        }
        self.saved_session.offer.set(Offer::None);
        let limits = Limits::default();
        self.page.take_setup(Setup {
            model: Some(Model::default()),
            detect_model: Some(true),
            rate: Some(CommandRate::default()),
            keep_driving: Some(true),
            ramp: Some(0),
            speed_limit: Some(limits.speed_rpm()),
            current_limit: Some(limits.current_ma()),
            temperature_limit: Some(limits.temperature_c()),
            geometry: Some(Geometry::default()),
            names: Some(NamesAndSides::default()),
        });
        let first = Preferences::default();
        self.page.preferences.set(first);
        self.log
            .refilter(|filter| filter.collapse = first.collapse_polls);
        // Last, because the changes above were stored.
        forget_all();
        self.log.renumbered();
        self.page.recorder.post(&ToRecorder::Erase);
        self.log.request_rows();
    }

    /// Runs an action of the tour.
    pub(crate) fn run_tour_action(self, action: TourAction) {
        match action {
            TourAction::PickPort => self.connect.choose_port(true),
            TourAction::ConnectVirtual => self.connect.connect_virtual(),
            TourAction::Spin(rpm) => self.drive.drive_at(rpm),
            TourAction::Stop => self.drive.stop_motor(),
        }
    }
}
