//! The actions of the setup, on the page and on the bus.

use std::time::Duration;

use derive_more::Deref;
use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    bus::{Command, Consent},
    protocol::{AssignableId, Mode, MotorId, Setpoint, SpeedTarget},
};

use crate::{
    features::wheel_setup::{
        state::{Activity, Setup},
        stored,
        wheel::with_wheels,
    },
    model::{
        guards::{drive_blocked_by, id_change_blocked_by},
        id_progress::IdProgress,
        names_and_sides::NamesAndSides,
        page::{Change, Listener, Page},
        place::Panel,
        snapshot::Session,
    },
    ui::{clock::page_now_ms, listener::on_window, reactive::effect},
};

/// A speed at which a hand can stop the wheel, and at which half a second is a visible sixth of a turn.
const SPIN_RPM: i32 = 20;
/// How long a wheel is driven.
const SPIN_MS: u16 = 500;

/// The actions of the ID manager, which is another feature.
pub(crate) struct IdManagerActions {
    /// Reads the progress, and tracks it.
    pub(crate) progress: Box<dyn Fn() -> IdProgress + Send + Sync>,
    /// Scans for the only motor, asks, and sets its ID. Returns whether this has started.
    pub(crate) set_id: Box<dyn Fn(AssignableId) -> bool + Send + Sync>,
    /// The same with more set-ID frames, for a motor that has kept its ID.
    pub(crate) set_with_more: Box<dyn Fn() -> bool + Send + Sync>,
    pub(crate) full_scan: Box<dyn Fn() + Send + Sync>,
    pub(crate) cancel: Box<dyn Fn() + Send + Sync>,
}

