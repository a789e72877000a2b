//! What an operator does in the panel `Drive together`, and what the page does about it.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    Connection, Notice,
    bus::{Activity, Command, Consent, Ramp},
    protocol::MotorId,
};
use web_sys::VisibilityState;

use crate::{
    features::groups::{
        gamepads,
        pad::{By, DrivePad, GAMEPADS_MAX, Order, Stick, Wheels},
    },
    model::{
        desk::{Desk, FIRST_SPEED_RPM},
        drawer::Drawer,
        fleet::{Crew, Fleet, Member, Side, parts},
        guards::{why_not_side, why_not_steer, why_not_stop, why_not_together},
        notice_board::Topic,
        preferences::{remember, remembered},
        target::Target,
    },
    ui::animation::Next,
};

/// Under this name the browser keeps the ramp.
const RAMP_STORED_AS: &str = "ramp";

/// A gamepad that was not looked at for so long may have been let go and pressed again meanwhile. As
/// long as an act may be old that moves a wheel.
const GAMEPAD_UNSEEN_MAX_MS: f64 = 500.0;

/// Wakes the pad's frames.
type Waker = Box<dyn Fn()>;

/// What was entered for motors that drive together, and those that do.
#[derive(Clone, Copy)]
pub(crate) struct TogetherEntry {
    pub(crate) fleet: RwSignal<Fleet>,
    /// Told when the fleet is another one altogether, rather than changed by the panel's rows.
    pub(crate) replaced: RwSignal<u32>,
    /// Of the group, in rpm; its magnitude is the pad's limit.
    pub(crate) speed: Target,
    /// In rpm a second; 0 is none.
    pub(crate) ramp: Target,
    /// Whether gamepads are looked at.
    gamepad: StoredValue<bool>,
    /// Where the stick is while it drives, and what was sent for it.
    pub(crate) driving: RwSignal<Option<(Stick, Wheels)>>,
    pub(crate) waker: StoredValue<Option<Waker>, LocalStorage>,
    pad: StoredValue<DrivePad>,
    group: StoredValue<Group>,
    gamepads_seen_ms: StoredValue<f64>,
}

/// The motors that were started together last, until they are known not to drive any more. What a
/// person ticks meanwhile does not concern them.
#[derive(Clone, Debug, Default)]
struct Group {
    crew: Crew,
    /// Whether all were seen driven since.
    seen_driven: bool,
}

impl TogetherEntry {
    pub(crate) fn load() -> Self {
        let ramp = remembered(RAMP_STORED_AS).and_then(|text| text.parse::<u16>().ok());
        Self {
            fleet: RwSignal::new(Fleet::load()),
            replaced: RwSignal::new(0),
            speed: Target::new(FIRST_SPEED_RPM),
            ramp: Target::new(ramp.unwrap_or_default().min(Ramp::MAX).into()),
            gamepad: StoredValue::new(false),
            driving: RwSignal::new(None),
            waker: StoredValue::new_local(None),
            pad: StoredValue::new(DrivePad::default()),
            group: StoredValue::new(Group::default()),
            gamepads_seen_ms: StoredValue::new(0.0),
        }
    }

    fn ramp(self) -> Option<Ramp> {
        let rpm_a_second = u16::try_from(self.ramp.get_untracked()).ok()?;
        Ramp::new(rpm_a_second).ok()
    }

    /// Whether this motor drives as one of several.
    pub(crate) fn drives(self, id: MotorId) -> bool {
        self.group
            .with_value(|group| group.crew.iter().any(|(other, _)| *other == id))
    }
}

impl Desk {
    pub(crate) fn change_member(self, id: MotorId, change: impl FnOnce(&mut Member)) {
        self.together.fleet.update(|fleet| fleet.change(id, change));
        self.together.fleet.with_untracked(Fleet::save);
    }

    /// Not while the motor is driven: the next adjustment would turn it round.
    pub(crate) fn set_side(self, id: MotorId, side: Side) {
        let reason = why_not_side(&self.present(), id).or_else(|| self.why_not_turn_sides());
        if let Some(reason) = reason {
            self.refuse(tr!("The side of motor {id} was not changed", id), reason);
            return;
        }
        self.change_member(id, |member| member.side = side);
        // What is shown of it may have another sign from now on.
        self.show();
    }

