//! The steps of the setup, and what is done in one of them.
//!
//! The steps are stored. What is done in one of them is not: after an interruption it begins again, and a motor whose ID
//! was set meanwhile is found with it. Only a person's act begins anything here.

use motorlink_messages::{
    bus::SetIdFrames,
    protocol::{AssignableId, MotorId},
};

use crate::{
    features::wheel_setup::wheel::{Layout, Problem, Wheel, problem},
    model::{
        id_progress::{End, IdProgress},
        notice_board::NoticeText,
    },
};

/// A step. Wheels are named by their row, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// The wheels are entered.
    Wheels,
    /// The only motor on the bus gets the ID of this wheel.
    Id(usize),
    /// The motor of this wheel has its ID, and gets a label.
    Label(usize),
    /// All motors have to answer on one bus.
    Check,
    /// Each wheel is spun on demand.
    Spin,
    /// All is stored.
    Done,
}

/// What is being done. It is not stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Act {
    #[default]
    None,
    /// The ID manager looks for the only motor, asks, and sets its ID.
    Finding,
    /// The ID manager scans.
    Checking,
    /// This wheel is driven for half a second.
    Spinning(usize),
    /// It is being stopped after that.
    Stopping(usize),
    /// It stands. A person says what was seen: nothing is driven meanwhile.
    Answering {
        wheel: usize,
        /// Whether another wheel turned, which is being named.
        other: bool,
    },
}

/// How the last act ended, where that is not seen from the step.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) enum Said {
    #[default]
    Nothing,
    /// The wheels as entered cannot be set up.
    Problem(Problem),
    /// What the ID manager says.
    Ids(NoticeText),
    /// More than one motor is on the bus.
    Several(Vec<MotorId>),
    /// The motor has kept its ID.
    Kept(Option<SetIdFrames>),
    /// The scan, the question or the spin was ended before its result.
    Cancelled,
    /// The port was closed or lost.
    Disconnected,
    /// The worker or the page refused.
    Refused(String),
    /// The wheel was stopped before half a second was over, or together with all others.
    CutShort(usize),
    /// The wheel did not report a standstill.
    NotConfirmed(MotorId),
    /// The wheel is on the other side now.
    Turned(usize),
    /// The two wheels have each other's motor now.
    Exchanged(usize, usize),
    /// No wheel turned.
    NothingTurned(usize),
}

/// The setup of the wheels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Setup {
    pub(crate) step: Step,
    pub(crate) wheels: Vec<Wheel>,
    pub(crate) act: Act,
    pub(crate) said: Said,
    /// The motors that the last check found.
    pub(crate) answered: Option<Vec<MotorId>>,
}

impl Default for Setup {
    fn default() -> Self {
        Self::at(Step::Wheels, Layout::Four.wheels())
    }
}

impl Setup {
    pub(crate) fn at(step: Step, wheels: Vec<Wheel>) -> Self {
        Self {
            step,
            wheels,
            act: Act::None,
            said: Said::Nothing,
            answered: None,
        }
    }

    /// Whether something is being done, which has to end before another step.
    pub(crate) fn is_busy(&self) -> bool {
        !matches!(self.act, Act::None | Act::Answering { .. })
    }

    pub(crate) fn go(&mut self, step: Step) {
        self.step = step;
        self.act = Act::None;
        self.said = Said::Nothing;
    }

    /// Changes the wheels. What has been done with one counts only for the ID and the side that it had.
    pub(crate) fn edit(&mut self, change: impl FnOnce(&mut Vec<Wheel>)) {
        let before = self.wheels.clone();
        change(&mut self.wheels);
        for wheel in &mut self.wheels {
            let old = before.iter().find(|old| old.id == wheel.id);
            wheel.has_id &= old.is_some();
            wheel.is_right &= old.is_some_and(|old| old.side == wheel.side);
        }
        self.said = Said::Nothing;
        self.answered = None;
    }

    /// The wheels are entered: goes to the IDs, or to the check where the motors have them.
    pub(crate) fn begin(&mut self, have_ids: bool) {
        match problem(&self.wheels) {
            Some(problem) => self.said = Said::Problem(problem),
            None if have_ids => self.go(Step::Check),
            None => self.go(Step::Id(0)),
        }
    }

    /// The wheel whose motor gets its ID or its label.
    pub(crate) fn wheel(&self) -> Option<&Wheel> {
        match self.step {
            Step::Id(place) | Step::Label(place) => self.wheels.get(place),
            _ => None,
        }
    }

    /// Looks for the only motor, which gets this ID.
    pub(crate) fn find(&mut self) -> Option<AssignableId> {
        if !matches!(self.step, Step::Id(_)) || self.is_busy() {
            return None;
        }
        let id = self.wheel()?.assigned()?;
        self.act = Act::Finding;
        self.said = Said::Nothing;
        Some(id)
    }

