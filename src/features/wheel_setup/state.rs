//! The stored step, and the activity that runs in it.
//!
//! The activity is not stored: after an interruption the user starts it again. A motor that got its ID meanwhile is then
//! found with that ID. Only the user starts an activity.

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

/// A step. The number of a wheel is its row, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// The user enters the wheels.
    Wheels,
    /// The only motor on the bus gets the ID of this wheel.
    Id(usize),
    /// The motor of this wheel has its ID. The user labels it.
    Label(usize),
    /// A scan checks that all motors reply on one bus.
    Check,
    /// The user spins each wheel.
    Spin,
    /// The user has finished the setup.
    Done,
}

/// The activity that runs in a step. It is not stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Activity {
    #[default]
    None,
    /// The ID manager looks for the only motor, asks, and sets its ID.
    Finding,
    /// The ID manager scans.
    Checking,
    /// This wheel is driven for half a second.
    Spinning(usize),
    /// This wheel is being stopped.
    Stopping(usize),
    /// The stop of this wheel is confirmed. The page asks what the user saw. Only this wheel can be spun again.
    Answering {
        wheel: usize,
        /// Whether another wheel turned, and the page asks which one.
        other: bool,
    },
}

/// The outcome of the last activity, if the step does not show it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) enum Outcome {
    #[default]
    Nothing,
    /// The entered wheels are not valid.
    Problem(Problem),
    /// The message of the ID manager.
    Ids(NoticeText),
    /// More than one motor is on the bus.
    Several(Vec<MotorId>),
    /// The motor has kept its ID. Contains the number of frames for the next try, if one is offered.
    Kept(Option<SetIdFrames>),
    /// The scan or the question ended without a result.
    Cancelled,
    /// The port was closed or lost.
    Disconnected,
    /// The worker or the page refused the activity, for this reason.
    Refused(String),
    /// The wheel was stopped before the end of its half second, or together with all other wheels.
    StoppedEarly(usize),
    /// This motor did not confirm its stop.
    NotConfirmed(MotorId),
    /// This wheel turned backwards, and its side was changed.
    SideChanged(usize),
    /// These two wheels have exchanged their motors.
    Exchanged(usize, usize),
    /// No wheel turned.
    NothingTurned(usize),
}

