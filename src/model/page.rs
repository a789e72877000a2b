//! The state that all features share: motors, links to the workers, notices, settings.
//!
//! | file | idea |
//! |---|---|
//! | `page` | the state itself |
//! | `commands` | commands to the worker, and notices to the user |
//! | `motors` | the selected motor, and the names and sides of all |
//! | `drive_settings` | rate, limits and ramp |
//! | `recorder` | the recorder as the page sees it |
//! | `setup_actions` | reads and applies the setup |

use derive_more::Deref;
use leptos::prelude::*;
use motorlink_i18n::{Language, current_language};
use motorlink_messages::{
    Connection, Notice, ToWorker,
    bus::Repeat,
    protocol::{AssignableId, CurrentTarget, Frame, Mode, MotorId, family::Model},
};

use crate::{
    link::{
        clock::Clock,
        worker_link::{WorkerLink, WorkerState},
    },
    model::{
        drive_settings::DriveSettings,
        governor::Governor,
        help_topic::HelpTopic,
        history::History,
        motor_model,
        names_and_sides::NamesAndSides,
        names_of_line,
        notice_board::NoticeBoard,
        place::{Open, Panel, Place},
        preferences::Preferences,
        recorder::Recorder,
        snapshot::Session,
        tab,
    },
    ui::reactive::memo,
};

/// A raw frame to send, and how often.
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
    /// The help, at this place.
    Help(Option<HelpTopic>),
    /// The question about a high current.
    HighCurrent {
        /// The motor.
        id: MotorId,
        /// The current.
        target: CurrentTarget,
    },
    /// The question whether to delete all stored data.
    EraseKept,
    /// The name and the side of this motor.
    NameAndSide(MotorId),
    /// The question whether to change the ID of the only motor.
    ChangeId(IdChange),
    /// The question whether to send a frame that can move a wheel.
    Hazard(RawOrder),
    /// The question about a high current in a raw frame.
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
            | Self::NameAndSide(_)
            | Self::Hazard(_)
            | Self::HighRawCurrent { .. } => true,
            Self::Help(_) | Self::EraseKept => false,
        }
    }
}

/// A message that concerns more than one feature: features do not use each other.
#[derive(Clone, Copy)]
pub(crate) enum Change<'a> {
    /// Another motor was selected: readings of the previous one are not valid for it.
    Motor,
    /// A question was declined or withdrawn.
    Declined,
    /// Another place was opened.
    Place(Place),
    /// Another model was chosen for the open serial port.
    Model,
    /// Other measures of the vehicle are in use.
    Geometry,
    /// The worker has reported this.
    Notice(&'a Notice),
    /// All notices of one message of the worker have been handled.
    Updated,
    /// The port is closed or lost, or the worker has ended.
    Disconnected,
}

/// Who gets the changes. A part that loads later listens from then on.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Listener {
    /// The features of the first program.
    App,
    /// The panel `ID Manager`.
    Ids,
    /// The setup of the wheels.
    WheelSetup,
    /// The measures of the vehicle.
    Geometry,
}

/// The port worker as the page sees it.
#[derive(Clone, Copy)]
pub(crate) struct Worker {
    pub(crate) link: StoredValue<Option<WorkerLink>, LocalStorage>,
    pub(crate) state: RwSignal<WorkerState>,
    pub(crate) clock: StoredValue<Clock>,
    /// Whether the user pressed STOP before the link was ready.
    pub(crate) stopped_early: StoredValue<bool>,
    /// The connection that the user requested before the link was ready.
    pub(crate) connect_early: StoredValue<Option<ToWorker>>,
    /// Whether the page connects the virtual motors of its address.
    pub(crate) opens_by_itself: StoredValue<bool>,
    /// When a wheel was started last, on the page's clock.
    pub(crate) started_ms: StoredValue<f64>,
    /// Stops what a failed worker has left driven, once its part is loaded. It gets the last state.
    pub(crate) rescue: StoredValue<Option<Rescue>, LocalStorage>,
}

type Rescue = Box<dyn Fn(&Session)>;

