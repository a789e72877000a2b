//! What an operator does, turned into commands.

use crate::{
    app::keys::Act,
    features::drive::one_stop::stop_of,
    model::{
        desk::{Desk, Dialog, Targets},
        guards::{why_not_drive, why_not_stop, why_not_switch},
        notice_board::{NoticeText, Tone, Topic},
        notice_lifetime::Until,
        notice_texts as words,
        tab::Tab,
        target::Target,
        terms,
    },
};
use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    ToWorker,
    bus::{Activity, Command, CommandRate, Consent, Limits, StopReason, needs_consent},
    protocol::{Acceleration, CurrentTarget, Mode, MotorId, PositionTarget, Setpoint, SpeedTarget},
};

impl Targets {
    /// What is entered for this loop.
    pub(crate) fn setpoint(self, mode: Mode) -> Setpoint {
        match mode {
            Mode::Velocity => Setpoint::Velocity {
                speed: SpeedTarget::clamped(self.speed.get_untracked()),
                acceleration: Acceleration::new(
                    u8::try_from(self.acceleration.get_untracked()).unwrap_or_default(),
                ),
            },
            Mode::Current => Setpoint::Current(
                CurrentTarget::new(self.current.get_untracked()).unwrap_or_default(),
            ),
            Mode::Position => Setpoint::Position(
                PositionTarget::new(self.position.get_untracked()).unwrap_or_default(),
            ),
        }
    }

    /// The speed of the keys F and B.
    fn preset_rpm(self) -> i32 {
        match self.speed.get_untracked().abs() {
            0 => crate::model::desk::FIRST_SPEED_RPM,
            rpm => rpm,
        }
    }
}

impl Desk {
    /// Stops all motors. The message is posted before anything else is done.
    pub(crate) fn stop_all(self, reason: StopReason) {
        if reason == StopReason::Operator && self.link.with_value(Option::is_none) {
            self.stopped_early.set_value(true);
        }
        self.command(Command::StopAll(reason));
        self.asked.set(None);
        self.dialog.set(None);
        self.give_up_id_change();
        self.raw.await_nothing();
        self.forget_group();
    }

    /// A stop that was asked for before the worker was there stands before anything can be driven.
    pub(crate) fn stop_if_asked_early(self) {
        if self.stopped_early.get_value() {
            self.command(Command::StopAll(StopReason::Operator));
        }
    }

    pub(crate) fn release(self) {
        self.command(Command::Release);
    }

    /// Drives the chosen motor to what is entered for this loop.
    pub(crate) fn start(self, mode: Mode) {
        self.drive(self.targets.setpoint(mode));
    }

    pub(crate) fn drive_at(self, rpm: i32) {
        self.targets.speed.set(rpm);
        self.start(Mode::Velocity);
    }

    /// Drives the chosen motor, after a question where the setpoint needs one, and says why where
    /// it cannot be driven.
    pub(crate) fn drive(self, setpoint: Setpoint) {
        let id = self.selected.get_untracked();
        if let Some(reason) = why_not_drive(&self.present(), id, setpoint.mode()) {
            self.refuse(tr!("Motor {id} was not driven", id), reason);
            return;
        }
        if let (Setpoint::Current(target), Consent::HighCurrent) =
            (setpoint, needs_consent(setpoint))
        {
            self.dialog.set(Some(Dialog::HighCurrent { id, target }));
            return;
        }
        self.drive_with(id, setpoint, Consent::None);
    }

    /// The operator agrees to what the open dialog asks. Once: the dialog is closed by it.
    pub(crate) fn agree(self) {
        let asked = self.dialog.get_untracked();
        self.dialog.set(None);
        match asked {
            Some(Dialog::HighCurrent { id, target }) => {
                self.drive_with(id, Setpoint::Current(target), Consent::HighCurrent);
            }
            Some(Dialog::ChangeId(_)) => self.set_proved_id(),
            Some(Dialog::Hazard(order)) => self.send_hazard(order),
            Some(Dialog::HighRawCurrent { order, .. }) => {
                self.send_order(order, Consent::HighCurrent);
            }
            Some(Dialog::ClearLog(_)) => self.clear_log(),
            Some(Dialog::EraseKept) => self.erase_kept(),
            Some(Dialog::Help(_)) | None => {}
        }
    }

    /// The operator does not want what the open dialog asks.
    pub(crate) fn decline(self) {
        self.dialog.set(None);
        self.give_up_id_change();
    }

    /// Withdraws a question about motors: another is looked at, or they may be others on this connection.
    pub(crate) fn withdraw_question(self) {
        let open = self.dialog.get_untracked();
        if open.is_some_and(Dialog::is_about_motors) {
            self.decline();
        }
    }

    fn drive_with(self, id: MotorId, setpoint: Setpoint, consent: Consent) {
        self.command(Command::Drive {
            id,
            setpoint,
            consent,
        });
        self.notices.update(|board| {
            for topic in [Topic::Command, Topic::Setpoint(id), Topic::Stop] {
                board.withdraw(topic);
            }
        });
        self.follow(setpoint.mode());
    }

