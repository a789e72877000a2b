//! What the run tells: its state, its data and its end.

use std::rc::Rc;

use leptos::prelude::*;
use motorlink_i18n::{tr, untranslated};
use motorlink_messages::{
    decode,
    experiments::{
        runner::{Cause, End, Phase, RecordPart},
        study::{Findings, Study, StudyKind},
    },
    protocol::Instant,
    runs::{FromRun, RunState},
};

use crate::{
    features::experiments::{
        chart::Live,
        kept::NewRun,
        state::{Armed, Experiments, Shown},
        texts,
    },
    model::{log_lines, names_and_sides::NameAndSide, runs},
    ui::clock::{page_now_ms, page_origin_ms},
};

/// The name of the sequence, or of the kind of study.
fn name_of(study: &Study) -> String {
    match study {
        Study::Sequence(sequence) if !sequence.name.is_empty() => sequence.name.clone(),
        other => texts::study(other.kind()).to_owned(),
    }
}

impl Experiments {
    /// Gets the messages of the run.
    pub(super) fn receive_messages(self) {
        runs::set_receiver(Rc::new(move |message| {
            if let Ok(message) = decode(message) {
                self.receive(message);
            }
        }));
    }

    fn receive(self, message: FromRun) {
        let run = self.run.get_value();
        match message {
            FromRun::State(state) if state.run == run => self.take_state(state),
            FromRun::NotArmed { run: of, reason } if of == run => {
                self.shown.set(Shown::Idle);
                self.armed.set(None);
                self.said.set(texts::not_armed(&reason));
            }
            FromRun::NotStarted(why) => self.said.set(texts::not_started(why)),
            FromRun::Part { run: of, part } if of == run => self.take_part(part),
            FromRun::Died => self.died(),
            // Of a run that was replaced.
            FromRun::State(_) | FromRun::NotArmed { .. } | FromRun::Part { .. } => {}
        }
    }

    fn take_state(self, state: RunState) {
        let Some(armed) = self
            .armed
            .get_untracked()
            .filter(|armed| armed.run == state.run)
        else {
            return;
        };
        let before = self.shown.get_untracked().phase();
        let has_ended = matches!(before, Some(Phase::Ended(_)));
        if let Some(began) = state.began
            && !has_ended
            && self.live.with_value(|live| live.began_at() != Some(began))
        {
            self.begin(&armed, began);
        }
        self.shown.set(Shown::Reported(state));
        if let Phase::Ended(end) = state.phase
            && !has_ended
        {
            self.finish(&armed, end, state.began.is_some());
        }
    }

    fn begin(self, armed: &Armed, began: Instant) {
        let mut live = Live::of(&armed.plan);
        live.began(began);
        self.live.set_value(live);
        let study = armed.study.clone();
        let name = name_of(&study);
        self.page.log(
            began,
            untranslated(|| log_lines::calm(tr!("Run began: {name}", name = name_of(&study)))),
        );
        let ids = armed.plan.motors().iter().map(|motor| motor.id);
        let motors = self
            .page
            .motors
            .names
            .with_untracked(|names| ids.map(|id| (id, names.name(id).to_owned())).collect());
        let passed = self.page.now().since(began).as_secs_f64() * 1_000.0;
        let kind = study.kind();
        self.last.update(|last| {
            last.retain(|(other, _)| *other != kind);
            last.push((kind, armed.run));
        });
        self.kept.begin(NewRun {
            number: armed.run,
            study,
            name,
            motors,
            model: self.page.model.get_untracked().spec().name.to_owned(),
            setup: self.page.setup().to_json(),
            request_hz: 1.0 / armed.options.period.as_secs_f64().max(0.001),
            began_unix_ms: page_origin_ms() + page_now_ms() - passed,
            began,
        });
    }

    fn take_part(self, part: RecordPart) {
        self.live.update_value(|live| {
            for mark in &part.marks {
                live.step_began(mark);
            }
            for sample in &part.samples {
                live.add(sample);
            }
        });
        self.kept.add_part(self.run.get_value(), part);
        self.live_drawn
            .update(|drawn| *drawn = drawn.wrapping_add(1));
    }

    fn finish(self, armed: &Armed, end: End, has_begun: bool) {
        let row = match end {
            End::Aborted {
                cause: Cause::WaitTimedOut { step },
                ..
            } if armed.study.kind() == StudyKind::Sequence => self.row_of(armed.plan.place(step)),
            _ => None,
        };
        if has_begun {
            self.said.set(texts::end(end, row));
            self.page.log_now(&|| {
                let how = texts::end(end, row);
                log_lines::calm(tr!("Run ended: {how}", how))
            });
            self.kept.end(armed.run, end);
            self.remember_result(armed);
        } else {
            self.said.set(texts::disarmed(end));
        }
    }

    /// Remembers for the motor what it does when frames cease, if that was measured.
    fn remember_result(self, armed: &Armed) {
        let Study::Silence(study) = &armed.study else {
            return;
        };
        let findings = untrack(|| self.kept.findings(armed.run));
        if let Some(Findings::Silence(found)) = findings.as_deref()
            && found.result.is_some()
            && self.page.has_own_motors()
        {
            let change = |member: &mut NameAndSide| member.when_silent = found.result;
            self.page.change_member(study.motor, change);
        }
    }

    /// The program of the runs has failed, and the worker has stopped its motors.
    fn died(self) {
        let state = self.shown.get_untracked();
        let armed = self.armed.get_untracked();
        if let (Some(armed), Shown::Reported(state)) = (armed, state)
            && state.began.is_some()
            && !matches!(state.phase, Phase::Ended(_))
        {
            let end = End::Aborted {
                cause: Cause::ProgramFailed,
                at: state.now,
            };
            self.finish(&armed, end, true);
        }
        self.shown.set(Shown::Idle);
        self.armed.set(None);
        self.said.set(
            tr!("The program that runs experiments has failed. All runs have ended. Reload the page, then press Arm again.")
                .to_owned(),
        );
    }
}
