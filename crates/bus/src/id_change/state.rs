//! Giving the only motor on the bus another ID: checked before, verified after.
//!
//! The full scan that proved it to be alone may be a minute old, so the ID query is asked once more;
//! then the set-ID frames in a row, with nothing between them; then the new ID has to answer and the
//! old one has to be silent.

use motorlink_protocol::{AssignableId, Instant, MotorId};

use crate::{
    event::IdQueryOutcome,
    id_change::outcome::{IdChangeOutcome, SetIdFrames},
    job::status::SurveyStatus,
    probe::{Ask, Look},
    timing::{ID_LOOK_PERIOD, ID_SETTLE, SET_ID_PERIOD},
};

/// ID queries before the bus is said to be other than the scan found it: a reply may be lost.
const CHECKS_MAX: u8 = 5;

/// So many of them in a row have to bring the one motor: another may miss one.
const CHECKS_WANTED: u8 = 2;

/// Looks at the new ID, for a second: what a motor takes to write its flash is not published.
const NEW_LOOKS_MAX: u8 = 20;

/// Silent windows at the old ID: with one reply in twenty lost, three hide a motor once in 8,000 times.
const OLD_SILENCES: u8 = 3;

/// Looks at the old ID in all, where noise comes between.
const OLD_LOOKS_MAX: u8 = 8;

/// An ID change under way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct IdChange {
    pub(crate) from: MotorId,
    pub(crate) to: AssignableId,
    frames: SetIdFrames,
    step: Step,
    next: Instant,
}

#[derive(Clone, Copy, Debug)]
enum Step {
    Checking {
        asked: u8,
        clean: u8,
    },
    Sending {
        sent: u8,
    },
    LookingAtNew {
        looks: u8,
    },
    LookingAtOld {
        looks: u8,
        silent: u8,
        new_answers: bool,
    },
    Over(IdChangeOutcome),
}

/// What an ID change wants of the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Want {
    /// An answer.
    Ask(Ask),
    /// The next set-ID frame to be sent.
    SetId(AssignableId),
    /// Nothing before this.
    Wait(Instant),
    /// Nothing any more.
    Over(IdChangeOutcome),
}

impl IdChange {
    pub(crate) const fn begin(
        now: Instant,
        from: MotorId,
        to: AssignableId,
        frames: SetIdFrames,
    ) -> Self {
        Self {
            from,
            to,
            frames,
            step: Step::Checking { asked: 0, clean: 0 },
            next: now,
        }
    }

    /// What to do now. Whatever is asked for counts as done.
    pub(crate) fn next(&mut self, now: Instant) -> Want {
        if let Step::Over(outcome) = self.step {
            return Want::Over(outcome);
        }
        if now < self.next {
            return Want::Wait(self.next);
        }
        match &mut self.step {
            Step::Checking { asked, .. } => {
                *asked += 1;
                Want::Ask(Ask::Everyone)
            }
            Step::Sending { sent } => {
                *sent += 1;
                self.next = now + SET_ID_PERIOD;
                if *sent == self.frames.count() {
                    self.next = now + ID_SETTLE;
                    self.step = Step::LookingAtNew { looks: 0 };
                }
                Want::SetId(self.to)
            }
            Step::LookingAtNew { looks } => {
                *looks += 1;
                self.next = now + ID_LOOK_PERIOD;
                Want::Ask(Ask::One(self.to.id()))
            }
            Step::LookingAtOld { looks, .. } => {
                *looks += 1;
                self.next = now + ID_LOOK_PERIOD;
                Want::Ask(Ask::One(self.from))
            }
            Step::Over(outcome) => Want::Over(*outcome),
        }
    }

    /// What the ID query brought.
    pub(crate) fn called(&mut self, outcome: IdQueryOutcome) {
        if let Step::Checking { asked, clean } = self.step {
            self.step = match outcome {
                IdQueryOutcome::One(id) if id == self.from && clean + 1 >= CHECKS_WANTED => {
                    Step::Sending { sent: 0 }
                }
                IdQueryOutcome::One(id) if id == self.from => Step::Checking {
                    asked,
                    clean: clean + 1,
                },
                IdQueryOutcome::Nobody if asked < CHECKS_MAX => Step::Checking { asked, clean: 0 },
                // A quarrel is one, though another query may bring one voice.
                _ => Step::Over(IdChangeOutcome::NotAlone),
            };
        }
    }

    /// What a look at an address brought.
    pub(crate) fn looked(&mut self, id: MotorId, look: Look) {
        let answers = matches!(look, Look::Reply(_));
        self.step = match self.step {
            Step::LookingAtNew { looks } if id == self.to.id() => {
                if answers || looks >= NEW_LOOKS_MAX {
                    Step::LookingAtOld {
                        looks: 0,
                        silent: 0,
                        new_answers: answers,
                    }
                } else {
                    Step::LookingAtNew { looks }
                }
            }
            Step::LookingAtOld {
                looks,
                silent,
                new_answers,
            } if id == self.from => {
                let silent = silent + u8::from(look == Look::Silence);
                match (answers, new_answers) {
                    (true, true) => Step::Over(IdChangeOutcome::Both),
                    (true, false) => Step::Over(IdChangeOutcome::Kept {
                        frames: self.frames,
                    }),
                    (false, true) if silent >= OLD_SILENCES => Step::Over(IdChangeOutcome::Changed),
                    (false, false) if silent >= OLD_SILENCES => Step::Over(IdChangeOutcome::Lost),
                    // Noise is somebody's voice.
                    (false, _) if looks >= OLD_LOOKS_MAX => Step::Over(IdChangeOutcome::Both),
                    (false, _) => Step::LookingAtOld {
                        looks,
                        silent,
                        new_answers,
                    },
                }
            }
            step => step,
        };
    }

    /// A motor did not confirm its stop.
    pub(crate) fn not_stopped(&mut self) {
        self.step = Step::Over(IdChangeOutcome::NotStopped);
    }

    /// How it has ended, or ends when it is cancelled now.
    pub(crate) const fn outcome_now(&self) -> IdChangeOutcome {
        let frames_sent = match self.step {
            Step::Checking { .. } => 0,
            Step::Sending { sent } => sent,
            Step::LookingAtNew { .. } | Step::LookingAtOld { .. } => self.frames.count(),
            Step::Over(outcome) => return outcome,
        };
        IdChangeOutcome::Cancelled { frames_sent }
    }

    pub(crate) const fn status(&self) -> SurveyStatus {
        SurveyStatus::SettingId {
            from: self.from,
            to: self.to,
        }
    }
}
