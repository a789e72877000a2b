//! Actions of the panel `Drive together`.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    Connection, Notice,
    bus::{Activity, Command, CommandKind, Consent, GroupSetpoints},
};
use web_sys::VisibilityState;

use crate::{
    features::groups::{
        gamepads,
        pad::{By, DrivePad, GAMEPADS_MAX, Order, Stick},
        wheels::{Wheels, group_setpoints},
    },
    model::{
        drive_settings::FIRST_SPEED_RPM,
        guards::{group_drive_blocked_by, steer_blocked_by},
        names_and_sides::{GroupMembers, NamesAndSides},
        notice_board::Topic,
        page::Page,
    },
    ui::{animation::Next, target::Target},
};

/// A gamepad that was not polled for this long may have been released and pressed again meanwhile. The same
/// time as the maximal age of a command that moves a wheel.
const GAMEPAD_UNSEEN_MAX_MS: f64 = 500.0;

/// Wakes the pad's frames.
type Waker = Box<dyn Fn()>;

/// The last started group, until it is known that it no longer drives. Later changes of the selection do not
/// change it.
#[derive(Clone, Debug, Default)]
struct Group {
    members: GroupMembers,
    /// Whether all have been reported since as driven, or as waiting to be.
    seen_started: bool,
}

/// The panel `Drive together`: the entered speed and the group.
#[derive(Clone, Copy)]
pub(crate) struct Groups {
    pub(crate) page: Page,
    /// The speed of the group in rpm; its magnitude is the limit of the pad, unless the speed limit is lower.
    pub(crate) speed: Target,
    /// Whether gamepads are polled.
    gamepad: StoredValue<bool>,
    /// The stick while it drives, and the speeds that were sent.
    pub(crate) driving: RwSignal<Option<(Stick, Wheels)>>,
    pub(crate) waker: StoredValue<Option<Waker>, LocalStorage>,
    pad: StoredValue<DrivePad>,
    group: StoredValue<Group>,
    gamepads_seen_ms: StoredValue<f64>,
}

impl Groups {
    pub(crate) fn new(page: Page) -> Self {
        Self {
            page,
            speed: Target::new(FIRST_SPEED_RPM),
            gamepad: StoredValue::new(false),
            driving: RwSignal::new(None),
            waker: StoredValue::new_local(None),
            pad: StoredValue::new(DrivePad::default()),
            group: StoredValue::new(Group::default()),
            gamepads_seen_ms: StoredValue::new(0.0),
        }
    }

    fn set_group(self, group: Group) {
        let ids = group.members.iter().map(|(id, _)| *id).collect();
        self.page.motors.driven_together.set_value(ids);
        self.group.set_value(group);
    }

    /// Drives the group at the entered speed, each motor in its direction.
    pub(crate) fn start_together(self) {
        let members = self
            .page
            .motors
            .names
            .with_untracked(NamesAndSides::group_members);
        if let Some(reason) = group_drive_blocked_by(&self.page.present(), &members) {
            self.page
                .refuse(tr!("Group not started").to_owned(), reason);
            return;
        }
        let wheels = ahead(self.speed.get_untracked());
        self.begin_group(members, wheels, |setpoints, consent| Command::StartGroup {
            setpoints,
            consent,
        });
    }

    /// Adjusts a group that is driven or waits to the entered speed; starts nothing.
    pub(crate) fn adjust_together(self) {
        if self.group.with_value(|group| group.seen_started) {
            self.adjust_group(ahead(self.speed.get_untracked()));
        }
    }

    /// Stops the driven group, by one of its members, and the selected motors.
    pub(crate) fn stop_together(self) {
        let ticked = self
            .page
            .motors
            .names
            .with_untracked(NamesAndSides::group_members);
        let group = self.group.get_value().members;
        self.stop_group();
        for (id, _) in ticked {
            if !group.iter().any(|(other, _)| *other == id) {
                self.page.command(Command::Stop(id));
            }
        }
    }

    fn begin_group(
        self,
        members: GroupMembers,
        wheels: Wheels,
        command: fn(GroupSetpoints, Consent) -> Command,
    ) {
        let Ok(setpoints) = group_setpoints(&members, wheels) else {
            return;
        };
        self.page.command(command(setpoints, Consent::None));
        self.set_group(Group {
            members,
            seen_started: false,
        });
        self.page.notices.update(|board| {
            for topic in [Topic::Command, Topic::Stop] {
                board.withdraw(topic);
            }
        });
    }

    fn adjust_group(self, wheels: Wheels) {
        let members = self.group.get_value().members;
        if let Ok(setpoints) = group_setpoints(&members, wheels) {
            self.page.command(Command::AdjustGroup {
                setpoints,
                consent: Consent::None,
            });
        }
    }

    /// A stop of one motor stops its whole group.
    fn stop_group(self) {
        let group = self.group.get_value();
        if let Some((id, _)) = group.members.first() {
            self.page.command(Command::Stop(*id));
        }
        self.set_group(Group::default());
    }

    /// The maximal speed of the pad now.
    fn pad_limit(self) -> Option<i32> {
        let members = self
            .page
            .motors
            .names
            .with_untracked(NamesAndSides::group_members);
        let allowed = steer_blocked_by(&self.page.present(), &members).is_none();
        let limit = untrack(|| self.page.speed_limit());
        allowed.then(|| self.speed.get_untracked().abs().min(limit))
    }

