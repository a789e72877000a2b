//! The last step: each wheel turns for half a second on a press, and a person says what was seen.
//!
//! A spin is left only with a stop of its motor, or after the bus has reported that stop.

use motorlink_messages::{
    Notice,
    bus::{CommandKind, StopReason, StopReport},
    protocol::MotorId,
};

use crate::{
    features::wheel_setup::state::{Act, Said, Setup, Step},
    model::{snapshot::concerns_all, terms},
};

impl Setup {
    /// Drives this wheel for half a second. Returns its motor.
    pub(crate) fn spin(&mut self, place: usize) -> Option<MotorId> {
        let again = matches!(self.act, Act::Answering { wheel, .. } if wheel == place);
        if self.step != Step::Spin || !(again || self.act == Act::None) {
            return None;
        }
        let id = self.motor(place)?;
        self.act = Act::Spinning(place);
        self.said = Said::Nothing;
        Some(id)
    }

    /// Half a second is over, or nobody looks any more: returns the motor to stop.
    pub(crate) fn end_spin(&mut self) -> Option<MotorId> {
        let Act::Spinning(place) = self.act else {
            return None;
        };
        self.act = Act::Stopping(place);
        self.motor(place)
    }

    fn motor(&self, place: usize) -> Option<MotorId> {
        self.wheels.get(place)?.motor()
    }

    /// Handles a notice of the worker. Returns the motor to stop.
    pub(crate) fn on_notice(&mut self, notice: &Notice) -> Option<MotorId> {
        let (Act::Spinning(place) | Act::Stopping(place)) = self.act else {
            return None;
        };
        match notice {
            // It may be a second start of this motor, which turns already: it is stopped all the same.
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
                self.act = Act::None;
                self.said = Said::CutShort(place);
                to_stop
            }
            Notice::StopBegan(reason) if concerns_all(*reason) => {
                self.act = Act::None;
                self.said = Said::CutShort(place);
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
        let Some(outcome) = report.motors.iter().find(|stop| Some(stop.id) == id) else {
            return;
        };
        let asked = self.act == Act::Stopping(place) && report.reason == StopReason::OneMotor;
        self.act = Act::None;
        if !outcome.confirmed {
            self.said = Said::NotConfirmed(outcome.id);
        } else if asked {
            self.act = Act::Answering {
                wheel: place,
                other: false,
            };
        } else {
            self.said = Said::CutShort(place);
        }
    }

    fn answering(&self) -> Option<usize> {
        match self.act {
            Act::Answering { wheel, .. } => Some(wheel),
            _ => None,
        }
    }

    /// The right wheel turned, forward.
    pub(crate) fn answer_right(&mut self) {
        if let Some(place) = self.answering() {
            self.act = Act::None;
            if let Some(wheel) = self.wheels.get_mut(place) {
                wheel.is_right = true;
            }
        }
    }

    /// The right wheel turned, backwards: it is on the other side.
    pub(crate) fn answer_backwards(&mut self) {
        if let Some(place) = self.answering() {
            self.act = Act::None;
            self.said = Said::Turned(place);
            if let Some(wheel) = self.wheels.get_mut(place) {
                wheel.turn_side();
            }
        }
    }

    /// Another wheel turned, which the person names next; or not, after all.
    pub(crate) fn answer_other(&mut self, is_other: bool) {
        if let Act::Answering { other, .. } = &mut self.act {
            *other = is_other;
        }
    }

    /// This wheel turned instead: the two have each other's motor.
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
                wheel.is_right = false;
            }
        }
        self.act = Act::None;
        self.said = Said::Exchanged(place, other);
    }

    /// No wheel turned.
    pub(crate) fn answer_nothing(&mut self) {
        if let Some(place) = self.answering() {
            self.act = Act::None;
            self.said = Said::NothingTurned(place);
            if let Some(wheel) = self.wheels.get_mut(place) {
                wheel.is_right = false;
            }
        }
    }

    /// The wheels are as they should be.
    pub(crate) fn finish(&mut self) {
        if self.step == Step::Spin && self.act == Act::None {
            self.go(Step::Done);
        }
    }
}

#[cfg(test)]
#[path = "spin_tests.rs"]
mod tests;
