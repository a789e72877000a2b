//! The run of a sequence beside the bus.

use motorlink_bus::{Activity, Bus, BusSettings, MotorStatus};
use motorlink_protocol::Instant;

use crate::rule::{Rule, Violation};
use crate::sequence_run::{Answers, SequenceRun};

use super::Player;

impl Player {
    /// Does what is due for the run.
    pub(super) fn turn_sequence(&mut self) -> Result<(), Violation> {
        let is_due = |run: &SequenceRun| run.wake().is_some_and(|wake| wake <= self.now);
        if self.sequence.as_ref().is_some_and(is_due) {
            self.with_sequence(|run, now, bus, settings, page_answers| {
                run.turn(now, bus, settings, page_answers)
            })?;
        }
        Ok(())
    }

    /// Lets the run act, and judges what it has done.
    pub(super) fn with_sequence(
        &mut self,
        act: impl FnOnce(&mut SequenceRun, Instant, Option<&mut Bus>, BusSettings, bool) -> Answers,
    ) -> Result<(), Violation> {
        let Some(mut run) = self.sequence.take() else {
            return Ok(());
        };
        let was_over = run.end().is_some() || run.has_died();
        let bus = self.bus.as_mut();
        let answers = act(&mut run, self.now, bus, self.settings, self.page_answers);
        self.judge_answers(answers)?;
        if !was_over && (run.end().is_some() || run.has_died()) {
            match run.end() {
                Some(end) => self.runs.count(end),
                None => self.runs.by_trap += 1,
            }
            // A run that was never started stops nothing: a person may drive.
            if run.has_driven() {
                self.ended_run_drives_nothing(&run)?;
            }
        }
        self.sequence = Some(run);
        Ok(())
    }

    pub(super) fn judge_answers(&mut self, answers: Answers) -> Result<(), Violation> {
        for (command, answer) in answers {
            self.note(|| format!("run: {command:?} {answer:?}"));
            if let Some(bus) = &self.bus {
                let now = self.now;
                self.rules
                    .on_command(now, now, command, answer, bus, &self.world)?;
            }
        }
        Ok(())
    }

    /// An ended run has stopped all of its motors.
    pub(super) fn ended_run_drives_nothing(&self, run: &SequenceRun) -> Result<(), Violation> {
        let Some(bus) = &self.bus else {
            return Ok(());
        };
        let is_driven = |status: &MotorStatus| {
            run.moves(status.id) && matches!(status.activity, Activity::Driven { .. })
        };
        match bus.motors(self.now).find(is_driven) {
            None => Ok(()),
            Some(status) => Err(Violation {
                rule: Rule::DrivenByCommandOnly,
                at: self.now,
                what: format!("{} is driven after its run has ended", status.id),
            }),
        }
    }
}