/// Names and sides of the motors, and which of them drive together.
#[derive(Clone, Copy)]
pub(crate) struct Motors {
    pub(crate) names: RwSignal<NamesAndSides>,
    /// Number of times that all names and sides were replaced.
    pub(crate) replaced: RwSignal<u32>,
    /// The last started group, until it is known that it no longer drives.
    pub(crate) driven_together: StoredValue<Vec<MotorId>>,
    /// Whether the drive pad drives.
    pub(crate) steered: RwSignal<bool>,
}

/// The shown and the requested loop.
#[derive(Clone, Copy)]
pub(crate) struct Loops {
    pub(crate) tab: RwSignal<Mode>,
    /// Set on connecting until the tab has followed the motor's loop.
    pub(crate) tab_to_follow: StoredValue<bool>,
}

type OnChange = Box<dyn Fn(Change<'_>)>;

/// A pointer, so that the hundreds of closures that hold it stay small. There is one, for the life of the page.
#[derive(Clone, Copy, Deref)]
pub(crate) struct Page(#[deref(forward)] &'static Parts);

/// The parts of the state.
pub(crate) struct Parts {
    pub(crate) worker: Worker,
    pub(crate) recorder: Recorder,
    /// The newest state with the signs of the wire. It changes with every message and is no signal.
    pub(crate) latest: StoredValue<Session>,
    /// The shown state with the operator's signs. Updated at most once per frame of the screen; for readings alone,
    /// ten times a second.
    pub(crate) shown: RwSignal<Session>,
    pub(crate) history: StoredValue<History, LocalStorage>,
    /// Decides how often the page draws.
    pub(crate) governor: StoredValue<Governor>,
    pub(crate) selected: RwSignal<MotorId>,
    /// The model of the motors: see [`motor_model`].
    pub(crate) model: Memo<Model>,
    pub(crate) motors: Motors,
    pub(crate) loops: Loops,
    pub(crate) settings: DriveSettings,
    pub(crate) notices: RwSignal<NoticeBoard>,
    pub(crate) preferences: RwSignal<Preferences>,
    /// The language; the page is drawn again when it changes.
    pub(crate) language: RwSignal<Language>,
    pub(crate) dialog: RwSignal<Option<Dialog>>,
    /// The open place and panel.
    pub(crate) open: RwSignal<Open>,
    /// Whether the place Drive has the controls of the group, not of the motor.
    pub(crate) group: RwSignal<bool>,
    listeners: StoredValue<Vec<(Listener, OnChange)>, LocalStorage>,
}

/// Reads a part of the state of one motor.
type Reader<T> = dyn Fn(&Session, MotorId) -> T + Send + Sync;

impl Page {
    /// Whether a dialog covers the rest of the page.
    pub(crate) fn is_behind_dialog(self) -> bool {
        self.dialog.with(Option::is_some)
    }

    pub(crate) fn new(preferences: Preferences) -> Self {
        let settings = DriveSettings::load(&preferences);
        let selected = RwSignal::new(preferences.motor);
        let preferences = RwSignal::new(preferences);
        let shown = RwSignal::new(Session::default());
        let model = memo(move || {
            let chosen = preferences.with(|chosen| chosen.model);
            shown.with(|session| motor_model::shown(session, chosen))
        });
        Self(Box::leak(Box::new(Parts {
            worker: Worker {
                link: StoredValue::new_local(None),
                state: RwSignal::new(WorkerState::Starting),
                clock: StoredValue::new(Clock::default()),
                stopped_early: StoredValue::new(false),
                connect_early: StoredValue::new(None),
                opens_by_itself: StoredValue::new(false),
                started_ms: StoredValue::new(f64::NEG_INFINITY),
                rescue: StoredValue::new_local(None),
            },
            recorder: Recorder::new(),
            latest: StoredValue::new(Session::default()),
            shown,
            history: StoredValue::new_local(History::with_past()),
            governor: StoredValue::new(Governor::default()),
            selected,
            model,
            motors: Motors {
                names: RwSignal::new(names_of_line::load(None)),
                replaced: RwSignal::new(0),
                driven_together: StoredValue::new(Vec::new()),
                steered: RwSignal::new(false),
            },
            loops: Loops {
                tab: RwSignal::new(tab::FIRST),
                tab_to_follow: StoredValue::new(false),
            },
            settings,
            notices: RwSignal::new(NoticeBoard::default()),
            preferences,
            language: RwSignal::new(current_language()),
            dialog: RwSignal::new(None),
            open: RwSignal::new(Open {
                place: Place::Drive,
                panel: None,
            }),
            group: RwSignal::new(false),
            listeners: StoredValue::new_local(Vec::new()),
        })))
    }

    pub(crate) const fn parts(self) -> &'static Parts {
        self.0
    }

    /// Delivers changes to this listener by this function, and no longer by the one before.
    pub(crate) fn listen(self, listener: Listener, act: OnChange) {
        self.listeners.update_value(|all| {
            all.retain(|(other, _)| *other != listener);
            all.push((listener, act));
        });
    }

    pub(crate) fn announce(self, change: Change<'_>) {
        self.listeners.with_value(|all| {
            for (_, act) in all {
                act(change);
            }
        });
    }

    /// The newest state with the operator's signs and current ages.
    pub(crate) fn present(self) -> Session {
        let latest = Session {
            now: self.now(),
            ..self.latest.get_value()
        };
        let names = self.motors.names;
        names.with_untracked(|names| latest.with_mirroring(names))
    }

    /// Shows the newest state.
    pub(crate) fn show(self) {
        self.shown.set(self.present());
    }

    /// Opens the tab of the motor's current or requested loop.
    pub(crate) fn follow(self, mode: Mode) {
        self.loops.tab.set(mode);
    }

    /// The open place.
    pub(crate) fn place(self) -> Place {
        self.open.get().place
    }

    /// The panel that a button has opened.
    pub(crate) fn panel(self) -> Option<Panel> {
        self.open.get().panel
    }

    /// Whether no port is open. Not while the page opens one by itself: nothing on the screen moves then.
    pub(crate) fn has_no_port(self) -> bool {
        self.shown.with(|session| match session.connection {
            Connection::Disconnected | Connection::Connecting => {
                !self.worker.opens_by_itself.get_value()
            }
            Connection::Failed(_) => true,
            Connection::Connected(_) | Connection::Reconnecting(_) => false,
        })
    }

    /// Whether the first screen is shown.
    pub(crate) fn shows_first_screen(self) -> bool {
        self.place() == Place::Drive && self.has_no_port()
    }

    /// Opens a place. It changes nothing that drives.
    pub(crate) fn open(self, place: Place) {
        self.announce(Change::Place(place));
        self.open.set(Open { place, panel: None });
    }

    /// Opens a panel over the open place, or closes it.
    pub(crate) fn show_panel(self, panel: Option<Panel>) {
        self.open.update(|open| open.panel = panel);
    }

    /// Closes the panel that a button has opened.
    pub(crate) fn closer(self) -> Box<dyn Fn() + Send + Sync> {
        Box::new(move || self.show_panel(None))
    }

    /// Opens a panel of the place Setup.
    pub(crate) fn open_in_setup(self, panel: Panel) {
        self.open(Place::Setup);
        self.show_panel(Some(panel));
    }

    /// Opens the controls of the group.
    pub(crate) fn open_group(self) {
        self.group.set(true);
        self.open(Place::Drive);
    }

    /// Whether the controls of the group are shown.
    pub(crate) fn shows_group(self) -> bool {
        self.place() == Place::Drive && self.group.get()
    }

    /// Declines the open question.
    pub(crate) fn decline(self) {
        self.dialog.set(None);
        self.announce(Change::Declined);
    }

    /// Withdraws a question about motors, because the selection or the connection has changed.
    pub(crate) fn withdraw_question(self) {
        let open = self.dialog.get_untracked();
        if open.is_some_and(Dialog::is_about_motors) {
            self.decline();
        }
    }

    /// Changes the stored preferences.
    pub(crate) fn prefer(self, change: impl FnOnce(&mut Preferences)) {
        self.preferences.update(change);
        self.preferences.with_untracked(Preferences::save);
    }

    /// A derived value of the selected motor, which changes only if the value differs.
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
