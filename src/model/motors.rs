//! The selected motor, and the names and sides of all.

use leptos::prelude::*;
use motorlink_messages::{
    ToWorker,
    bus::{Activity, Command},
    protocol::MotorId,
};

use crate::model::{
    log_lines,
    names_and_sides::{NameAndSide, NamesAndSides},
    notice_board::{Topic, Until},
    notice_texts::of_choice_while_driven,
    page::{Change, Page},
};

impl Page {
    /// Chooses a motor and remembers it. One that is driven is stopped first.
    pub(crate) fn choose(self, id: MotorId) {
        if id == self.selected.get_untracked() {
            return;
        }
        let together = self.motors.driven_together.get_value();
        let others: Vec<MotorId> = self.latest.with_value(|session| {
            // A group drives on, whichever of its motors is selected.
            let driven = session.active_motors().filter(|motor| {
                !matches!(motor.activity, Activity::Stopping { .. })
                    && !together.contains(&motor.id)
            });
            driven.map(|motor| motor.id).collect()
        });
        for other in others {
            self.command(Command::Stop(other));
            let until = Until::AtRest {
                motors: vec![other],
                withdrawn: None,
            };
            let text = || of_choice_while_driven(other, id);
            self.log_now(&|| log_lines::of_notice(&text()));
            self.show_notice(text(), until);
        }
        self.prefer(|preferences| preferences.motor = id);
        self.select(id);
    }

    /// Shows another motor.
    pub(crate) fn select(self, id: MotorId) {
        self.withdraw_question();
        self.selected.set(id);
        self.loops.asked.set(None);
        self.notices.update(|board| board.withdraw(Topic::Answer));
        self.loops.tab_to_follow.set_value(true);
        self.announce(Change::Motor);
        self.post(&ToWorker::Select(id));
        self.show();
    }

    pub(crate) fn change_member(self, id: MotorId, change: impl FnOnce(&mut NameAndSide)) {
        self.motors.names.update(|names| names.change(id, change));
        self.motors.names.with_untracked(NamesAndSides::save);
    }

    /// Replaces all names and sides.
    pub(crate) fn replace_names_and_sides(self, names: NamesAndSides) {
        names.save();
        self.motors.names.set(names);
        self.motors.replaced.update(|times| *times += 1);
        // Its values may have another sign from now on.
        self.show();
    }
}
