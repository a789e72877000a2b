//! Chooses the model of the motors, and follows the one that is found.

use leptos::prelude::*;
use motorlink_messages::protocol::family::Model;

use crate::model::{
    motor_model::{choice_blocked_by, found, shown},
    page::{Change, Page},
    tab,
};

impl Page {
    /// The greatest speed of the model in rpm.
    pub(crate) fn speed_max(self) -> i32 {
        self.model.get().spec().speed_rpm_max.into()
    }

    /// The highest speed in rpm that may be asked for: that of the model, or the limit of Settings.
    pub(crate) fn speed_limit(self) -> i32 {
        let limits = self.preferences.with(|chosen| chosen.limits);
        self.speed_max().min(limits.speed_rpm().into())
    }

    /// Full scale of the model's current in mA; an upper bound if that is not certain.
    pub(crate) fn current_max_ma(self) -> i32 {
        self.model.get().spec().current.milliamps().into()
    }

    /// Takes the model that the motors of the line have.
    pub(crate) fn follow_model(self) {
        let chosen = self.preferences.with_untracked(|chosen| chosen.model);
        if let Some(model) = self.latest.with_value(|session| found(session, chosen)) {
            self.prefer(|preferences| preferences.model = model);
        }
        self.leave_missing_tab();
    }

    /// Takes the model that the person has chosen, and opens the serial port again with it. Returns whether it was
    /// taken.
    pub(crate) fn choose_model(self, model: Model) -> bool {
        // Driving may have begun since the list was opened.
        let blocked = self.latest.with_value(choice_blocked_by).is_some();
        if blocked || self.is_anything_driven() {
            return false;
        }
        self.prefer(|preferences| preferences.model = model);
        if self.latest.with_value(|session| session.line.is_some()) {
            self.announce(Change::Model);
        }
        self.leave_missing_tab();
        true
    }

    /// Opens the velocity loop in place of a loop that the model does not have.
    pub(crate) fn leave_missing_tab(self) {
        let chosen = self.preferences.with_untracked(|chosen| chosen.model);
        let model = self.latest.with_value(|session| shown(session, chosen));
        let tab = self.loops.tab.get_untracked();
        if !model.has(tab) {
            self.loops.tab.set(tab::FIRST);
        }
    }
}
