//! What the buttons do, and the messages of the run.
//!
//! [`Experiments::start`] and [`Experiments::resume`] are the only functions here that start motion. Only the buttons
//! `Run` and `Resume` call them.

use std::{rc::Rc, time::Duration};

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    ToWorker,
    bus::Command,
    decode, encode,
    experiments::{
        runner::{Cause, End, Options, Phase, RecordPart},
        study::{Study, StudyKind},
    },
    protocol::{Instant, Mode, MotorId},
    runs::{FromRun, RunState, ToRun},
};

use crate::{
    features::experiments::{
        chart::Live,
        kept::NewRun,
        state::{Armed, Experiments, Shown},
        table, texts,
    },
    model::{guards::drive_blocked_by, runs, snapshot::Session},
    ui::{
        clock::{act_ms, page_now_ms, page_origin_ms},
        listener::on_window,
        reactive::effect,
    },
};

impl Experiments {
    /// Gets the messages of the run, and reports a lost focus to it.
    pub(super) fn listen(self) {
        runs::set_receiver(Rc::new(move |message| {
            if let Ok(message) = decode(message) {
                self.receive(message);
            }
        }));
        let lost = move || {
            let shown = self.shown.try_get_untracked();
            if shown.is_some_and(Shown::is_driving) {
                self.post(&ToRun::FocusLost);
            }
        };
        on_window("blur", move |_| lost());
        // It reaches the window from the document.
        on_window("visibilitychange", move |_| {
            if document().hidden() {
                lost();
            }
        });
        // What was armed is no longer what is asked: it must be read again.
        effect(move || {
            let is_same = self.checked.with(|checked| {
                let Some(Ok((study, plan))) = checked else {
                    return false;
                };
                let settings = self.options();
                self.armed.with_untracked(|armed| {
                    armed.as_ref().is_some_and(|armed| {
                        armed.study == *study && armed.plan == *plan && armed.options == settings
                    })
                })
            });
            if !is_same && self.is_armed() {
                self.abort();
                self.said
                    .set(tr!("Disarmed: the question has changed. Press Arm again.").to_owned());
            }
        });
    }

    fn is_armed(self) -> bool {
        let shown = self.shown.get_untracked();
        shown == Shown::Asked || matches!(shown.phase(), Some(Phase::Armed { .. }))
    }

    fn post(self, message: &ToRun) {
        if let Ok(message) = encode(message) {
            self.page.post(&ToWorker::Run {
                message,
                given_ms: act_ms(),
            });
        }
    }

    /// The settings of the next run.
    pub(super) fn options(self) -> Options {
        let rate = self.rate.get().clamp(1, 500);
        Options {
            period: Duration::from_secs(1) / rate,
            stop_on_lost_focus: self.stop_on_lost_focus.get(),
        }
    }

    /// Why the run cannot be armed, and the switch of a loop that would help.
    pub(super) fn blocked_by(self) -> Option<(String, Option<(MotorId, Mode)>)> {
        if self.shown.get().is_driving() {
            return Some((tr!("A run is running. Abort it first.").to_owned(), None));
        }
        let plan = self.checked.with(|checked| match checked {
            Some(Ok((_, plan))) => Ok(plan.motors().to_vec()),
            Some(Err(error)) => Err(texts::refused(error, self.row_of(&error.place))),
            None => Err(String::new()),
        });
        let motors = match plan {
            Ok(motors) => motors,
            Err(words) => return Some((words, None)),
        };
        self.page.shown.with(|session| {
            motors.iter().find_map(|motor| {
                let (id, mode) = (motor.id, motor.mode());
                let reason = drive_blocked_by(session, id, mode)?;
                let is_other_loop = session.mode(id).is_some_and(|now| now.value != mode);
                Some((reason, is_other_loop.then_some((id, mode))))
            })
        })
    }

