//! The selected motor, and the names and sides of all.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    Adapter, Connection, ToWorker, VirtualLine,
    bus::{Activity, Command},
    protocol::MotorId,
};

use crate::model::{
    guards::side_change_blocked_by,
    log_lines,
    names_and_sides::{NameAndSide, NamesAndSides, Side},
    names_of_line,
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
        self.notices.update(|board| board.withdraw(Topic::Answer));
        self.loops.tab_to_follow.set_value(true);
        self.announce(Change::Motor);
        self.post(&ToWorker::Select(id));
        self.show();
    }

    pub(crate) fn change_member(self, id: MotorId, change: impl FnOnce(&mut NameAndSide)) {
        self.motors.names.update(|names| names.change(id, change));
        self.save_names();
    }

    /// Refused while the motor is driven: the next adjustment would reverse it.
    pub(crate) fn set_side(self, id: MotorId, side: Side) {
        let reason =
            side_change_blocked_by(&self.present(), id).or_else(|| self.side_changes_blocked_by());
        if let Some(reason) = reason {
            self.refuse(tr!("The side of motor {id} was not changed", id), reason);
            return;
        }
        self.change_member(id, |member| member.side = side);
        // Its values may have another sign from now on.
        self.show();
    }

    /// Sets the name and the side of a motor, and shows them in every list. The side is refused as in
    /// [`set_side`](Self::set_side).
    pub(crate) fn set_name_and_side(self, id: MotorId, name: &str, side: Side) {
        self.change_member(id, |member| member.set_name(name));
        if self.motors.names.with_untracked(|names| names.side(id)) != side {
            self.set_side(id, side);
        }
        self.motors.replaced.update(|times| *times += 1);
    }

    /// Replaces all names and sides of the present line.
    pub(crate) fn replace_names_and_sides(self, names: NamesAndSides) {
        self.show_names_and_sides(names);
        self.save_names();
    }

    /// Shows the names and sides of another line. Nothing drives then: its port has just been opened or closed.
    pub(crate) fn change_line(self, before: Option<VirtualLine>, after: Option<VirtualLine>) {
        let own = names_of_line::own(after);
        if own != names_of_line::own(before) {
            self.show_names_and_sides(names_of_line::load(own));
        }
        // One motor is found by the ID query, as on a real line.
        let selected = self.selected.get_untracked();
        if own.is_some_and(|line| usize::from(selected.get()) > line.count()) {
            self.select(MotorId::FIRST);
        }
    }

    /// Whether the names and sides are those of the motors on the present line: one virtual motor shares those of the
    /// real line.
    pub(crate) fn has_own_motors(self) -> bool {
        let connection = self.latest.with_value(|session| session.connection);
        let line = connection.virtual_line();
        names_of_line::own(line) == line
    }

    /// The names of a recording are not those of the motors of this browser.
    fn save_names(self) {
        let connection = self.latest.with_value(|session| session.connection);
        if let Connection::Connected(Adapter::Recording) = connection {
            return;
        }
        let names = self.motors.names;
        names.with_untracked(|names| names_of_line::save(names, connection.virtual_line()));
    }

    fn show_names_and_sides(self, names: NamesAndSides) {
        self.motors.names.set(names);
        self.motors.replaced.update(|times| *times += 1);
        // Its values may have another sign from now on.
        self.show();
    }
}
