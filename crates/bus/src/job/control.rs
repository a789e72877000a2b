//! Runs scans and ID changes. They have the line to themselves, once driven motors stand.

use std::time::Duration;

use motorlink_protocol::{Instant, MotorId};

use crate::{
    bus::Bus,
    event::{Event, IdQueryOutcome, StopOutcome, StopReason},
    exchange::{Exchange, Expects, Line, Purpose},
    id_change::outcome::IdChangeOutcome,
    id_change::state::NextAction,
    job::state::{Job, Proof},
    job::status::JobStatus,
    motor::{Control, Motor},
    probe::ProbeResult,
    refusal::Refusal,
    schedule::{DueFrame, Turn},
    timing::{SCAN_MARGIN, earliest_reply},
};

impl Bus {
    /// Progress of the running scan or ID change.
    #[must_use]
    pub fn job(&self) -> Option<JobStatus> {
        let job = self.job.as_ref()?;
        if self.stop.is_some() {
            return Some(JobStatus::Stopping);
        }
        Some(match job {
            Job::Scan(scan) => scan.status(),
            Job::IdChange(change) => change.status(),
        })
    }

    /// Refuses if a scan, an ID change or an ID query is running.
    pub(crate) fn check_no_job(&self) -> Result<(), Refusal> {
        let broadcasting = matches!(
            self.line,
            Line::Busy(Exchange {
                expects: Expects::Everyone { .. },
                purpose: Purpose::Control | Purpose::Job,
                ..
            })
        );
        if self.job.is_some() || self.id_query_wanted || broadcasting {
            Err(Refusal::JobRunning)
        } else {
            Ok(())
        }
    }

    /// Stops motors that are driven or may turn, so that the line is free.
    pub(crate) fn stop_for_job(&mut self, now: Instant) {
        self.end_starts_for_job();
        if let Some(raw) = &mut self.raw {
            raw.stop();
        }
        let concerns = |motor: &Motor| match motor.control {
            Control::Stopping(_) => false,
            Control::Idle => motor.may_turn(),
            Control::Switching(_) | Control::Driven(_) => true,
        };
        if self.motors.iter().any(concerns) {
            self.begin_stop(now, StopReason::Job, &concerns);
        }
    }

    /// The next frame of the job; `None` without a job, or if it has just ended.
    pub(crate) fn next_job_turn(&mut self, now: Instant) -> Option<Turn> {
        let ended = match self.job.as_mut()? {
            Job::Scan(scan) => match scan.next(now) {
                Some(ask) => return Some(Turn::Now(DueFrame::Probe(ask))),
                None => Job::Scan(scan.clone()),
            },
            Job::IdChange(change) => match change.next(now) {
                NextAction::Probe(ask) => return Some(Turn::Now(DueFrame::Probe(ask))),
                NextAction::SetId(id) => return Some(Turn::Now(DueFrame::SetId(id))),
                NextAction::Wait(at) => return Some(Turn::At(at)),
                NextAction::Done(_) => Job::IdChange(*change),
            },
        };
        self.job = None;
        self.job_ended(now, &ended, true);
        None
    }

    /// Cancels the job and the ID query at once.
    pub(crate) fn cancel_job(&mut self, now: Instant) {
        self.job_retry = None;
        if std::mem::take(&mut self.id_query_wanted) {
            let outcome = IdQueryOutcome::Cancelled;
            self.events.push_back(Event::IdQueryEnded(outcome));
        }
        if let Some(job) = self.job.take() {
            self.job_ended(now, &job, false);
        }
    }

    fn job_ended(&mut self, now: Instant, job: &Job, complete: bool) {
        let event = match job {
            Job::Scan(scan) => {
                let report = scan.report(now, complete);
                let proves = complete && report.fault.is_none();
                if let ([id], [], true) = (&*report.found, &*report.noisy, proves) {
                    self.proved_alone = Some(Proof { id: *id, at: now });
                }
                Event::ScanEnded(report)
            }
            Job::IdChange(change) => {
                let (from, to, outcome) = (change.from, change.to, change.outcome_now());
                if outcome == IdChangeOutcome::Changed {
                    self.motors.retain(|motor| motor.id != from);
                    self.watch(now, to.id());
                }
                Event::IdChangeEnded { from, to, outcome }
            }
        };
        self.events.push_back(event);
    }

    /// Reply window of the job.
    pub(crate) fn job_window(&self) -> Option<Duration> {
        match self.job.as_ref()? {
            // Late bytes behind the ID query look like a reply that no motor can give so soon.
            Job::Scan(scan) => {
                let least = earliest_reply(self.model) + SCAN_MARGIN;
                Some(scan.window().max(least))
            }
            Job::IdChange(_) => None,
        }
    }

    /// Result of a probe that was sent at `sent`.
    pub(crate) fn job_probe_ended(
        &mut self,
        now: Instant,
        sent: Instant,
        id: MotorId,
        result: ProbeResult,
    ) {
        let found = match &mut self.job {
            Some(Job::Scan(scan)) => scan.probe_ended(id, sent, result),
            Some(Job::IdChange(change)) => {
                change.probe_ended(id, result);
                false
            }
            None => false,
        };
        if found {
            self.watch(now, id);
        }
    }

    /// Result of the ID query. `sender`: the motor that sent all that came; `took`: the time to the last byte.
    pub(crate) fn job_id_query_ended(
        &mut self,
        now: Instant,
        outcome: IdQueryOutcome,
        sender: Option<MotorId>,
        took: Option<Duration>,
    ) {
        match &mut self.job {
            Some(Job::Scan(scan)) => {
                scan.id_query_ended(took.filter(|_| outcome != IdQueryOutcome::NoReply));
            }
            Some(Job::IdChange(change)) => change.id_query_ended(now, outcome, sender),
            None => self.raw_checked(outcome),
        }
    }

    /// A good frame of a motor that was not asked.
    pub(crate) fn job_late_reply(&mut self, now: Instant, id: MotorId) {
        if let Some(Job::Scan(scan)) = &mut self.job
            && scan.late_reply(now, id)
        {
            self.watch(now, id);
        }
    }

    /// A motor sent a frame. If it is not the one with the proof, that one is not alone.
    pub(crate) fn discard_proof_unless(&mut self, heard: u8) {
        self.proved_alone = self.proved_alone.filter(|proof| proof.id.get() == heard);
    }

    /// The stop before a job has ended.
    pub(crate) fn stop_for_job_ended(&mut self, outcomes: &[StopOutcome]) {
        if let Some(Job::IdChange(change)) = &mut self.job
            && outcomes.iter().any(|outcome| !outcome.confirmed)
        {
            change.not_stopped();
        }
    }
}