    /// The row of the table with this place; none in another tab.
    pub(super) fn row_of(self, place: &str) -> Option<usize> {
        let is_table = self.kind() == Some(StudyKind::Sequence);
        is_table
            .then(|| self.draft.with(|draft| table::find(&draft.rows, place)))
            .flatten()
            .map(|(row, _)| row)
    }

    /// Shows what will move, and asks the worker to arm it. Nothing moves.
    pub(super) fn arm(self) {
        if untrack(|| self.blocked_by()).is_some() {
            return;
        }
        let Some(Ok((study, plan))) = self.checked.get_untracked() else {
            return;
        };
        let run = self
            .kept
            .next_number()
            .max(self.run.get_value().wrapping_add(1));
        self.run.set_value(run);
        let options = untrack(|| self.options());
        let message = ToRun::Arm {
            run,
            sequence: study.sequence().to_json(),
            fleet: self.fleet.get_untracked(),
            options,
        };
        self.said.set(String::new());
        self.shown.set(Shown::Asked);
        self.armed.set(Some(Rc::new(Armed {
            run,
            study,
            plan,
            options,
        })));
        self.post(&message);
    }

    /// Starts the armed run: the wheels turn.
    pub(super) fn start(self) {
        if !matches!(
            self.shown.get_untracked().phase(),
            Some(Phase::Armed { .. })
        ) {
            return;
        }
        self.said.set(String::new());
        // Until the worker reports the effect, Space stops.
        self.page.worker.started_ms.set_value(page_now_ms());
        self.post(&ToRun::Start {
            run: self.run.get_value(),
        });
    }

    /// Pauses the run, or resumes it.
    pub(super) fn pause_or_resume(self) {
        match self.shown.get_untracked().phase() {
            Some(Phase::Running) => self.post(&ToRun::Pause),
            Some(Phase::Paused) => {
                self.page.worker.started_ms.set_value(page_now_ms());
                self.post(&ToRun::Resume);
            }
            _ => {}
        }
    }

    /// Disarms an armed run; ends a running one.
    pub(super) fn abort(self) {
        self.post(&ToRun::Abort);
        if self.is_armed() {
            self.shown.set(Shown::Idle);
            self.armed.set(None);
        }
    }

    /// Switches a motor to the loop that the run needs. It starts no motion.
    pub(super) fn switch(self, id: MotorId, mode: Mode) {
        self.page.command(Command::SwitchMode { id, mode });
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
        let name = match &study {
            Study::Sequence(sequence) if !sequence.name.is_empty() => sequence.name.clone(),
            other => texts::study(other.kind()).to_owned(),
        };
        let ids = armed.plan.motors().iter().map(|motor| motor.id);
        let motors = self.page.motors.names.with_untracked(|names| {
            let name = |id| names.member(id).map(|member| member.name().to_owned());
            ids.map(|id| (id, name(id).unwrap_or_default())).collect()
        });
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
            } => self.row_of(armed.plan.place(step)),
            _ => None,
        };
        self.said.set(texts::end(end, row));
        if has_begun {
            self.kept.end(armed.run, end);
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
                cause: Cause::Late,
                at: state.now,
            };
            self.finish(&armed, end, true);
        }
        self.shown.set(Shown::Idle);
        self.armed.set(None);
        self.said.set(
            tr!("The program of the runs has stopped, and its motors with it. Press Arm again.")
                .to_owned(),
        );
    }

    /// Seconds until an armed run can no longer be started.
    pub(super) fn armed_for(self) -> Option<u64> {
        match self.shown.get().phase() {
            Some(Phase::Armed { until }) => {
                let now = self.page.shown.with(|session: &Session| session.now);
                Some(until.since(now).as_secs())
            }
            _ => None,
        }
    }

    /// Changes the study of the open tab.
    pub(super) fn change(self, change: impl FnOnce(&mut Study)) {
        let Some(kind) = untrack(|| self.kind()) else {
            return;
        };
        self.studies.update(|studies| {
            if let Some(study) = studies.iter_mut().find(|study| study.kind() == kind) {
                change(study);
            }
        });
    }
}
