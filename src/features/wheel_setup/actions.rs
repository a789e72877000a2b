//! What the setup does on the page and on the bus.

use std::{ops::Deref, time::Duration};

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    bus::{Command, Consent},
    protocol::{AssignableId, Mode, MotorId, Setpoint, SpeedTarget},
};

use crate::{
    features::wheel_setup::{
        state::{Act, Setup},
        stored,
        wheel::with_wheels,
    },
    model::{
        guards::drive_blocked_by,
        id_progress::IdProgress,
        names_and_sides::NamesAndSides,
        page::{Change, Listener, Page},
        snapshot::Session,
    },
    ui::{clock::page_now_ms, drawer::Drawer, listener::on_window, reactive::effect},
};

/// A speed at which a hand can stop the wheel, and at which half a second is a visible sixth of a turn.
const SPIN_RPM: i32 = 20;
/// How long a wheel is driven.
const SPIN_MS: u16 = 500;

/// The ID manager, which is another feature.
pub(crate) struct IdWork {
    /// Tracked.
    pub(crate) progress: Box<dyn Fn() -> IdProgress + Send + Sync>,
    /// Proves that there is one motor, asks, and sets its ID. Returns whether that has begun.
    pub(crate) set_id: Box<dyn Fn(AssignableId) -> bool + Send + Sync>,
    /// The same with more frames, for a motor that has kept its ID.
    pub(crate) set_with_more: Box<dyn Fn() -> bool + Send + Sync>,
    pub(crate) full_scan: Box<dyn Fn() + Send + Sync>,
    pub(crate) cancel: Box<dyn Fn() + Send + Sync>,
}

/// The panel `Set up the wheels of a rover`. It lasts as long as the page.
#[derive(Clone, Copy)]
pub(crate) struct WheelSetup(&'static Parts);

/// Its state.
pub(crate) struct Parts {
    pub(crate) page: Page,
    pub(crate) ids: &'static IdWork,
    pub(crate) setup: RwSignal<Setup>,
    /// Number of times that the rows of the wheels were replaced.
    pub(crate) replaced: RwSignal<u32>,
    /// Number of spins, so that the end of an earlier one does not end the next.
    spins: StoredValue<u32>,
    spun_at_ms: StoredValue<f64>,
}

impl Deref for WheelSetup {
    type Target = Parts;

    fn deref(&self) -> &Parts {
        self.0
    }
}

impl WheelSetup {
    /// The setup of this page: made at the first call, for the owner of the page.
    pub(crate) fn of_page(owner: &Owner, page: Page, ids: impl FnOnce() -> IdWork) -> Self {
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
        let act = move |change: Change<'_>| match change {
            Change::Notice(notice) => {
                let to_stop = self.change(|setup| setup.on_notice(notice));
                self.stop(to_stop);
            }
            // A timer of the page may be late.
            Change::Updated => {
                if page_now_ms() - self.spun_at_ms.get_value() > f64::from(SPIN_MS) {
                    self.end_spin();
                }
            }
            Change::Disconnected => self.change(Setup::disconnected),
            Change::Motor | Change::Declined | Change::Tab(_) | Change::Model => {}
        };
        self.page.listen(Listener::WheelSetup, Box::new(act));
        effect(move || {
            let ids = (self.ids.progress)();
            self.change(|setup| setup.on_ids(&ids));
        });
        // A person who cannot see the wheel's panel does not look at the wheel.
        effect(move || {
            let is_open = self.page.drawer.get() == Some(Drawer::WheelSetup);
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

    /// Changes the state, and stores it where the progress differs.
    pub(crate) fn change<T>(self, act: impl FnOnce(&mut Setup) -> T) -> T {
        let before = self.setup.get_untracked();
        let mut after = before.clone();
        let result = act(&mut after);
        if after != before {
            if stored::to_text(&after) != stored::to_text(&before) {
                stored::save(&after);
            }
            self.setup.set(after);
        }
        result
    }

    /// Changes the wheels, and shows other rows.
    pub(crate) fn replace_wheels(self, change: impl FnOnce(&mut Setup)) {
        self.change(change);
        self.replaced.update(|times| *times += 1);
    }

    /// Finds the only motor and gives it the ID of the wheel.
    pub(crate) fn find(self) {
        if let Some(id) = self.change(Setup::find)
            && !(self.ids.set_id)(id)
        {
            self.scan_refused();
        }
    }

    /// The same with more frames.
    pub(crate) fn find_with_more(self) {
        if self.change(Setup::find).is_some() && !(self.ids.set_with_more)() {
            self.scan_refused();
        }
    }

    fn scan_refused(self) {
        let reason = tr!("Not connected, or a scan is running. Press it again afterwards.");
        self.change(|setup| setup.refused(reason.to_owned()));
    }

    /// Scans for all motors.
    pub(crate) fn check(self) {
        if self.change(Setup::check) {
            (self.ids.full_scan)();
        }
    }

    /// All that can answer answers: goes on to the wheels, with their names and sides on the page.
    pub(crate) fn begin_spins(self) {
        let answered = self.setup.with_untracked(|setup| setup.answered.clone());
        let Some(answered) = answered else { return };
        let selected = self.page.selected.get_untracked();
        if let Some(first) = answered.first().filter(|_| !answered.contains(&selected)) {
            self.page.choose(*first);
        }
        // A motor that was unplugged after it got its ID is not asked any more: it would count as one that may turn.
        let silent = |session: &Session| -> Vec<MotorId> {
            let silent = session.motors.iter().filter(|motor| motor.silent);
            silent.map(|motor| motor.id).collect()
        };
        for id in self.page.latest.with_value(silent) {
            if !answered.contains(&id) {
                self.page.command(Command::Forget(id));
            }
        }
        self.change(Setup::begin_spins);
        // If a motor moves, they are stored with the first spin.
        let _ = self.store_names();
    }

    /// Stores names, sides and group of the wheels for the page. Returns why not.
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

    /// The same. Says why not.
    fn has_stored_names(self) -> bool {
        let stored = self.store_names();
        let is_stored = stored.is_ok();
        if let Err(reason) = stored {
            self.change(|setup| setup.refused(reason));
        }
        is_stored
    }

    /// Drives a wheel slowly for half a second, forward as its side says.
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
        if !self.has_stored_names() || self.change(|setup| setup.spin(place)).is_none() {
            return;
        }
        let limit = self.page.settings.speed_limit.get_untracked();
        let speed = SpeedTarget::clamped(SPIN_RPM.min(limit));
        self.page.command(Command::Drive {
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

    /// Stops the wheel that is driven here, if one is.
    fn end_spin(self) {
        let is_spinning = |setup: &Setup| matches!(setup.act, Act::Spinning(_));
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

    /// The answer changes names or sides of the page.
    pub(crate) fn answer(self, act: impl FnOnce(&mut Setup)) {
        self.change(act);
        self.has_stored_names();
    }

    /// Ends the scan or the ID change.
    pub(crate) fn cancel(self) {
        (self.ids.cancel)();
    }

    pub(crate) fn finish(self) {
        if self.has_stored_names() {
            self.change(Setup::finish);
        }
    }
}

/// Why this wheel cannot be spun now, as far as the shown state tells.
pub(crate) fn spin_blocked_by(session: &Session, id: MotorId) -> Option<String> {
    drive_blocked_by(session, id, Mode::Velocity).or_else(|| {
        let moves = !session.is_known_to_rest();
        moves.then(|| must_stand().to_owned())
    })
}

fn must_stand() -> &'static str {
    tr!("Wait until every motor answers and stands.")
}
