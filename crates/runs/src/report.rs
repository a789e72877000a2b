//! What the program tells the page: the state, and the entries of the record.

use std::time::Duration;

use motorlink_experiments::runner::{Phase, RecordPart, Runner};
use motorlink_messages::runs::{FromRun, RunState};
use motorlink_protocol::Instant;

/// The page draws figures ten times a second.
const PERIOD: Duration = Duration::from_millis(100);

/// What the page has been told of a run.
#[derive(Debug)]
pub(crate) struct Report {
    run: u32,
    told: Option<(Phase, usize)>,
    told_at: Instant,
    passed: Duration,
    step: usize,
}

impl Report {
    pub(crate) const fn new(run: u32) -> Self {
        Self {
            run,
            told: None,
            told_at: Instant::ZERO,
            passed: Duration::ZERO,
            step: 0,
        }
    }

    /// Adds the messages that are due.
    pub(crate) fn update(
        &mut self,
        now: Instant,
        runner: &mut Runner,
        messages: &mut Vec<FromRun>,
    ) {
        if let Some(mark) = runner.record().marks().last() {
            self.step = mark.step;
        }
        self.passed = runner.passed(now).unwrap_or(self.passed);
        let phase = runner.phase();
        let state = Some((phase, self.step));
        let is_under_way = matches!(phase, Phase::Running | Phase::Paused);
        let is_due = is_under_way && now >= self.told_at + PERIOD;
        if state == self.told && !is_due {
            return;
        }
        let has_ended = matches!(phase, Phase::Ended(_));
        let shown = FromRun::State(RunState {
            run: self.run,
            now,
            phase,
            began: runner.record().began_at(),
            passed: self.passed,
            step: self.step,
        });
        // The page opens the record at the first state with a start, and closes it at the end: parts are in between.
        let (before, after) = if has_ended {
            (None, Some(shown))
        } else {
            (Some(shown), None)
        };
        messages.extend(before);
        if is_due || has_ended {
            let part = runner.take_part();
            if part != RecordPart::default() {
                let run = self.run;
                messages.push(FromRun::Part { run, part });
            }
            self.told_at = now;
        }
        messages.extend(after);
        self.told = state;
    }
}