/// The setup of the wheels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Setup {
    pub(crate) step: Step,
    pub(crate) wheels: Vec<Wheel>,
    pub(crate) activity: Activity,
    pub(crate) outcome: Outcome,
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
            activity: Activity::None,
            outcome: Outcome::Nothing,
            answered: None,
        }
    }

    /// Whether a scan, an ID change or a spin runs. No other step opens until it ends.
    pub(crate) fn is_busy(&self) -> bool {
        !matches!(self.activity, Activity::None | Activity::Answering { .. })
    }

    pub(crate) fn go(&mut self, step: Step) {
        self.step = step;
        self.activity = Activity::None;
        self.outcome = Outcome::Nothing;
    }

    /// Changes the wheels. A wheel with another ID loses its progress. A wheel with another side must be checked again.
    pub(crate) fn edit(&mut self, change: impl FnOnce(&mut Vec<Wheel>)) {
        let before = self.wheels.clone();
        change(&mut self.wheels);
        for wheel in &mut self.wheels {
            let old = before.iter().find(|old| old.id == wheel.id);
            wheel.has_id &= old.is_some();
            wheel.is_checked &= old.is_some_and(|old| old.side == wheel.side);
        }
        self.outcome = Outcome::Nothing;
        self.answered = None;
    }

    /// Goes to the IDs, or to the check if the motors have their IDs. If the wheels are not valid, the step stays.
    pub(crate) fn leave_wheels(&mut self, have_ids: bool) {
        match problem(&self.wheels) {
            Some(problem) => self.outcome = Outcome::Problem(problem),
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

    /// Starts to look for the only motor. Returns the ID that it gets; `None` if this cannot start now.
    pub(crate) fn find(&mut self) -> Option<AssignableId> {
        if !matches!(self.step, Step::Id(_)) || self.is_busy() {
            return None;
        }
        let id = self.wheel()?.assigned()?;
        self.activity = Activity::Finding;
        self.outcome = Outcome::Nothing;
        Some(id)
    }

    /// Starts the check of all motors. Returns whether a scan is needed.
    pub(crate) fn check(&mut self) -> bool {
        let may = self.step == Step::Check && !self.is_busy();
        if may {
            self.activity = Activity::Checking;
            self.outcome = Outcome::Nothing;
            self.answered = None;
        }
        may
    }

    /// The activity was refused, for this reason.
    pub(crate) fn refused(&mut self, reason: String) {
        self.activity = Activity::None;
        self.outcome = Outcome::Refused(reason);
    }

    /// Handles a change of the ID manager.
    pub(crate) fn on_ids(&mut self, ids: &IdProgress) {
        if ids.is_changing {
            return;
        }
        match (self.activity, &ids.end) {
            (Activity::Finding, end) => {
                self.activity = Activity::None;
                self.found(end.as_ref(), ids);
            }
            (Activity::Checking, Some(end)) => {
                self.activity = Activity::None;
                match end {
                    End::Scanned { motors } => self.answered = Some(motors.clone()),
                    End::Kept | End::Failed => self.outcome = Outcome::Ids(ids.message.clone()),
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
                self.outcome = Outcome::Ids(ids.message.clone());
            }
            Some(End::Scanned { motors }) if motors.len() > 1 => {
                self.outcome = Outcome::Several(motors.clone());
            }
            Some(End::Scanned { .. } | End::Failed) => {
                self.outcome = Outcome::Ids(ids.message.clone());
            }
            Some(End::Kept) => self.outcome = Outcome::Kept(ids.more),
            None => self.outcome = Outcome::Cancelled,
        }
    }

    /// Goes to the next wheel, and after the last wheel to the check. The motor is labelled, or its wheel is skipped.
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

    /// Goes to the step that sets the ID of this wheel.
    pub(crate) fn set_id_of(&mut self, place: usize) {
        if place < self.wheels.len() && !self.is_busy() {
            self.go(Step::Id(place));
        }
    }

    /// Goes back by one step.
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

    /// Goes to the first step. Keeps the entered wheels without their progress.
    pub(crate) fn start_again(&mut self) {
        for wheel in &mut self.wheels {
            wheel.has_id = false;
            wheel.is_checked = false;
        }
        self.answered = None;
        self.go(Step::Wheels);
    }

    /// Whether the motor of this wheel answered the last check; `None` before a check.
    pub(crate) fn has_answered(&self, wheel: &Wheel) -> Option<bool> {
        let answered = self.answered.as_ref()?;
        Some(wheel.motor().is_some_and(|id| answered.contains(&id)))
    }

    /// The motors that answered the last check and belong to no wheel.
    pub(crate) fn unassigned_motors(&self) -> Vec<MotorId> {
        let is_wheel = |id: &MotorId| self.wheels.iter().any(|wheel| wheel.motor() == Some(*id));
        let answered = self.answered.iter().flatten();
        answered.filter(|id| !is_wheel(id)).copied().collect()
    }

    /// Whether at least one wheel answered the last check, and can be spun.
    pub(crate) fn may_spin(&self) -> bool {
        let answered = |wheel| self.has_answered(wheel) == Some(true);
        self.wheels.iter().any(answered)
    }

    /// Goes to the spins if at least one wheel answered the check.
    pub(crate) fn begin_spins(&mut self) {
        if self.step == Step::Check && !self.is_busy() && self.may_spin() {
            self.go(Step::Spin);
        }
    }

    /// The port was closed or lost, or the worker has ended.
    pub(crate) fn disconnected(&mut self) {
        self.answered = None;
        if self.activity != Activity::None {
            self.activity = Activity::None;
            self.outcome = Outcome::Disconnected;
        }
    }
}

#[cfg(test)]
#[path = "state_tests.rs"]
mod tests;
