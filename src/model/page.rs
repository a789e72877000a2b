//! What the page knows and all features share: the motors, the lines to the workers, the notices, the settings.
//!
//! | file | idea |
//! |---|---|
//! | `page` | what there is |
//! | `commands` | what is sent to the worker, and what a person is told |
//! | `motors` | which motor is chosen, and who is who |
//! | `drive_settings` | rate, limits and ramp |
//! | `recorder` | the log and the recording, kept by another worker |
//! | `setup_actions` | the setup, read from here and applied here |

use std::ops::Deref;

use leptos::prelude::*;
use motorlink_i18n::{Language, current_language};
use motorlink_messages::{
    ToWorker,
    bus::Repeat,
    protocol::{AssignableId, CurrentTarget, Frame, Mode, MotorId},
};

use crate::{
    link::{
        clock::Clock,
        worker_link::{WorkerLink, WorkerState},
    },
    model::{
        drive_settings::DriveSettings, fleet::Fleet, governor::Governor, help_topic::HelpTopic,
        history::History, notice_board::NoticeBoard, preferences::Preferences, recorder::Recorder,
        snapshot::Session, tab::Tab,
    },
    ui::{drawer::Drawer, reactive::memo},
};

/// A frame that a person wants to be sent, and how often.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RawOrder {
    pub(crate) frame: Frame,
    pub(crate) repeat: Repeat,
}

/// An ID change that a full scan has proved to be safe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct IdChange {
    pub(crate) from: MotorId,
    pub(crate) to: AssignableId,
    /// How many set-ID frames are sent.
    pub(crate) frames: motorlink_messages::bus::SetIdFrames,
}

/// The open dialog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dialog {
    /// The help, at one of its places.
    Help(Option<HelpTopic>),
    /// The question whether so high a current is meant.
    HighCurrent {
        /// The motor that it was asked for.
        id: MotorId,
        /// The current.
        target: CurrentTarget,
    },
    /// The question whether all of the log is to be forgotten, and how many entries that are.
    ClearLog(u64),
    /// The question whether everything that the browser keeps is to be erased.
    EraseKept,
    /// The question whether the only motor is to have another ID.
    ChangeId(IdChange),
    /// The question whether a frame is to be sent that can move a wheel.
    Hazard(RawOrder),
    /// The question whether so high a current is meant in a frame that a person wrote.
    HighRawCurrent {
        /// The frame.
        order: RawOrder,
        /// The current in it.
        current: CurrentTarget,
    },
}

impl Dialog {
    /// Whether it asks about a motor, or about what is sent to motors.
    pub(crate) const fn is_about_motors(self) -> bool {
        match self {
            Self::HighCurrent { .. }
            | Self::ChangeId { .. }
            | Self::Hazard(_)
            | Self::HighRawCurrent { .. } => true,
            Self::Help(_) | Self::ClearLog(_) | Self::EraseKept => false,
        }
    }
}

/// What concerns more than one feature. The app passes it on, since no feature knows another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Change {
    /// Another motor was chosen, or none: what was read of the last says nothing of it.
    Motor,
    /// A question was declined or withdrawn.
    Declined,
    /// Another tab of the control panel was opened.
    Tab(Tab),
}

/// The worker that owns the port, as the page sees it.
#[derive(Clone, Copy)]
pub(crate) struct Worker {
    pub(crate) link: StoredValue<Option<WorkerLink>, LocalStorage>,
    pub(crate) state: RwSignal<WorkerState>,
    pub(crate) clock: StoredValue<Clock>,
    /// Whether a person has stopped all motors before there was a link.
    pub(crate) stopped_early: StoredValue<bool>,
    /// What a person has asked to connect to before there was a link.
    pub(crate) connect_early: StoredValue<Option<ToWorker>>,
    /// When a wheel was started last, on the page's clock.
    pub(crate) started_ms: StoredValue<f64>,
}

/// Names and sides of the motors, and which of them drive together.
#[derive(Clone, Copy)]
pub(crate) struct Motors {
    pub(crate) fleet: RwSignal<Fleet>,
    /// Counts how often the fleet was replaced as a whole, rather than changed by its rows.
    pub(crate) replaced: RwSignal<u32>,
    /// The motors that were started together last, until they are known not to drive any more.
    pub(crate) driven_together: StoredValue<Vec<MotorId>>,
    /// Whether the drive pad drives.
    pub(crate) steered: RwSignal<bool>,
}

/// Which loop is shown, and which is asked for.
#[derive(Clone, Copy)]
pub(crate) struct Loops {
    pub(crate) tab: RwSignal<Tab>,
    /// Set on connecting until the tab has followed the motor's loop.
    pub(crate) tab_to_follow: StoredValue<bool>,
    /// The loop that the operator asked for last, until a stop or another motor makes it moot.
    pub(crate) asked: RwSignal<Option<Mode>>,
}

type OnChange = Box<dyn Fn(Change)>;

