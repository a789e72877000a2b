//! Everything that the components share: what is shown, what was entered, and the line to the
//! worker.

use std::ops::Deref;

use leptos::prelude::*;
use motorlink_messages::{
    ToWorker,
    bus::Command,
    protocol::{CurrentTarget, Mode, MotorId},
};

use crate::{
    clock::{Clock, act_ms, page_now_ms},
    notice_board::{NoticeBoard, Words},
    preferences::Preferences,
    session::Session,
    target::Target,
    twin::TwinFeed,
    worker_link::WorkerLink,
};

/// Whether the worker lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WorkerState {
    /// Its code is being loaded.
    Starting,
    /// It has said hello.
    Running,
    /// It could not be started, or it has failed.
    Dead,
}

/// What lies over the desk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dialog {
    /// The help.
    Help,
    /// The question whether so high a current is meant.
    HighCurrent(CurrentTarget),
}

/// What was entered last, always in range.
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
    /// Drive frames a second.
    pub(crate) rate: Target,
}

/// The desk: a pointer, so that it weighs nothing in the hundreds of closures that hold it. A page
/// has one, for as long as it lives.
#[derive(Clone, Copy)]
pub(crate) struct Desk(&'static Parts);

impl Deref for Desk {
    type Target = Parts;

    fn deref(&self) -> &Parts {
        self.0
    }
}

/// What lies on the desk.
pub(crate) struct Parts {
    pub(crate) link: StoredValue<Option<WorkerLink>, LocalStorage>,
    pub(crate) clock: StoredValue<Clock>,
    /// The newest state. It changes with every message and is no signal.
    pub(crate) latest: StoredValue<Session>,
    /// Set on connecting until the tab has followed the motor's loop.
    pub(crate) tab_to_follow: StoredValue<bool>,
    /// What the twin is drawn from.
    pub(crate) feed: StoredValue<TwinFeed, LocalStorage>,
    /// The state as it is shown: at most once a frame, and ten times a second for readings alone.
    pub(crate) shown: RwSignal<Session>,
    pub(crate) worker: RwSignal<WorkerState>,
    pub(crate) notices: RwSignal<NoticeBoard>,
    pub(crate) preferences: RwSignal<Preferences>,
    pub(crate) selected: RwSignal<MotorId>,
    pub(crate) tab: RwSignal<Mode>,
    /// The loop that the operator asked for last, until a stop or another motor makes it moot.
    pub(crate) asked: RwSignal<Option<Mode>>,
    pub(crate) targets: Targets,
    pub(crate) dialog: RwSignal<Option<Dialog>>,
}

/// The speed of the first start and of the keys F and B: half of what the motor runs without load.
pub(crate) const FIRST_SPEED_RPM: i32 = 100;

/// The motor's fastest acceleration, which is also its default.
const FIRST_ACCELERATION: i32 = 1;

/// Reads a part of the state of one motor.
type Reader<T> = dyn Fn(&Session, MotorId) -> T + Send + Sync;

impl Desk {
    pub(crate) fn new(preferences: Preferences) -> Self {
        Self(Box::leak(Box::new(Parts {
            link: StoredValue::new_local(None),
            clock: StoredValue::new(Clock::default()),
            latest: StoredValue::new(Session::default()),
            tab_to_follow: StoredValue::new(false),
            feed: StoredValue::new_local(TwinFeed::default()),
            shown: RwSignal::new(Session::default()),
            worker: RwSignal::new(WorkerState::Starting),
            notices: RwSignal::new(NoticeBoard::default()),
            preferences: RwSignal::new(preferences),
            selected: RwSignal::new(preferences.motor),
            tab: RwSignal::new(Mode::Velocity),
            asked: RwSignal::new(None),
            targets: Targets {
                speed: Target::new(FIRST_SPEED_RPM),
                acceleration: Target::new(FIRST_ACCELERATION),
                current: Target::new(0),
                position: Target::new(0),
                rate: Target::new(preferences.rate.hertz().into()),
            },
            dialog: RwSignal::new(None),
        })))
    }

    pub(crate) fn post(self, message: &ToWorker) {
        self.link.with_value(|link| {
            if let Some(link) = link {
                link.post(message);
            }
        });
    }

    pub(crate) fn command(self, command: Command) {
        self.post(&ToWorker::Command {
            command,
            given_ms: act_ms(),
        });
    }

    pub(crate) fn say(self, words: Words) {
        self.notices.update(|board| board.post(words));
    }

    /// The newest state with its ages as they are now.
    pub(crate) fn present(self) -> Session {
        let clock = self.clock.get_value();
        let mut session = self.latest.get_value();
        session.now = clock.instant(page_now_ms());
        session
    }

    /// Shows the newest state.
    pub(crate) fn show(self) {
        self.shown.set(self.present());
    }

    /// Changes what this browser remembers.
    pub(crate) fn prefer(self, change: impl FnOnce(&mut Preferences)) {
        self.preferences.update(change);
        self.preferences.with_untracked(Preferences::save);
    }

    /// A part of the shown state of the chosen motor, which changes only when that part does.
    pub(crate) fn of_motor<T>(
        self,
        read: impl Fn(&Session, MotorId) -> T + Send + Sync + 'static,
    ) -> Memo<T>
    where
        T: PartialEq + Send + Sync + 'static,
    {
        // Boxed, all readers of one type share their code.
        let read: Box<Reader<T>> = Box::new(read);
        Memo::new(move |_| {
            let id = self.selected.get();
            self.shown.with(|session| read(session, id))
        })
    }
}

/// The desk of this page.
pub(crate) fn use_desk() -> Desk {
    expect_context()
}
