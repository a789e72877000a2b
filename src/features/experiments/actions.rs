//! What the buttons do.
//!
//! [`Experiments::start`] and [`Experiments::pause_or_resume`] are the only functions here that start motion. Only the buttons
//! `Run` and `Resume` call them.

use std::{rc::Rc, time::Duration};

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    ToWorker,
    bus::{CarriedRate, Command, CommandRate, Refusal},
    encode,
    experiments::{
        plan::{Plan, PlanMotor},
        runner::{Options, Phase},
        sequence::{Quantity, RunLimits},
        study::{Study, StudyKind},
    },
    protocol::{Mode, MotorId},
    runs::ToRun,
};

use crate::{
    features::experiments::{
        state::{Armed, Experiments, Shown},
        table, texts,
    },
    model::{guards::in_loop_blocked_by, snapshot::Session, terms},
    ui::{
        clock::{act_ms, page_now_ms},
        listener::{is_of_window, on_window},
        reactive::effect,
    },
};

/// Setpoints per second that each motor needs.
const RATE_MIN_HZ: f64 = 50.0;
/// How long after Pause the same button resumes.
const RESUME_AFTER_MS: f64 = 600.0;

impl Experiments {
    /// Gets the messages of the run, and reports a lost focus to it.
    pub(super) fn listen(self) {
        self.receive_messages();
        // While armed too: Run may have been pressed just before.
        let lost = move || {
            if self.shown.try_get_untracked().is_some_and(Shown::is_open) {
                self.post(&ToRun::FocusLost);
            }
        };
        on_window("blur", move |event| {
            if is_of_window(&event) {
                lost();
            }
        });
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
                let settings = self.options(study);
                let limits = self.limits(plan.limits());
                self.armed.with_untracked(|armed| {
                    armed.as_ref().is_some_and(|armed| {
                        armed.study == *study
                            && armed.plan == *plan
                            && armed.options == settings
                            && armed.limits == limits
                    })
                })
            });
            if !is_same && self.is_armed() {
                self.abort();
                self.said.set(
                    tr!("Disarmed: another tab is open, or a value has changed. Press Arm again.")
                        .to_owned(),
                );
            }
        });
    }

    pub(super) fn is_armed(self) -> bool {
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
    pub(super) fn options(self, study: &Study) -> Options {
        let rate = self.rate.get().clamp(1, 500);
        Options {
            period: Duration::from_secs(1) / rate,
            stop_on_lost_focus: self.stop_on_lost_focus.get(),
            silent_steps: study.silent_steps(),
        }
    }

    /// The lower of the limits of the page and of a sequence.
    pub(super) fn limits(self, own: RunLimits) -> RunLimits {
        let of_page = self.page.settings;
        let lower =
            |own: Option<f64>, of_page: f64| Some(own.map_or(of_page, |own| own.min(of_page)));
        RunLimits {
            rpm: lower(own.rpm, of_page.speed_limit.get().into()),
            amps: lower(own.amps, f64::from(of_page.current_limit.get()) / 1000.0),
            celsius: lower(own.celsius, of_page.temperature_limit.get().into()),
        }
    }

    /// What the line carries of the rate that is asked for, by what was measured of its motors. It is tracked.
    pub(super) fn carried(self, plan: &Plan) -> Option<CarriedRate> {
        let rate = CommandRate::new(u16::try_from(self.rate.get()).ok()?).ok()?;
        let driven: Vec<(MotorId, Mode)> = plan
            .motors()
            .iter()
            .map(|motor| (motor.id, motor.mode()))
            .collect();
        let model = self.page.model.get();
        self.page
            .shown
            .with(|session| CarriedRate::of(model, &session.motors, &driven, rate))
    }

    /// Why the run cannot be armed, and the switch of a loop that would help.
    pub(super) fn blocked_by(self) -> Option<(String, Option<(MotorId, Mode)>)> {
        if self.shown.get().is_driving() {
            return Some((
                tr!("A run is in progress. Abort it first.").to_owned(),
                None,
            ));
        }
        let wrong = self.wrong_fields.with(|wrong| wrong.first().copied());
        if let Some(field) = wrong {
            return Some((tr!("{field}: enter a number.", field), None));
        }
        let plan = self.checked.with(|checked| match checked {
            Some(Ok((_, plan))) => Ok((plan.motors().to_vec(), self.carried(plan))),
            Some(Err(error)) => Err(texts::refused(error, self.row_of(&error.place))),
            None => Err(String::new()),
        });
        let (motors, carried) = match plan {
            Ok(found) => found,
            Err(words) => return Some((words, None)),
        };
        let of_motor = self.page.shown.with(|session| {
            motors.iter().find_map(|motor| {
                let (id, mode) = (motor.id, motor.mode());
                let reason = in_loop_blocked_by(session, id, mode)?;
                let is_other_loop = session.mode(id).is_some_and(|now| now.value != mode);
                Some((reason, is_other_loop.then_some((id, mode))))
            })
        });
        let too_slow = || {
            let carried = carried.filter(|carried| carried.hertz < RATE_MIN_HZ)?;
            let reason = tr!(
                "The line carries {rate} setpoints a second for each of {count} motors, and they need 50. Choose fewer motors.",
                rate = texts::rate(carried),
                count = motors.len()
            );
            Some((reason, None))
        };
        // The bus would refuse the setpoint in the middle of the run.
        let too_fast = || {
            let limit = self
                .page
                .preferences
                .with(|chosen| chosen.limits)
                .speed_rpm();
            let is_beyond = |motor: &PlanMotor| {
                let most = motor.least.abs().max(motor.greatest.abs());
                motor.quantity == Quantity::Rpm && most > limit.into()
            };
            let reason = || terms::refusal(Refusal::AboveSpeedLimit(limit));
            motors.iter().any(is_beyond).then(|| (reason(), None))
        };
        too_fast().or(of_motor).or_else(too_slow)
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
        let options = untrack(|| self.options(&study));
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
            limits: untrack(|| self.limits(plan.limits())),
            carried: untrack(|| self.carried(&plan)),
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
            Some(Phase::Running) => {
                self.paused_ms.set_value(page_now_ms());
                self.post(&ToRun::Pause);
            }
            // The button is the same. The second click of a double click must not start motion.
            Some(Phase::Paused)
                if page_now_ms() - self.paused_ms.get_value() >= RESUME_AFTER_MS =>
            {
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