    /// Takes another fleet in the place of the one there is.
    pub(crate) fn replace_fleet(self, fleet: Fleet) {
        fleet.save();
        self.together.fleet.set(fleet);
        self.together.replaced.update(|times| *times += 1);
        // What is shown of it may have another sign from now on.
        self.show();
    }

    /// Drives all members to the entered speed, each in its direction.
    pub(crate) fn start_together(self) {
        let crew = self.together.fleet.with_untracked(Fleet::crew);
        if let Some(reason) = why_not_together(&self.present(), &crew) {
            self.refuse(tr!("Nothing was driven").to_owned(), reason);
            return;
        }
        let rpm = self.together.speed.get_untracked();
        self.begin_group(crew, ahead(rpm));
    }

    /// Gives a group that is driven the entered speed; starts nothing.
    pub(crate) fn adjust_together(self) {
        if self.together.group.with_value(|group| group.seen_driven) {
            self.adjust_group(ahead(self.together.speed.get_untracked()));
        }
    }

    /// Stops the group that drives, by one of its members, and those who are ticked.
    pub(crate) fn stop_together(self) {
        let ticked = self.together.fleet.with_untracked(Fleet::crew);
        let group = self.together.group.get_value().crew;
        self.stop_group();
        for (id, _) in ticked {
            if !group.iter().any(|(other, _)| *other == id) {
                self.command(Command::Stop(id));
            }
        }
    }

    fn begin_group(self, crew: Crew, wheels: Wheels) {
        let Ok(parts) = parts(&crew, wheels) else {
            return;
        };
        self.command(Command::DriveTogether {
            parts,
            consent: Consent::None,
        });
        self.together.group.set_value(Group {
            crew,
            seen_driven: false,
        });
        self.notices.update(|board| {
            for topic in [Topic::Command, Topic::Stop] {
                board.withdraw(topic);
            }
        });
    }

    fn adjust_group(self, wheels: Wheels) {
        let crew = self.together.group.get_value().crew;
        if let Ok(parts) = parts(&crew, wheels) {
            self.command(Command::AdjustTogether {
                parts,
                consent: Consent::None,
            });
        }
    }

    /// A stop of one stops all that drive with it.
    fn stop_group(self) {
        let group = self.together.group.get_value();
        if let Some((id, _)) = group.crew.first() {
            self.command(Command::Stop(*id));
        }
        self.together.group.set_value(Group::default());
    }

    pub(crate) fn set_ramp(self) {
        let ramp = self.together.ramp.get_untracked();
        remember(RAMP_STORED_AS, &ramp.to_string());
        let connected = self
            .latest
            .with_value(|session| why_not_stop(session).is_none());
        if connected {
            self.command(Command::SetRamp(self.together.ramp()));
        }
    }

    /// The bus of a port that was opened has the ramp of the port before: what was entered meanwhile counts,
    /// also if that is none.
    pub(crate) fn send_ramp(self) {
        self.command(Command::SetRamp(self.together.ramp()));
    }

    /// How fast the pad may drive now.
    fn pad_limit(self) -> Option<i32> {
        let crew = self.together.fleet.with_untracked(Fleet::crew);
        let allowed = why_not_steer(&self.present(), &crew).is_none();
        allowed.then(|| self.together.speed.get_untracked())
    }

