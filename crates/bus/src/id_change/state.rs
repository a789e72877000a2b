//! State of an ID change: checks, set-ID frames, verification.
//!
//! The full scan that proved the motor to be alone may be a minute old. So the ID query is sent
//! again; then the set-ID frames in a row; then the new ID must answer and the old one must be
//! silent.

use std::time::Duration;

use motorlink_protocol::{AssignableId, Instant, MotorId};

use crate::{
    event::IdQueryOutcome,
    id_change::outcome::{IdChangeOutcome, SetIdFrames},
    job::status::JobStatus,
    probe::{Probe, ProbeResult},
    timing::{ID_PROBE_PERIOD, ID_SETTLE_TIME, SET_ID_PERIOD},
};

/// Most ID queries before the check fails: a reply may be lost, or late by some hundred milliseconds.
const CHECKS_MAX: u8 = 5;

/// Time between an unanswered request and the next ID query. An adapter that stalls sends both together, and the replies of one
/// motor collide like those of two.
pub(crate) const UNANSWERED_PAUSE: Duration = Duration::from_millis(300);

/// Clean ID queries in a row that are needed: another motor may miss one.
const CHECKS_WANTED: u8 = 2;

/// Most probes of the new ID, over a second: the time that a motor takes to write its flash is not
/// published.
const NEW_PROBES_MAX: u8 = 20;

/// Silent windows of the old ID that prove it unused: with one reply in twenty lost, three hide a
/// motor once in 8,000 times.
const OLD_SILENCES: u8 = 3;

/// Most probes of the old ID, if noise comes between.
const OLD_PROBES_MAX: u8 = 8;

/// A running ID change.
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
    ProbingNew {
        probes: u8,
    },
    ProbingOld {
        probes: u8,
        silent: u8,
        new_answers: bool,
    },
    Done(IdChangeOutcome),
}

/// What an ID change does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NextAction {
    /// Send this probe.
    Probe(Probe),
    /// Send the next set-ID frame.
    SetId(AssignableId),
    /// Wait until this moment.
    Wait(Instant),
    /// The ID change has ended.
    Done(IdChangeOutcome),
}

impl IdChange {
    /// A change whose first ID query is sent at `first_query`.
    pub(crate) const fn begin(
        first_query: Instant,
        from: MotorId,
        to: AssignableId,
        frames: SetIdFrames,
    ) -> Self {
        Self {
            from,
            to,
            frames,
            step: Step::Checking { asked: 0, clean: 0 },
            next: first_query,
        }
    }

    /// The next action. It counts as done.
    pub(crate) fn next(&mut self, now: Instant) -> NextAction {
        if let Step::Done(outcome) = self.step {
            return NextAction::Done(outcome);
        }
        if now < self.next {
            return NextAction::Wait(self.next);
        }
        match &mut self.step {
            Step::Checking { asked, .. } => {
                *asked += 1;
                NextAction::Probe(Probe::IdQuery)
            }
            Step::Sending { sent } => {
                *sent += 1;
                self.next = now + SET_ID_PERIOD;
                if *sent == self.frames.count() {
                    self.next = now + ID_SETTLE_TIME;
                    self.step = Step::ProbingNew { probes: 0 };
                }
                NextAction::SetId(self.to)
            }
            Step::ProbingNew { probes } => {
                *probes += 1;
                self.next = now + ID_PROBE_PERIOD;
                NextAction::Probe(Probe::Query(self.to.id()))
            }
            Step::ProbingOld { probes, .. } => {
                *probes += 1;
                self.next = now + ID_PROBE_PERIOD;
                NextAction::Probe(Probe::Query(self.from))
            }
            Step::Done(outcome) => NextAction::Done(*outcome),
        }
    }

    /// Result of the ID query. `sender`: the motor that sent all that came.
    pub(crate) fn id_query_ended(
        &mut self,
        now: Instant,
        outcome: IdQueryOutcome,
        sender: Option<MotorId>,
    ) {
        if let Step::Checking { asked, clean } = self.step {
            if outcome == IdQueryOutcome::NoReply {
                self.next = now + UNANSWERED_PAUSE;
            }
            // Behind a pause of the computer or the adapter, replies to earlier requests come with it.
            let is_open = outcome == IdQueryOutcome::NoReply || sender == Some(self.from);
            self.step = match outcome {
                IdQueryOutcome::One(id) if id == self.from && clean + 1 >= CHECKS_WANTED => {
                    Step::Sending { sent: 0 }
                }
                IdQueryOutcome::One(id) if id == self.from => Step::Checking {
                    asked,
                    clean: clean + 1,
                },
                _ if is_open && asked < CHECKS_MAX => Step::Checking { asked, clean: 0 },
                // A collision is another motor, even if the next query brings one clean reply.
                _ => Step::Done(IdChangeOutcome::NotAlone),
            };
        }
    }

    /// Result of a probe.
    pub(crate) fn probe_ended(&mut self, id: MotorId, result: ProbeResult) {
        let answers = matches!(result, ProbeResult::Reply(_));
        self.step = match self.step {
            Step::ProbingNew { probes } if id == self.to.id() => {
                if answers || probes >= NEW_PROBES_MAX {
                    Step::ProbingOld {
                        probes: 0,
                        silent: 0,
                        new_answers: answers,
                    }
                } else {
                    Step::ProbingNew { probes }
                }
            }
            Step::ProbingOld {
                probes,
                silent,
                new_answers,
            } if id == self.from => {
                let silent = silent + u8::from(result == ProbeResult::Silence);
                match (answers, new_answers) {
                    (true, true) => Step::Done(IdChangeOutcome::Both),
                    (true, false) => Step::Done(IdChangeOutcome::Kept {
                        frames: self.frames,
                    }),
                    (false, true) if silent >= OLD_SILENCES => Step::Done(IdChangeOutcome::Changed),
                    (false, false) if silent >= OLD_SILENCES => Step::Done(IdChangeOutcome::Lost),
                    // Noise is the reply of another motor.
                    (false, _) if probes >= OLD_PROBES_MAX => Step::Done(IdChangeOutcome::Both),
                    (false, _) => Step::ProbingOld {
                        probes,
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
        self.step = Step::Done(IdChangeOutcome::NotStopped);
    }

    /// The outcome, or the outcome of a cancellation now.
    pub(crate) const fn outcome_now(&self) -> IdChangeOutcome {
        let frames_sent = match self.step {
            Step::Checking { .. } => 0,
            Step::Sending { sent } => sent,
            Step::ProbingNew { .. } | Step::ProbingOld { .. } => self.frames.count(),
            Step::Done(outcome) => return outcome,
        };
        IdChangeOutcome::Cancelled { frames_sent }
    }

    pub(crate) const fn status(&self) -> JobStatus {
        JobStatus::SettingId {
            from: self.from,
            to: self.to,
        }
    }
}