    fn with_pad(self, act: impl FnOnce(&mut DrivePad) -> Option<Order>) {
        let order = self.pad.try_update_value(act).flatten();
        match order {
            Some(Order::Stop) => self.stop_group(),
            Some(Order::Start(wheels)) => {
                let members = self
                    .page
                    .motors
                    .names
                    .with_untracked(NamesAndSides::group_members);
                // What is held drives at once or is refused: it never waits for a stop.
                self.begin_group(members, wheels, |setpoints, consent| Command::DriveGroup {
                    setpoints,
                    consent,
                });
            }
            Some(Order::Adjust(wheels)) => self.adjust_group(wheels),
            None => {}
        }
        let driving = self.pad.with_value(DrivePad::driving);
        if self.driving.get_untracked() != driving {
            self.driving.set(driving);
            self.page.motors.steered.set(driving.is_some());
        }
    }

    pub(crate) fn pad_pressed(self, by: By, stick: Stick) {
        self.with_pad(|pad| pad.press(by, stick, &|| self.pad_limit()));
        self.wake_pad();
    }

    pub(crate) fn pad_steered(self, by: By, stick: Stick) {
        self.with_pad(|pad| {
            pad.steer(by, stick);
            None
        });
    }

    pub(crate) fn release_pad(self, by: By) {
        self.with_pad(|pad| pad.release(by));
    }

    pub(crate) fn pad_arrow(self, key: &str, is_down: bool) {
        self.with_pad(|pad| pad.arrow(key, is_down, &|| self.pad_limit()));
        self.wake_pad();
    }

    /// The pad has lost the focus, or the page is hidden, or something covers the pad.
    pub(crate) fn leave_pad(self) {
        self.with_pad(DrivePad::leave);
    }

    /// Starts or stops polling gamepads.
    pub(crate) fn set_gamepads_enabled(self, looks: bool) {
        self.gamepad.set_value(looks);
        if !looks {
            self.gamepad_unplugged();
        }
        self.wake_pad();
    }

    /// Any gamepad may be the unplugged one, so all are released.
    pub(crate) fn gamepad_unplugged(self) {
        self.with_pad(DrivePad::release_gamepads);
    }

    pub(crate) fn wake_pad(self) {
        self.waker.with_value(|waker| {
            if let Some(wake) = waker {
                wake();
            }
        });
    }

    /// Runs once per frame of the screen: polls the gamepads if they are enabled, and sends what has changed.
    pub(crate) fn pad_frame(self, now_ms: f64) -> Next {
        let looks = self.gamepad.get_value()
            && untrack(|| self.page.shows_group())
            && self.page.dialog.with_untracked(Option::is_none)
            && document().visibility_state() == VisibilityState::Visible
            // All pages and programs receive a gamepad; it drives only on the focused page.
            && document().has_focus().unwrap_or(false);
        let unseen_ms = now_ms - self.gamepads_seen_ms.get_value();
        if !looks || unseen_ms > GAMEPAD_UNSEEN_MAX_MS {
            self.with_pad(DrivePad::release_gamepads);
        }
        if looks {
            self.gamepads_seen_ms.set_value(now_ms);
            for (place, seen) in (0..GAMEPADS_MAX).zip(gamepads::poll()) {
                self.with_pad(|pad| pad.gamepad(place, seen, &|| self.pad_limit()));
            }
        }
        self.with_pad(DrivePad::frame);
        if looks || self.pad.with_value(DrivePad::is_held) {
            Next::Frame
        } else {
            Next::Woken
        }
    }

    /// All motors are stopped or the connection is lost: ends the hold without another stop.
    pub(crate) fn forget(self) {
        self.set_group(Group::default());
        self.with_pad(|pad| {
            pad.stopped();
            None
        });
    }

    /// A refused command ends the hold, because the motors would continue with the previous setpoints.
    pub(crate) fn notice(self, notice: &Notice) {
        let (Notice::Refused { command, .. } | Notice::TooLate(command)) = notice else {
            return;
        };
        let starts = matches!(command, CommandKind::DriveGroup);
        if starts || matches!(command, CommandKind::AdjustGroup) {
            self.with_pad(DrivePad::end);
        }
        if starts {
            self.set_group(Group::default());
        }
    }

    /// Updates whether the group still drives or waits, after all notices of one message.
    pub(crate) fn check_group(self) {
        let group = self.group.get_value();
        if group.members.is_empty() {
            return;
        }
        let (gone, started) = self.page.latest.with_value(|session| {
            let gone = !matches!(session.connection, Connection::Connected(_))
                || session.halted
                || session.job.is_some();
            let started = group.members.iter().all(|(id, _)| {
                session.motor(*id).is_some_and(|motor| {
                    let is_driven = matches!(motor.activity, Activity::Driven { .. });
                    is_driven || motor.waiting.is_some()
                })
            });
            (gone, started)
        });
        if gone {
            self.forget();
        } else if started {
            self.group.update_value(|group| group.seen_started = true);
        } else if group.seen_started {
            // The bus stops the whole group if one motor stops; a hold sends a stop as well.
            self.with_pad(DrivePad::end);
            self.set_group(Group::default());
        }
    }
}

/// Straight ahead.
const fn ahead(rpm: i32) -> Wheels {
    Wheels {
        left: rpm,
        right: rpm,
    }
}