    fn with_pad(self, act: impl FnOnce(&mut DrivePad) -> Option<Order>) {
        let order = self.together.pad.try_update_value(act).flatten();
        match order {
            Some(Order::Stop) => self.stop_group(),
            Some(Order::Start(wheels)) => {
                let crew = self.together.fleet.with_untracked(Fleet::crew);
                self.begin_group(crew, wheels);
            }
            Some(Order::Adjust(wheels)) => self.adjust_group(wheels),
            None => {}
        }
        let driving = self.together.pad.with_value(DrivePad::driving);
        if self.together.driving.get_untracked() != driving {
            self.together.driving.set(driving);
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

    pub(crate) fn pad_let_go(self, by: By) {
        self.with_pad(|pad| pad.let_go(by));
    }

    pub(crate) fn pad_arrow(self, key: &str, is_down: bool) {
        self.with_pad(|pad| pad.arrow(key, is_down, &|| self.pad_limit()));
        self.wake_pad();
    }

    /// The focus or the page is lost, or something lies over the pad.
    pub(crate) fn leave_pad(self) {
        self.with_pad(DrivePad::leave);
    }

    /// Looks at gamepads from now on, or no more.
    pub(crate) fn look_at_gamepads(self, looks: bool) {
        self.together.gamepad.set_value(looks);
        if !looks {
            self.gamepad_unplugged();
        }
        self.wake_pad();
    }

    /// Whichever it was: one that is held has to be pressed anew.
    pub(crate) fn gamepad_unplugged(self) {
        self.with_pad(DrivePad::look_away);
    }

    pub(crate) fn wake_pad(self) {
        self.together.waker.with_value(|waker| {
            if let Some(wake) = waker {
                wake();
            }
        });
    }

    /// Once a frame: looks at the gamepads where that is wanted, and tells the bus what has changed.
    pub(crate) fn pad_frame(self, now_ms: f64) -> Next {
        let looks = self.together.gamepad.get_value()
            && self.drawer.get_untracked() == Some(Drawer::Together)
            && self.dialog.with_untracked(Option::is_none)
            && document().visibility_state() == VisibilityState::Visible
            // A gamepad is heard by every page and program; it drives where a person is.
            && document().has_focus().unwrap_or(false);
        let unseen_ms = now_ms - self.together.gamepads_seen_ms.get_value();
        if !looks || unseen_ms > GAMEPAD_UNSEEN_MAX_MS {
            self.with_pad(DrivePad::look_away);
        }
        if looks {
            self.together.gamepads_seen_ms.set_value(now_ms);
            for (place, seen) in (0..GAMEPADS_MAX).zip(gamepads::look()) {
                self.with_pad(|pad| pad.gamepad(place, seen, &|| self.pad_limit()));
            }
        }
        self.with_pad(DrivePad::frame);
        if looks || self.together.pad.with_value(DrivePad::is_held) {
            Next::Frame
        } else {
            Next::Woken
        }
    }

    /// All motors are stopped, or no longer ours: nothing is held, and nobody is left to stop.
    pub(crate) fn forget_group(self) {
        self.together.group.set_value(Group::default());
        self.with_pad(|pad| {
            pad.stopped();
            None
        });
    }

    /// What the bus did not do ends the hold: it would go on with what was sent before.
    pub(crate) fn hear_of_group(self, notice: &Notice) {
        let (Notice::Refused { command, .. } | Notice::TooLate(command)) = notice else {
            return;
        };
        let starts = matches!(command, Command::DriveTogether { .. });
        if starts || matches!(command, Command::AdjustTogether { .. }) {
            self.with_pad(DrivePad::end);
        }
        if starts {
            self.together.group.set_value(Group::default());
        }
    }

    /// Takes in whether the group still drives, behind all notices of one message.
    pub(crate) fn look_after_group(self) {
        let group = self.together.group.get_value();
        if group.crew.is_empty() {
            return;
        }
        let (gone, driven) = self.latest.with_value(|session| {
            let gone = !matches!(session.connection, Connection::Connected(_))
                || session.halted
                || session.survey.is_some();
            let driven = group.crew.iter().all(|(id, _)| {
                let activity = session.motor(*id).map(|motor| motor.activity);
                matches!(activity, Some(Activity::Driven { .. }))
            });
            (gone, driven)
        });
        if gone {
            self.forget_group();
        } else if driven {
            self.together
                .group
                .update_value(|group| group.seen_driven = true);
        } else if group.seen_driven {
            // The bus stops all where one does not go on; a hold says so once more.
            self.with_pad(DrivePad::end);
            self.together.group.set_value(Group::default());
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