/// A pointer, so that it weighs nothing in the hundreds of closures that hold it. A page has one, for as long
/// as it lives.
#[derive(Clone, Copy)]
pub(crate) struct Page(&'static Parts);

impl Deref for Page {
    type Target = Parts;

    fn deref(&self) -> &Parts {
        self.0
    }
}

/// What a page consists of.
pub(crate) struct Parts {
    pub(crate) worker: Worker,
    pub(crate) recorder: Recorder,
    /// The newest state, as the motors count. It changes with every message and is no signal.
    pub(crate) latest: StoredValue<Session>,
    /// The state as it is shown, as a person counts: at most once a frame, and ten times a second for
    /// readings alone.
    pub(crate) shown: RwSignal<Session>,
    pub(crate) history: StoredValue<History, LocalStorage>,
    /// Decides how often the page draws.
    pub(crate) governor: StoredValue<Governor>,
    pub(crate) selected: RwSignal<MotorId>,
    pub(crate) motors: Motors,
    pub(crate) loops: Loops,
    pub(crate) settings: DriveSettings,
    pub(crate) notices: RwSignal<NoticeBoard>,
    pub(crate) preferences: RwSignal<Preferences>,
    /// The language of the page, which is drawn anew when it changes.
    pub(crate) language: RwSignal<Language>,
    pub(crate) dialog: RwSignal<Option<Dialog>>,
    /// The open panel of the drawer.
    pub(crate) drawer: RwSignal<Option<Drawer>>,
    on_change: StoredValue<Option<OnChange>, LocalStorage>,
}

/// Reads a part of the state of one motor.
type Reader<T> = dyn Fn(&Session, MotorId) -> T + Send + Sync;

impl Page {
    pub(crate) fn new(preferences: Preferences) -> Self {
        Self(Box::leak(Box::new(Parts {
            worker: Worker {
                link: StoredValue::new_local(None),
                state: RwSignal::new(WorkerState::Starting),
                clock: StoredValue::new(Clock::default()),
                stopped_early: StoredValue::new(false),
                connect_early: StoredValue::new(None),
                started_ms: StoredValue::new(f64::NEG_INFINITY),
            },
            recorder: Recorder::new(),
            latest: StoredValue::new(Session::default()),
            shown: RwSignal::new(Session::default()),
            history: StoredValue::new_local(History::with_past()),
            governor: StoredValue::new(Governor::default()),
            selected: RwSignal::new(preferences.motor),
            motors: Motors {
                fleet: RwSignal::new(Fleet::load()),
                replaced: RwSignal::new(0),
                driven_together: StoredValue::new(Vec::new()),
                steered: RwSignal::new(false),
            },
            loops: Loops {
                tab: RwSignal::new(Tab::Loop(Mode::Velocity)),
                tab_to_follow: StoredValue::new(false),
                asked: RwSignal::new(None),
            },
            settings: DriveSettings::load(&preferences),
            notices: RwSignal::new(NoticeBoard::default()),
            preferences: RwSignal::new(preferences),
            language: RwSignal::new(current_language()),
            dialog: RwSignal::new(None),
            drawer: RwSignal::new(None),
            on_change: StoredValue::new_local(None),
        })))
    }

    pub(crate) const fn parts(self) -> &'static Parts {
        self.0
    }

    /// From now on, `act` passes on what concerns more than one feature.
    pub(crate) fn on_change(self, act: impl Fn(Change) + 'static) {
        self.on_change.set_value(Some(Box::new(act)));
    }

    pub(crate) fn announce(self, change: Change) {
        self.on_change.with_value(|act| {
            if let Some(act) = act {
                act(change);
            }
        });
    }

    /// The newest state as a person counts it, with its ages as they are now.
    pub(crate) fn present(self) -> Session {
        let latest = Session {
            now: self.now(),
            ..self.latest.get_value()
        };
        let fleet = self.motors.fleet;
        fleet.with_untracked(|fleet| latest.with_mirroring(fleet))
    }

    /// Shows the newest state.
    pub(crate) fn show(self) {
        self.shown.set(self.present());
    }

    /// Shows the tab of the loop that the motor has, or is to have.
    pub(crate) fn follow(self, mode: Mode) {
        self.loops.tab.update(|tab| *tab = tab.following(mode));
    }

    pub(crate) fn open_tab(self, tab: Tab) {
        self.announce(Change::Tab(tab));
        self.loops.tab.set(tab);
    }

    /// Closes the open question with a no.
    pub(crate) fn decline(self) {
        self.dialog.set(None);
        self.announce(Change::Declined);
    }

    /// Withdraws a question about motors: another is looked at, or they may be others on this connection.
    pub(crate) fn withdraw_question(self) {
        let open = self.dialog.get_untracked();
        if open.is_some_and(Dialog::is_about_motors) {
            self.decline();
        }
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
        memo(move || {
            let id = self.selected.get();
            self.shown.with(|session| read(session, id))
        })
    }
}

/// The page of this program.
pub(crate) fn use_page() -> Page {
    expect_context()
}