/// The panel `Set up the wheels of a rover`. It exists as long as the page.
#[derive(Clone, Copy, Deref)]
pub(crate) struct WheelSetup(#[deref(forward)] &'static Parts);

/// The state of the panel, and what it uses.
pub(crate) struct Parts {
    pub(crate) page: Page,
    pub(crate) ids: &'static IdManagerActions,
    pub(crate) setup: RwSignal<Setup>,
    /// How often the rows of the wheels were replaced.
    pub(crate) replaced: RwSignal<u32>,
    /// The number of spins, so that the timer of an earlier spin does not end a later one.
    spins: StoredValue<u32>,
    spun_at_ms: StoredValue<f64>,
}

impl WheelSetup {
    /// The setup of this page. The first call makes it, for the owner of the page.
    pub(crate) fn of_page(
        owner: &Owner,
        page: Page,
        ids: impl FnOnce() -> IdManagerActions,
    ) -> Self {
        owner.with(|| {
            use_context().unwrap_or_else(|| {
                let new = Self(Box::leak(Box::new(Parts {
                    page,
                    ids: Box::leak(Box::new(ids())),
                    setup: RwSignal::new(stored::load()),
                    replaced: RwSignal::new(0),
                    spins: StoredValue::new(0),
                    spun_at_ms: StoredValue::new(0.0),
                })));
                provide_context(new);
                new
            })
        })
    }

    /// Follows the bus and the page while the panel is mounted.
    pub(crate) fn follow(self) {
        let on_change = move |change: Change<'_>| match change {
            Change::Notice(notice) => {
                let to_stop = self.change(|setup| setup.on_notice(notice));
                self.stop(to_stop);
            }
            // The timer of the page may be late.
            Change::Updated => {
                if page_now_ms() - self.spun_at_ms.get_value() > f64::from(SPIN_MS) {
                    self.end_spin();
                }
            }
            Change::Disconnected => self.change(Setup::disconnected),
            Change::Motor
            | Change::Declined
            | Change::Place(_)
            | Change::Model
            | Change::Geometry => {}
        };
        self.page.listen(Listener::WheelSetup, Box::new(on_change));
        effect(move || {
            let ids = (self.ids.progress)();
            self.change(|setup| setup.on_ids(&ids));
        });
        // The user may not see the wheel: end the spin.
        effect(move || {
            let is_open = self.page.panel() == Some(Panel::WheelSetup);
            if !is_open || self.page.dialog.with(Option::is_some) {
                self.end_spin();
            }
        });
        on_window("visibilitychange", move |_| {
            if document().hidden() {
                self.end_spin();
            }
        });
        on_cleanup(move || self.end_spin());
    }

    /// Changes the state, and stores the progress if it differs.
    pub(crate) fn change<T>(self, change: impl FnOnce(&mut Setup) -> T) -> T {
        let before = self.setup.get_untracked();
        let mut after = before.clone();
        let result = change(&mut after);
        if after != before {
            if stored::to_text(&after) != stored::to_text(&before) {
                stored::save(&after);
            }
            self.setup.set(after);
        }
        result
    }

    /// Changes the wheels, and replaces their rows.
    pub(crate) fn replace_wheels(self, change: impl FnOnce(&mut Setup)) {
        self.change(change);
        self.replaced.update(|times| *times += 1);
    }

    /// Finds the only motor and sets the ID of the wheel.
    pub(crate) fn find(self) {
        if let Some(id) = self.change(Setup::find)
            && !(self.ids.set_id)(id)
        {
            self.scan_refused();
        }
    }

    /// The same with more set-ID frames.
    pub(crate) fn find_with_more(self) {
        if self.change(Setup::find).is_some() && !(self.ids.set_with_more)() {
            self.scan_refused();
        }
    }

    fn scan_refused(self) {
        let reason = self.page.latest.with_value(id_change_blocked_by);
        self.change(|setup| setup.refused(reason.unwrap_or_default()));
    }

    /// Scans for all motors.
    pub(crate) fn check(self) {
        if self.change(Setup::check) {
            (self.ids.full_scan)();
        }
    }

    /// Goes to the spins. Stores names and sides of the wheels on the page.
    pub(crate) fn begin_spins(self) {
        let answered = self.setup.with_untracked(|setup| setup.answered.clone());
        let Some(answered) = answered else { return };
        let selected = self.page.selected.get_untracked();
        if let Some(first) = answered.first().filter(|_| !answered.contains(&selected)) {
            self.page.choose(*first);
        }
        // Forgets motors that were unplugged after they got their ID: a silent motor counts as one that may turn, so no
        // wheel could be spun.
        let silent = |session: &Session| -> Vec<MotorId> {
            let silent = session.motors.iter().filter(|motor| motor.is_silent());
            silent.map(|motor| motor.id).collect()
        };
        for id in self.page.latest.with_value(silent) {
            if !answered.contains(&id) {
                self.page.command(Command::Forget(id));
            }
        }
        self.change(Setup::begin_spins);
        // If a motor moves, the first spin stores the names and sides.
        let _ = self.store_names();
    }

    /// Stores the names, sides and group of the wheels on the page. Returns the reason if it is refused.
    fn store_names(self) -> Result<(), String> {
        let names = self.page.motors.names;
        let wheels = self.setup.with_untracked(|setup| setup.wheels.clone());
        let wanted = names.with_untracked(|names| with_wheels(names, &wheels));
        if names.with_untracked(|names: &NamesAndSides| *names == wanted) {
            return Ok(());
        }
        let reason = self.page.side_changes_blocked_by().or_else(|| {
            let moves = !self.page.is_known_to_rest();
            moves.then(|| must_stand().to_owned())
        });
        match reason {
            None => {
                self.page.replace_names_and_sides(wanted);
                Ok(())
            }
            Some(reason) => Err(reason),
        }
    }

    /// Stores names, sides and the group. Shows the reason if that is refused. Returns whether they are stored.
    fn try_store_names(self) -> bool {
        let stored = self.store_names();
        let is_stored = stored.is_ok();
        if let Err(reason) = stored {
            self.change(|setup| setup.refused(reason));
        }
        is_stored
    }

    /// Drives a wheel slowly for half a second. Its side decides which direction is forward.
    pub(crate) fn spin(self, place: usize) {
        let wheel = self
            .setup
            .with_untracked(|setup| setup.wheels.get(place).cloned());
        let Some(id) = wheel.and_then(|wheel| wheel.motor()) else {
            return;
        };
        let moves = !self.page.is_known_to_rest();
        let reason = spin_blocked_by(&self.page.present(), id)
            .or_else(|| moves.then(|| must_stand().to_owned()));
        if let Some(reason) = reason {
            self.change(|setup| setup.refused(reason));
            return;
        }
        if !self.try_store_names() || self.change(|setup| setup.spin(place)).is_none() {
            return;
        }
        let limit = self.page.settings.speed_limit.get_untracked();
        let speed = SpeedTarget::clamped(SPIN_RPM.min(limit));
        self.page.command(Command::Start {
            id,
            setpoint: Setpoint::velocity(speed),
            consent: Consent::None,
        });
        self.spun_at_ms.set_value(page_now_ms());
        let spin = self.spins.get_value().wrapping_add(1);
        self.spins.set_value(spin);
        let end = move || {
            if self.spins.try_get_value() == Some(spin) {
                self.end_spin();
            }
        };
        set_timeout(end, Duration::from_millis(SPIN_MS.into()));
    }

    /// Stops the wheel that this panel drives, if any.
    fn end_spin(self) {
        let is_spinning = |setup: &Setup| matches!(setup.activity, Activity::Spinning(_));
        if self.setup.try_with_untracked(is_spinning) == Some(true) {
            let to_stop = self.change(Setup::end_spin);
            self.stop(to_stop);
        }
    }

    fn stop(self, id: Option<MotorId>) {
        if let Some(id) = id {
            self.page.command(Command::Stop(id));
        }
    }

    /// Handles an answer, and stores names and sides.
    pub(crate) fn answer(self, change: impl FnOnce(&mut Setup)) {
        self.change(change);
        self.try_store_names();
    }

    /// Cancels the scan or the ID change.
    pub(crate) fn cancel(self) {
        (self.ids.cancel)();
    }

    /// Stores names and sides, and ends the setup.
    pub(crate) fn finish(self) {
        if self.try_store_names() {
            self.change(Setup::finish);
        }
    }
}

/// Why the shown state does not allow this wheel to be spun; `None` if it does.
pub(crate) fn spin_blocked_by(session: &Session, id: MotorId) -> Option<String> {
    drive_blocked_by(session, id, Mode::Velocity).or_else(|| {
        let moves = !session.is_known_to_rest();
        moves.then(|| must_stand().to_owned())
    })
}

fn must_stand() -> &'static str {
    tr!("Wait until every motor replies and is at standstill.")
}
