//! The last step: the user presses Spin, the wheel turns for half a second, and the user chooses what was seen.
//!
//! A spin ends only with a stop of its motor, or after the bus has reported that stop.

use motorlink_messages::{
    Notice,
    bus::{CommandKind, StopReason, StopReport},
    protocol::MotorId,
};

use crate::{
    features::wheel_setup::state::{Activity, Outcome, Setup, Step},
    model::{snapshot::concerns_all, terms},
};

impl Setup {
    /// Starts the spin of this wheel. Returns the motor to drive; `None` if it cannot be spun now.
    pub(crate) fn spin(&mut self, place: usize) -> Option<MotorId> {
        let again = matches!(self.activity, Activity::Answering { wheel, .. } if wheel == place);
        if self.step != Step::Spin || !(again || self.activity == Activity::None) {
            return None;
        }
        let id = self.motor(place)?;
        self.activity = Activity::Spinning(place);
        self.outcome = Outcome::Nothing;
        Some(id)
    }

    /// Ends the spin after half a second, or when the panel is no longer visible. Returns the motor to stop.
    pub(crate) fn end_spin(&mut self) -> Option<MotorId> {
        let Activity::Spinning(place) = self.activity else {
            return None;
        };
        self.activity = Activity::Stopping(place);
        self.motor(place)
    }

    fn motor(&self, place: usize) -> Option<MotorId> {
        self.wheels.get(place)?.motor()
    }

    /// Handles a notice of the worker. Returns the motor to stop.
    pub(crate) fn on_notice(&mut self, notice: &Notice) -> Option<MotorId> {
        let (Activity::Spinning(place) | Activity::Stopping(place)) = self.activity else {
            return None;
        };
        match notice {
            // The motor may turn already, from a start before this one: stop it in any case.
            Notice::Refused {
                command: CommandKind::Drive(id),
                refusal,
            } if Some(*id) == self.motor(place) => {
                let to_stop = self.end_spin();
                self.refused(terms::refusal(*refusal));
                to_stop
            }
            Notice::TooLate(CommandKind::Drive(id)) if Some(*id) == self.motor(place) => {
                let to_stop = self.end_spin();
                self.activity = Activity::None;
                self.outcome = Outcome::StoppedEarly(place);
                to_stop
            }
            Notice::StopBegan(reason) if concerns_all(*reason) => {
                self.activity = Activity::None;
                self.outcome = Outcome::StoppedEarly(place);
                None
            }
            Notice::StopEnded(report) => {
                self.stopped(place, report);
                None
            }
            _ => None,
        }
    }

    fn stopped(&mut self, place: usize, report: &StopReport) {
        let id = self.motor(place);
        let Some(stop) = report.motors.iter().find(|stop| Some(stop.id) == id) else {
            return;
        };
        let asked =
            self.activity == Activity::Stopping(place) && report.reason == StopReason::OneMotor;
        self.activity = Activity::None;
        if !stop.confirmed {
            self.outcome = Outcome::NotConfirmed(stop.id);
        } else if asked {
            self.activity = Activity::Answering {
                wheel: place,
                other: false,
            };
        } else {
            self.outcome = Outcome::StoppedEarly(place);
        }
    }

    fn answering(&self) -> Option<usize> {
        match self.activity {
            Activity::Answering { wheel, .. } => Some(wheel),
            _ => None,
        }
    }

    /// The spun wheel turned forward.
    pub(crate) fn answer_correct(&mut self) {
        if let Some(place) = self.answering() {
            self.activity = Activity::None;
            if let Some(wheel) = self.wheels.get_mut(place) {
                wheel.is_checked = true;
            }
        }
    }

    /// The spun wheel turned backwards: changes its side.
    pub(crate) fn answer_backwards(&mut self) {
        if let Some(place) = self.answering() {
            self.activity = Activity::None;
            self.outcome = Outcome::SideChanged(place);
            if let Some(wheel) = self.wheels.get_mut(place) {
                wheel.change_side();
            }
        }
    }

    /// Another wheel turned: the page asks which one. `false` goes back to the first question.
    pub(crate) fn answer_other(&mut self, is_other: bool) {
        if let Activity::Answering { other, .. } = &mut self.activity {
            *other = is_other;
        }
    }

    /// This wheel turned instead: exchanges the motors of the two.
    pub(crate) fn exchange_with(&mut self, other: usize) {
        let Some(place) = self.answering() else {
            return;
        };
        let of = |place: usize| self.wheels.get(place).map(|wheel| (wheel.id, wheel.has_id));
        let (Some(mine), Some(theirs)) = (of(place), of(other)) else {
            return;
        };
        if place == other {
            return;
        }
        for (place, (id, has_id)) in [(place, theirs), (other, mine)] {
            if let Some(wheel) = self.wheels.get_mut(place) {
                (wheel.id, wheel.has_id) = (id, has_id);
                wheel.is_checked = false;
            }
        }
        self.activity = Activity::None;
        self.outcome = Outcome::Exchanged(place, other);
    }

    /// No wheel turned.
    pub(crate) fn answer_nothing(&mut self) {
        if let Some(place) = self.answering() {
            self.activity = Activity::None;
            self.outcome = Outcome::NothingTurned(place);
            if let Some(wheel) = self.wheels.get_mut(place) {
                wheel.is_checked = false;
            }
        }
    }

    /// Ends the setup, unless a wheel turns or the page asks about one.
    pub(crate) fn finish(&mut self) {
        if self.step == Step::Spin && self.activity == Activity::None {
            self.go(Step::Done);
        }
    }
}

#[cfg(test)]
#[path = "spin_tests.rs"]
mod tests;
