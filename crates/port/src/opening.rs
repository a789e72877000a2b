//! Tries one port after the other, until one stays open.

use std::time::Duration;

use motorlink_bus::{Bus, Command, DetectedModel, MotorStatus, Refusal};
use motorlink_messages::{LeftBehind, ModelChoice};
use motorlink_protocol::{Instant, MotorId, family::Model};

use crate::{
    order::{ANSWER_MAX, Awaited, LeftMotors, OpeningOrder},
    step::{IfNoReply, Others, Step},
};

/// How a trial treats motors that were left driven. They may be on another port that is alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LeftHere {
    /// It stops them at once if they can be on no other port, else it asks whether they turn.
    Find,
    /// It stops them at once: the wanted motor replies here, and they turn on none of the ports that were asked.
    Stop,
    /// There are none, they are of another model, or nothing has replied here.
    LeaveAlone,
}

/// What the open port is watched for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Awaits {
    /// What the trial of the order awaits.
    Trial,
    /// A motor that was left driven and turns: then this is its port.
    Turns,
    /// A reply of the wanted motor.
    Wanted,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// The next port is chosen.
    Next,
    /// The port is claimed.
    Claimed,
    /// The port is opened for the next model.
    Open,
    OnTrial(Awaits),
    /// The port is closed. Then it is opened for its next model, or the next port is tried.
    Close {
        opens_again: bool,
    },
    Done,
    Failed,
}

/// The trials of one or several ports.
#[derive(Clone, Debug)]
pub struct Opening {
    ports: usize,
    wanted: MotorId,
    if_no_reply: IfNoReply,
    choice: ModelChoice,
    stage: Stage,
    /// How many ports were tried.
    tried: usize,
    /// The port on trial.
    port: usize,
    /// `Find` while all ports are tried in turn; another one for the port that is taken at the end.
    left_here: LeftHere,
    order: OpeningOrder,
    /// Whether a motor of the last model has answered on this port.
    has_answered: bool,
    /// Whether the motors that were left driven are only asked: they may be on another port.
    is_asked: bool,
    first_that_opens: Option<usize>,
    first_that_fits: Option<usize>,
    /// Whether a port that may have the motors that were left driven was not asked, or has not answered.
    was_left_out: bool,
    last_step: Instant,
    /// How long the open port has been watched for what is awaited.
    watched_for: Duration,
}

impl Opening {
    /// The longest pause between two steps.
    pub const STEP: Duration = Duration::from_millis(20);

    /// The trials that find the port with a motor that was left driven and turns, else the one on which the wanted motor
    /// replies.
    #[must_use]
    pub fn new(ports: usize, wanted: MotorId, choice: ModelChoice, if_no_reply: IfNoReply) -> Self {
        Self {
            ports,
            wanted,
            if_no_reply,
            choice,
            stage: Stage::Next,
            tried: 0,
            port: 0,
            left_here: LeftHere::Find,
            order: order_of(choice, None),
            has_answered: false,
            is_asked: false,
            first_that_opens: None,
            first_that_fits: None,
            was_left_out: false,
            last_step: Instant::ZERO,
            watched_for: Duration::ZERO,
        }
    }

    /// The port on trial.
    #[must_use]
    pub const fn port(&self) -> usize {
        self.port
    }

    /// The model to begin with next time.
    #[must_use]
    pub const fn choice(&self) -> ModelChoice {
        self.choice
    }

    /// Says what to do next. `bus` is the bus of the open port; `left` was left driven on ports of this make.
    pub fn step(&mut self, now: Instant, mut bus: Option<&mut Bus>, left: &mut LeftBehind) -> Step {
        loop {
            self.stage = match self.stage {
                Stage::Next => match self.next_port() {
                    Some(port) => {
                        self.port = port;
                        self.stage = Stage::Claimed;
                        return Step::Claim(port);
                    }
                    None => Stage::Failed,
                },
                Stage::Claimed => {
                    self.order = order_of(self.choice, left.model_of_motors());
                    self.has_answered = false;
                    if self.left_here == LeftHere::LeaveAlone && left.model_of_motors().is_some() {
                        self.order.tried(None);
                    }
                    Stage::Open
                }
                Stage::Open => return Step::Open(self.port, self.order.trial().model),
                Stage::OnTrial(awaits) => {
                    let Some(bus) = bus.as_deref_mut() else {
                        return Step::Wait;
                    };
                    // A computer that was asleep has not watched.
                    self.watched_for += now.since(self.last_step).min(2 * Self::STEP);
                    self.last_step = now;
                    let Some(next) = self.after_trial(awaits, now, bus, left) else {
                        return Step::Wait;
                    };
                    self.watched_for = Duration::ZERO;
                    next
                }
                // It would cut off a stop.
                Stage::Close { .. } if bus.as_deref().is_some_and(Bus::is_stopping) => {
                    return Step::Wait;
                }
                Stage::Close { opens_again } => {
                    self.stage = if opens_again {
                        Stage::Open
                    } else {
                        Stage::Next
                    };
                    return Step::Close;
                }
                Stage::Done => return Step::Done,
                Stage::Failed => return Step::Failed,
            }
        }
    }

    /// The port cannot be claimed, or does not open. `left` was left driven on ports of its make.
    pub const fn refused(&mut self, left: &LeftBehind) {
        self.was_left_out |= !left.motors.is_empty();
        self.stage = Stage::Next;
    }