    /// Scans for all motors. Returns whether a scan has to begin.
    pub(crate) fn check(&mut self) -> bool {
        let may = self.step == Step::Check && !self.is_busy();
        if may {
            self.act = Act::Checking;
            self.said = Said::Nothing;
            self.answered = None;
        }
        may
    }

    /// The act could not begin.
    pub(crate) fn refused(&mut self, reason: String) {
        self.act = Act::None;
        self.said = Said::Refused(reason);
    }

    /// The ID manager has changed.
    pub(crate) fn on_ids(&mut self, ids: &IdProgress) {
        if ids.is_changing {
            return;
        }
        match (self.act, &ids.end) {
            (Act::Finding, end) => {
                self.act = Act::None;
                self.found(end.as_ref(), ids);
            }
            (Act::Checking, Some(end)) => {
                self.act = Act::None;
                match end {
                    End::Scanned { motors } => self.answered = Some(motors.clone()),
                    End::Kept | End::Failed => self.said = Said::Ids(ids.message.clone()),
                }
            }
            _ => {}
        }
    }

    fn found(&mut self, end: Option<&End>, ids: &IdProgress) {
        let Step::Id(place) = self.step else { return };
        let Some(wheel) = self.wheels.get_mut(place) else {
            return;
        };
        let only = |motors: &[MotorId]| wheel.motor().is_some_and(|id| motors == [id]);
        match end {
            Some(End::Scanned { motors }) if only(motors) => {
                wheel.has_id = true;
                self.step = Step::Label(place);
                self.said = Said::Ids(ids.message.clone());
            }
            Some(End::Scanned { motors }) if motors.len() > 1 => {
                self.said = Said::Several(motors.clone());
            }
            Some(End::Scanned { .. } | End::Failed) => {
                self.said = Said::Ids(ids.message.clone());
            }
            Some(End::Kept) => self.said = Said::Kept(ids.more),
            None => self.said = Said::Cancelled,
        }
    }

    /// The label is on the motor, or its wheel is skipped: goes to the next wheel, then to the check.
    pub(crate) fn next_wheel(&mut self) {
        let (Step::Id(place) | Step::Label(place)) = self.step else {
            return;
        };
        if self.is_busy() {
            return;
        }
        let next = place + 1;
        self.go(if next < self.wheels.len() {
            Step::Id(next)
        } else {
            Step::Check
        });
    }

    /// Goes to the ID of this wheel.
    pub(crate) fn set_id_of(&mut self, place: usize) {
        if place < self.wheels.len() && !self.is_busy() {
            self.go(Step::Id(place));
        }
    }

    /// Goes one step back.
    pub(crate) fn back(&mut self) {
        if self.is_busy() {
            return;
        }
        self.go(match self.step {
            Step::Wheels | Step::Id(0) => Step::Wheels,
            Step::Id(place) => Step::Id(place - 1),
            Step::Label(place) => Step::Id(place),
            Step::Check => Step::Id(self.wheels.len().saturating_sub(1)),
            Step::Spin => Step::Check,
            Step::Done => Step::Spin,
        });
    }

    /// Begins again with the wheels that are entered.
    pub(crate) fn begin_again(&mut self) {
        for wheel in &mut self.wheels {
            wheel.has_id = false;
            wheel.is_right = false;
        }
        self.answered = None;
        self.go(Step::Wheels);
    }

    /// Whether this wheel's motor answered the last check; `None` before it.
    pub(crate) fn has_answered(&self, wheel: &Wheel) -> Option<bool> {
        let answered = self.answered.as_ref()?;
        Some(wheel.motor().is_some_and(|id| answered.contains(&id)))
    }

    /// Motors that answered and belong to no wheel.
    pub(crate) fn strangers(&self) -> Vec<MotorId> {
        let is_wheel = |id: &MotorId| self.wheels.iter().any(|wheel| wheel.motor() == Some(*id));
        let answered = self.answered.iter().flatten();
        answered.filter(|id| !is_wheel(id)).copied().collect()
    }

    /// Whether any wheel answered the last check, so that it can be spun.
    pub(crate) fn may_spin(&self) -> bool {
        let answered = |wheel| self.has_answered(wheel) == Some(true);
        self.wheels.iter().any(answered)
    }

    /// The check has shown what answers: goes to the wheels.
    pub(crate) fn begin_spins(&mut self) {
        if self.step == Step::Check && !self.is_busy() && self.may_spin() {
            self.go(Step::Spin);
        }
    }

    /// The port is closed or lost, or the worker has ended.
    pub(crate) fn disconnected(&mut self) {
        self.answered = None;
        if self.act != Act::None {
            self.act = Act::None;
            self.said = Said::Disconnected;
        }
    }
}

#[cfg(test)]
#[path = "state_tests.rs"]
mod tests;
