//! Turns actions of the operator into commands.

use crate::{
    features::drive::{limit::speed_refused, one_stop::stop_of},
    model::{
        drive_settings::FIRST_SPEED_RPM,
        guards::{drive_blocked_by, stop_blocked_by},
        local_storage::{remember, remembered},
        notice_board::Topic,
        page::{Dialog, Page},
    },
    ui::{
        entry::{self, Entry},
        target::Target,
    },
};
use derive_more::Deref;
use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    bus::{Activity, Command, Consent, MotorStatus, needs_consent},
    protocol::{
        Acceleration, CurrentTarget, Mode, MotorId, OpenLoopTarget, PositionTarget, Setpoint,
        SpeedTarget,
    },
};

/// The storage key of the targets: speed, acceleration, current and position, with spaces between.
const STORED_AS: &str = "targets";

/// The motor's fastest acceleration, which is also its default.
const FIRST_ACCELERATION: i32 = 1;

/// The last entered values for each loop, always in range.
#[derive(Clone, Copy)]
pub(crate) struct Targets {
    /// In rpm.
    pub(crate) speed: Target,
    /// Byte 6 of a drive frame.
    pub(crate) acceleration: Target,
    /// Raw current.
    pub(crate) current: Target,
    /// Raw position.
    pub(crate) position: Target,
    /// Raw. Not remembered: nothing limits the speed, so it begins at 0.
    pub(crate) open_loop: Target,
}

impl Targets {
    /// The values of the last visit, each in its range. They are shown only: they drive nothing by themselves.
    fn remembered() -> Self {
        let text = remembered(STORED_AS).unwrap_or_default();
        let mut numbers = text.split(' ').map(|number| number.parse().ok());
        let mut next = |entry: Entry, first: i32| {
            let number: Option<i32> = numbers.next().flatten();
            let in_range = number.filter(|number| (entry.min..=entry.max).contains(number));
            Target::new(in_range.unwrap_or(first))
        };
        Self {
            speed: next(entry::SPEED, FIRST_SPEED_RPM),
            acceleration: next(entry::ACCELERATION, FIRST_ACCELERATION),
            current: next(entry::CURRENT, 0),
            position: next(entry::POSITION, 0),
            open_loop: Target::new(0),
        }
    }

    fn remember(self) {
        let targets = [self.speed, self.acceleration, self.current, self.position];
        let numbers = targets.map(|target| target.get_untracked().to_string());
        remember(STORED_AS, &numbers.join(" "));
    }

    /// The entered setpoint of this loop.
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
            Mode::OpenLoop => {
                let raw = self.open_loop.get_untracked();
                Setpoint::OpenLoop(OpenLoopTarget::new(raw).unwrap_or_default())
            }
        }
    }

    /// The speed of the keys F and B.
    pub(crate) fn preset_rpm(self) -> i32 {
        match self.speed.get_untracked().abs() {
            0 => FIRST_SPEED_RPM,
            rpm => rpm,
        }
    }
}

/// The tabs that drive the selected motor, one for each loop.
#[derive(Clone, Copy, Deref)]
pub(crate) struct Drive(#[deref(forward)] &'static Parts);

/// The state of the tabs.
pub(crate) struct Parts {
    pub(crate) page: Page,
    pub(crate) targets: Targets,
}

impl Drive {
    pub(crate) fn new(page: Page) -> Self {
        let targets = Targets::remembered();
        Self(Box::leak(Box::new(Parts { page, targets })))
    }

    /// Drives the selected motor to the entered setpoint of this loop.
    pub(crate) fn start(self, mode: Mode) {
        self.targets.remember();
        self.drive(self.targets.setpoint(mode));
    }

    /// Drives the selected motor at this speed. A refused speed does not become the target.
    pub(crate) fn drive_at(self, rpm: i32) {
        let before = self.targets.speed.get_untracked();
        self.targets.speed.set(rpm);
        let refused = untrack(|| speed_refused(self.page, rpm));
        let setpoint = self.targets.setpoint(Mode::Velocity);
        if self.drive_unless(refused, setpoint) {
            self.targets.remember();
        } else {
            self.targets.speed.set(before);
        }
    }

    /// Drives the selected motor. Asks first if the setpoint needs consent, and shows the reason if it cannot be
    /// driven.
    pub(crate) fn drive(self, setpoint: Setpoint) {
        self.drive_unless(None, setpoint);
    }

    /// Returns whether it drives, or asks first.
    fn drive_unless(self, refused: Option<String>, setpoint: Setpoint) -> bool {
        let id = self.page.selected.get_untracked();
        let blocked = drive_blocked_by(&self.page.present(), id, setpoint.mode());
        if let Some(reason) = blocked.or(refused) {
            self.page.refuse(tr!("Motor {id} not started", id), reason);
            return false;
        }
        if let (Setpoint::Current(target), Consent::HighCurrent) =
            (setpoint, needs_consent(setpoint))
        {
            self.page
                .dialog
                .set(Some(Dialog::HighCurrent { id, target }));
            return true;
        }
        self.drive_with(id, setpoint, Consent::None);
        true
    }

    pub(crate) fn drive_with(self, id: MotorId, setpoint: Setpoint, consent: Consent) {
        self.page.command(Command::Start {
            id,
            setpoint,
            consent,
        });
        self.page.notices.update(|board| {
            for topic in [Topic::Command, Topic::Setpoint(id), Topic::Stop] {
                board.withdraw(topic);
            }
        });
        self.page.follow(setpoint.mode());
    }

    /// Adjusts a motor that is driven in this loop to the entered setpoint; starts nothing.
    pub(crate) fn adjust(self, mode: Mode) {
        self.targets.remember();
        let setpoint = self.targets.setpoint(mode);
        let id = self.page.selected.get_untracked();
        let driven_so = self.page.latest.with_value(|session| {
            let setpoint = session.motor(id).and_then(started_setpoint);
            setpoint.is_some_and(|setpoint| setpoint.mode() == mode)
        });
        // A drag is not sent if the current needs consent; Start asks for it.
        if driven_so && needs_consent(setpoint) == Consent::None {
            self.page.command(Command::Adjust {
                id,
                setpoint,
                consent: Consent::None,
            });
        }
    }

    /// Stops the selected motor as its loop allows: see [`stop_of`].
    pub(crate) fn stop_motor(self) {
        if let Some(reason) = stop_blocked_by(&self.page.present()) {
            self.page.refuse(tr!("Stop not sent").to_owned(), reason);
            return;
        }
        let id = self.page.selected.get_untracked();
        let (activity, raw) = self.page.latest.with_value(|session| {
            let activity = session.motor(id).map(|motor| motor.activity);
            (activity, session.raw.is_some_and(|raw| raw.running))
        });
        if raw {
            self.page.command(Command::StopRaw);
        }
        self.page.command(stop_of(id, activity));
    }

    /// Shows the tab of a loop, if the motor has it.
    pub(crate) fn show(self, mode: Mode) {
        if self.page.model.get_untracked().has(mode) {
            self.page.loops.tab.set(mode);
        }
    }
}

/// The setpoint that a motor is driven to, or that waits until it stands.
fn started_setpoint(motor: &MotorStatus) -> Option<Setpoint> {
    match motor.activity {
        Activity::Driven { setpoint } => Some(setpoint),
        _ => motor.waiting,
    }
}