    /// The port is open, with this bus, which has sent nothing. `others`: the ports of this make, besides this one, that may
    /// have the motors of `left`.
    pub fn opened(&mut self, now: Instant, bus: &mut Bus, left: &mut LeftBehind, others: Others) {
        let trial = self.order.trial();
        let is_last = trial.awaits == Awaited::Nothing;
        let is_like = || {
            let left = left.model_of_motors();
            left.is_some_and(|left| left.is_like(trial.model))
        };
        let how = match trial.left {
            LeftMotors::Stop if !is_last => self.left_here,
            LeftMotors::Stop if (self.has_answered || self.stays_open()) && is_like() => {
                LeftHere::Find
            }
            _ => LeftHere::LeaveAlone,
        };
        self.is_asked = how == LeftHere::Find && others.count > 0;
        self.was_left_out |= others.count > others.tried;
        if self.is_asked {
            for motor in &left.motors {
                // Not refused while nothing drives.
                let _: Result<(), Refusal> = bus.command(now, Command::Watch(motor.id));
            }
        } else if how != LeftHere::LeaveAlone && self.was_left_out {
            // Those on another port may be the ones, so they stay remembered.
            bus.stop_first(now, left.motors.iter().copied());
        } else if how != LeftHere::LeaveAlone {
            bus.stop_first(now, left.take());
        }
        self.last_step = now;
        self.watched_for = Duration::ZERO;
        self.stage = Stage::OnTrial(if self.is_asked {
            Awaits::Turns
        } else {
            Awaits::Trial
        });
    }

    /// What follows when the open port has shown what is awaited, or has not shown it in time; `None`: it has time left.
    fn after_trial(
        &mut self,
        awaits: Awaits,
        now: Instant,
        bus: &mut Bus,
        left: &mut LeftBehind,
    ) -> Option<Stage> {
        let turns = |motor: MotorStatus| {
            let speed = motor.speed.map(|(_, speed)| speed.magnitude());
            let is_left = left.motors.iter().any(|left| left.id == motor.id);
            is_left && speed.is_some_and(|rpm| rpm > 0)
        };
        if self.is_asked && bus.motors(now).any(turns) {
            self.choice.model = self.order.trial().model;
            bus.stop_first(now, left.take());
            return Some(Stage::Done);
        }
        let is_over = |limit| self.watched_for >= limit && !bus.is_active(now);
        match awaits {
            Awaits::Trial => {
                let awaited = self.order.trial().awaits;
                let found = awaited.found(bus, now);
                if found.is_none() && awaited != Awaited::Nothing && !is_over(awaited.limit()) {
                    return None;
                }
                Some(self.after_model(found))
            }
            Awaits::Turns => {
                let next = match self.left_here {
                    LeftHere::Find => Stage::OnTrial(Awaits::Wanted),
                    LeftHere::Stop | LeftHere::LeaveAlone => Stage::Done,
                };
                // With separate frames two replies give a speed, and others come between them.
                let has_separate = bus.model().has_separate_frames();
                is_over(ANSWER_MAX * if has_separate { 2 } else { 1 }).then_some(next)
            }
            Awaits::Wanted => {
                let mut motors = bus.motors(now);
                let replies = motors.any(|motor| motor.id == self.wanted && motor.last.is_some());
                if !replies && !is_over(ANSWER_MAX) {
                    return None;
                }
                if replies && !self.is_asked {
                    return Some(Stage::Done);
                }
                // Its line may be dead.
                let is_silent = !bus.motors(now).any(|motor| motor.last.is_some());
                self.was_left_out |= self.is_asked && is_silent;
                self.first_that_opens.get_or_insert(self.port);
                if replies {
                    self.first_that_fits.get_or_insert(self.port);
                }
                Some(Stage::Close { opens_again: false })
            }
        }
    }

    fn after_model(&mut self, found: Option<DetectedModel>) -> Stage {
        self.has_answered = found == Some(DetectedModel::Own);
        if self.has_answered {
            self.choice.model = self.order.trial().model;
        }
        if !self.order.tried(found) {
            Stage::Close { opens_again: true }
        } else if self.stays_open() {
            Stage::Done
        } else {
            Stage::OnTrial(Awaits::Wanted)
        }
    }

    /// The next port to try. The last one was tried before, and is taken.
    fn next_port(&mut self) -> Option<usize> {
        if self.left_here != LeftHere::Find {
            return None;
        }
        if self.tried < self.ports {
            self.tried += 1;
            return Some(self.tried - 1);
        }
        self.left_here = match self.first_that_fits {
            Some(_) => LeftHere::Stop,
            None => LeftHere::LeaveAlone,
        };
        let takes_first = self.if_no_reply == IfNoReply::TakeFirst;
        let first = self.first_that_opens.filter(|_| takes_first);
        self.first_that_fits.or(first)
    }

    /// Whether the port on trial is taken, unless a motor that was left driven turns on another one.
    fn stays_open(&self) -> bool {
        let is_only = self.ports < 2 && self.if_no_reply == IfNoReply::TakeFirst;
        is_only || self.left_here != LeftHere::Find
    }
}

/// The models that a port is opened for.
fn order_of(choice: ModelChoice, left: Option<Model>) -> OpeningOrder {
    let chosen = (!choice.detect).then_some(choice.model);
    OpeningOrder::new(left, chosen, choice.model)
}