    /// Gives a motor that is driven in this loop the entered target; starts nothing.
    pub(crate) fn adjust(self, mode: Mode) {
        let setpoint = self.targets.setpoint(mode);
        let id = self.selected.get_untracked();
        let driven_so = self.latest.with_value(|session| {
            let activity = session.motor(id).map(|motor| motor.activity);
            matches!(activity, Some(Activity::Driven { setpoint }) if setpoint.mode() == mode)
        });
        // A drag does not reach a current that has to be asked about: Start does.
        if driven_so && needs_consent(setpoint) == Consent::None {
            self.command(Command::Adjust {
                id,
                setpoint,
                consent: Consent::None,
            });
        }
    }

    /// Stops the chosen motor as its loop allows: see [`stop_of`].
    pub(crate) fn stop_motor(self, tab: Tab) {
        if let Some(reason) = why_not_stop(&self.present()) {
            self.refuse(tr!("Nothing was stopped").to_owned(), reason);
            return;
        }
        let id = self.selected.get_untracked();
        let (activity, raw) = self.latest.with_value(|session| {
            let activity = session.motor(id).map(|motor| motor.activity);
            (activity, session.raw.is_some_and(|raw| raw.running))
        });
        if raw {
            self.command(Command::StopRaw);
        }
        if let Some(command) = stop_of(id, activity, tab) {
            if matches!(command, Command::Stop(_)) {
                self.asked.set(None);
            }
            self.command(command);
        }
    }

    pub(crate) fn switch(self, mode: Mode) {
        let id = self.selected.get_untracked();
        if let Some(reason) = why_not_switch(&self.present(), id, mode) {
            self.refuse(
                tr!("The {mode} was not asked for", mode = terms::mode(mode)),
                reason,
            );
            return;
        }
        self.asked.set(Some(mode));
        self.follow(mode);
        self.notices.update(|board| board.withdraw(Topic::Command));
        self.command(Command::SwitchMode { id, mode });
    }

    /// Chooses a motor and remembers it. One that is driven is stopped first.
    pub(crate) fn choose(self, id: MotorId) {
        if id == self.selected.get_untracked() {
            return;
        }
        let others: Vec<MotorId> = self.latest.with_value(|session| {
            // Those that drive together do so whichever of them is looked at.
            let driven = session.in_hand().filter(|motor| {
                !matches!(motor.activity, Activity::Stopping { .. })
                    && !self.together.drives(motor.id)
            });
            driven.map(|motor| motor.id).collect()
        });
        for other in others {
            self.command(Command::Stop(other));
            let until = Until::AtRest {
                motors: vec![other],
                withdrawn: None,
            };
            self.say_until(self.now(), words::of_choice_while_driven(other, id), until);
        }
        self.prefer(|preferences| preferences.motor = id);
        self.select(id);
    }

    /// Turns the page to a motor.
    pub(crate) fn select(self, id: MotorId) {
        self.withdraw_question();
        self.selected.set(id);
        self.asked.set(None);
        self.notices.update(|board| board.withdraw(Topic::Answer));
        self.tab_to_follow.set_value(true);
        self.forget_motor();
        self.post(&ToWorker::Select(id));
        self.show();
    }

    pub(crate) fn set_rate(self, hertz: i32) {
        let rate = u16::try_from(hertz).ok().map(CommandRate::new);
        if let Some(Ok(rate)) = rate {
            self.prefer(|preferences| preferences.rate = rate);
            self.send_rate();
        }
    }

    /// Tells the bus the rate; it has to be told anew whenever a port was opened.
    pub(crate) fn send_rate(self) {
        let rate = self.preferences.with_untracked(|chosen| chosen.rate);
        let connected = self
            .latest
            .with_value(|session| why_not_stop(session).is_none());
        if connected {
            self.command(Command::SetRate(rate));
        }
    }

    /// Takes the limits that were entered. Each is in its range.
    pub(crate) fn set_limits(self) {
        let whole = |target: Target| u16::try_from(target.get_untracked()).unwrap_or(0);
        let limits = Limits::new(
            whole(self.targets.speed_limit),
            whole(self.targets.current_limit),
            whole(self.targets.temperature_limit),
        );
        if let Ok(limits) = limits {
            self.prefer(|preferences| preferences.limits = limits);
            self.send_limits();
        }
    }

    /// The worker keeps them for every port that is opened.
    pub(crate) fn send_limits(self) {
        let limits = self.preferences.with_untracked(|chosen| chosen.limits);
        self.command(Command::SetLimits(limits));
    }

    /// Does what a key asks for.
    pub(crate) fn act(self, act: Act) {
        match act {
            Act::Forward => self.drive_at(self.targets.preset_rpm()),
            Act::Backward => self.drive_at(-self.targets.preset_rpm()),
            Act::Preset(rpm) => self.drive_at(rpm),
            Act::Stop => self.stop_motor(self.tab.get_untracked()),
            Act::Brake => self.drive(Setpoint::Brake),
            Act::Switch(mode) => self.switch(mode),
            Act::Help => self.dialog.set(Some(Dialog::Help(None))),
        }
    }

    pub(crate) fn refuse(self, title: String, reason: String) {
        self.say(NoticeText {
            topic: Topic::Command,
            tone: Tone::Warning,
            title,
            advice: vec![reason],
            remedy: None,
            help: None,
        });
    }
}
