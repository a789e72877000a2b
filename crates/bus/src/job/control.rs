//! Scans and ID changes: they have the line to themselves, once what was driven stands.

use std::time::Duration;

use motorlink_protocol::{Instant, MotorId};

use crate::{
    bus::Bus,
    command::Refusal,
    event::{Event, IdQueryOutcome, StopOutcome, StopReason},
    exchange::{Exchange, Expects, Line, Purpose},
    id_change::outcome::IdChangeOutcome,
    id_change::state::Want,
    job::state::{Proof, Survey},
    job::status::SurveyStatus,
    motor::{Control, Motor},
    probe::Look,
    schedule::{Errand, Turn},
};

impl Bus {
    /// The scan or ID change that is under way.
    #[must_use]
    pub fn survey(&self) -> Option<SurveyStatus> {
        let survey = self.survey.as_ref()?;
        if self.stop.is_some() {
            return Some(SurveyStatus::Stopping);
        }
        Some(match survey {
            Survey::Scan(scan) => scan.status(),
            Survey::IdChange(change) => change.status(),
        })
    }

    /// Whether nothing has or wants the line to itself.
    pub(crate) fn check_no_survey(&self) -> Result<(), Refusal> {
        let calling = matches!(
            self.line,
            Line::Busy(Exchange {
                expects: Expects::Everyone { .. },
                purpose: Purpose::Control | Purpose::Survey,
                ..
            })
        );
        if self.survey.is_some() || self.id_query_wanted || calling {
            Err(Refusal::Surveying)
        } else {
            Ok(())
        }
    }

    /// Stops what is driven or was left turning, so that the line is free and no wheel turns unasked.
    pub(crate) fn make_way(&mut self, now: Instant) {
        if let Some(raw) = &mut self.raw {
            raw.stop();
        }
        let concerns = |motor: &Motor| match motor.control {
            Control::Stopping(_) => false,
            Control::Idle => motor.may_turn,
            Control::Switching(_) | Control::Driven(_) => true,
        };
        if self.motors.iter().any(concerns) {
            self.begin_stop(now, StopReason::Survey, concerns);
        }
    }

    /// What a survey wants of the line; `None` where there is none, or it has just ended.
    pub(crate) fn survey_turn(&mut self, now: Instant) -> Option<Turn> {
        let ended = match self.survey.as_mut()? {
            Survey::Scan(scan) => match scan.next(now) {
                Some(ask) => return Some(Turn::Now(Errand::Survey(ask))),
                None => Survey::Scan(scan.clone()),
            },
            Survey::IdChange(change) => match change.next(now) {
                Want::Ask(ask) => return Some(Turn::Now(Errand::Survey(ask))),
                Want::SetId(id) => return Some(Turn::Now(Errand::SetId(id))),
                Want::Wait(at) => return Some(Turn::At(at)),
                Want::Over(_) => Survey::IdChange(*change),
            },
        };
        self.survey = None;
        self.survey_ended(now, &ended, true);
        None
    }

    /// Ends whatever has the line to itself, at once.
    pub(crate) fn cancel_survey(&mut self, now: Instant) {
        self.survey_again = None;
        if std::mem::take(&mut self.id_query_wanted) {
            let outcome = IdQueryOutcome::Cancelled;
            self.events.push_back(Event::IdQueryEnded(outcome));
        }
        if let Some(survey) = self.survey.take() {
            self.survey_ended(now, &survey, false);
        }
    }

    fn survey_ended(&mut self, now: Instant, survey: &Survey, complete: bool) {
        let event = match survey {
            Survey::Scan(scan) => {
                let report = scan.report(now, complete);
                if let ([id], [], true) = (&*report.found, &*report.noisy, complete) {
                    self.proved_alone = Some(Proof { id: *id, at: now });
                }
                Event::ScanEnded(report)
            }
            Survey::IdChange(change) => {
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

    /// How long a survey waits for the answer to this.
    pub(crate) fn survey_window(&self) -> Option<Duration> {
        match self.survey.as_ref()? {
            Survey::Scan(scan) => Some(scan.window()),
            Survey::IdChange(_) => None,
        }
    }

    /// What an address that was asked at `sent` brought.
    pub(crate) fn survey_looked(&mut self, now: Instant, sent: Instant, id: MotorId, look: Look) {
        let found = match &mut self.survey {
            Some(Survey::Scan(scan)) => scan.looked(id, sent, look),
            Some(Survey::IdChange(change)) => {
                change.looked(id, look);
                false
            }
            None => false,
        };
        if found {
            self.watch(now, id);
        }
    }

    /// What the ID query brought; `took` is when its last byte came.
    pub(crate) fn survey_called(&mut self, outcome: IdQueryOutcome, took: Option<Duration>) {
        match &mut self.survey {
            Some(Survey::Scan(scan)) => {
                scan.called(took.filter(|_| outcome != IdQueryOutcome::Nobody));
            }
            Some(Survey::IdChange(change)) => change.called(outcome),
            None => self.raw_checked(outcome),
        }
    }

    /// A good frame came from a motor that was not asked.
    pub(crate) fn survey_heard_late(&mut self, now: Instant, id: MotorId) {
        if let Some(Survey::Scan(scan)) = &mut self.survey {
            scan.heard_late(now, id);
        }
    }

    /// Somebody spoke. Where it is another than the one that was alone, it is not alone.
    pub(crate) fn doubt_proof(&mut self, heard: u8) {
        self.proved_alone = self.proved_alone.filter(|proof| proof.id.get() == heard);
    }

    /// The stop before a survey has ended.
    pub(crate) fn way_was_made(&mut self, outcomes: &[StopOutcome]) {
        if let Some(Survey::IdChange(change)) = &mut self.survey
            && outcomes.iter().any(|outcome| !outcome.confirmed)
        {
            change.not_stopped();
        }
    }
}
