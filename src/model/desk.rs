//! Everything that the components share: what is shown, what was entered, and the line to the
//! worker.

use motorlink_i18n::{Language, spoken, tr};
use std::{ops::Deref, sync::Mutex};

use leptos::prelude::*;
use motorlink_messages::{
    ToWorker,
    bus::Command,
    protocol::{CurrentTarget, Instant, Mode, MotorId},
};

use crate::{
    app::questions::RawOrder,
    features::{
        graph::plot::{trace::Traces, view::View},
        groups::actions::TogetherEntry,
        help::{tour::Tour, tour_view::remembered_tour},
        ids::state::{Change, IdManager},
        install::Installing,
        raw::actions::RawEntry,
        recording::recorder::Recorder,
        telemetry::{fault_history::FaultHistory, recent::Recent},
        twin::TwinFeed,
    },
    link::{
        clock::{Clock, act_ms, page_now_ms},
        worker_link::WorkerLink,
    },
    model::{
        drawer::Drawer,
        help_topic::HelpTopic,
        history::History,
        log_lines::{self, Line},
        mirror::to_wire,
        notice_board::{NoticeBoard, NoticeText},
        notice_lifetime::Until,
        preferences::Preferences,
        snapshot::Session,
        tab::Tab,
        target::Target,
    },
    ui::{reactive::memo, tool_entry::NO_NEW_ID},
};

/// The worker tells of what it was asked for with the next frame of the screen; on a page that is held up
/// that may take a few.
const TOLD_WITHIN_MS: f64 = 500.0;

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
    ChangeId(Change),
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
    /// In rpm.
    pub(crate) speed_limit: Target,
    /// In mA.
    pub(crate) current_limit: Target,
    /// In degrees Celsius.
    pub(crate) temperature_limit: Target,
    /// The ID that a motor is to be given.
    pub(crate) new_id: Target,
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
    /// Whether a person has stopped all motors before there was a link.
    pub(crate) stopped_early: StoredValue<bool>,
    /// What a person has asked to connect to before there was a link.
    pub(crate) connect_early: StoredValue<Option<ToWorker>>,
    pub(crate) clock: StoredValue<Clock>,
    /// Lines of the log on the page's clock, until it is known how that of the worker goes.
    pub(crate) early_lines: Mutex<Option<Vec<(Instant, Line)>>>,
    /// When a wheel was started last, on the page's clock.
    started_ms: StoredValue<f64>,
    /// The newest state, as the motors count. It changes with every message and is no signal.
    pub(crate) latest: StoredValue<Session>,
    /// Set on connecting until the tab has followed the motor's loop.
    pub(crate) tab_to_follow: StoredValue<bool>,
    /// What the twin is drawn from.
    pub(crate) feed: StoredValue<TwinFeed, LocalStorage>,
    /// What the sparklines are drawn from.
    pub(crate) recent: StoredValue<Recent>,
    /// Written when a fault comes, goes or is seen, and not otherwise.
    pub(crate) fault_history: RwSignal<FaultHistory>,
    /// What the graph is drawn from.
    pub(crate) history: StoredValue<History, LocalStorage>,
    /// Which stretch of time the graph shows.
    pub(crate) graph_view: RwSignal<View>,
    /// What it draws.
    pub(crate) graph_traces: RwSignal<Traces>,
    /// Which virtual line was chosen, by its place.
    pub(crate) virtual_wire: StoredValue<usize>,
    /// The state as it is shown, as a person counts: at most once a frame, and ten times a second for readings alone.
    pub(crate) shown: RwSignal<Session>,
    pub(crate) worker: RwSignal<WorkerState>,
    pub(crate) recorder: Recorder,
    pub(crate) notices: RwSignal<NoticeBoard>,
    pub(crate) preferences: RwSignal<Preferences>,
    /// What the page speaks; the page is drawn anew when it changes.
    pub(crate) language: RwSignal<Language>,
    pub(crate) selected: RwSignal<MotorId>,
    pub(crate) tab: RwSignal<Tab>,
    /// The loop that the operator asked for last, until a stop or another motor makes it moot.
    pub(crate) asked: RwSignal<Option<Mode>>,
    pub(crate) targets: Targets,
    pub(crate) dialog: RwSignal<Option<Dialog>>,
    /// The tour of the first minutes.
    pub(crate) tour: RwSignal<Tour>,
    /// The panel that lies over the right of the desk.
    pub(crate) drawer: RwSignal<Option<Drawer>>,
    /// Scans, and the way to a new ID.
    pub(crate) ids: RwSignal<IdManager>,
    /// The frame that a person writes.
    pub(crate) raw: RawEntry,
    /// Motors that drive together.
    pub(crate) together: TogetherEntry,
    /// The page as a program of the browser's.
    pub(crate) installing: Installing,
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
            stopped_early: StoredValue::new(false),
            connect_early: StoredValue::new(None),
            clock: StoredValue::new(Clock::default()),
            early_lines: Mutex::new(Some(Vec::new())),
            started_ms: StoredValue::new(f64::NEG_INFINITY),
            latest: StoredValue::new(Session::default()),
            tab_to_follow: StoredValue::new(false),
            feed: StoredValue::new_local(TwinFeed::default()),
            recent: StoredValue::new(Recent::default()),
            fault_history: RwSignal::new(FaultHistory::default()),
            history: StoredValue::new_local(History::with_past()),
            graph_view: RwSignal::new(View::default()),
            graph_traces: RwSignal::new(Traces::default()),
            virtual_wire: StoredValue::new(0),
            shown: RwSignal::new(Session::default()),
            worker: RwSignal::new(WorkerState::Starting),
            recorder: Recorder::new(),
            notices: RwSignal::new(NoticeBoard::default()),
            preferences: RwSignal::new(preferences),
            language: RwSignal::new(spoken()),
            selected: RwSignal::new(preferences.motor),
            tab: RwSignal::new(Tab::Loop(Mode::Velocity)),
            asked: RwSignal::new(None),
            targets: Targets {
                speed: Target::new(FIRST_SPEED_RPM),
                acceleration: Target::new(FIRST_ACCELERATION),
                current: Target::new(0),
                position: Target::new(0),
                rate: Target::new(preferences.rate.hertz().into()),
                speed_limit: Target::new(preferences.limits.speed_rpm().into()),
                current_limit: Target::new(preferences.limits.current_ma().into()),
                temperature_limit: Target::new(preferences.limits.temperature_c().into()),
                new_id: Target::new(NO_NEW_ID),
            },
            dialog: RwSignal::new(None),
            tour: RwSignal::new(remembered_tour()),
            drawer: RwSignal::new(None),
            ids: RwSignal::new(IdManager::default()),
            raw: RawEntry::new(),
            together: TogetherEntry::load(),
            installing: Installing::new(),
        })))
    }

    pub(crate) fn post(self, message: &ToWorker) {
        self.link.with_value(|link| {
            if let Some(link) = link {
                link.post(message);
            }
        });
    }

    /// Asks the bus for what an operator wants.
    pub(crate) fn command(self, command: Command) {
        let mirror = |id| {
            let fleet = self.together.fleet;
            fleet.with_untracked(|fleet| fleet.mirror(id))
        };
        if matches!(
            command,
            Command::Drive { .. } | Command::DriveTogether { .. } | Command::SendRaw { .. }
        ) {
            self.started_ms.set_value(page_now_ms());
        }
        self.post(&ToWorker::Command {
            command: to_wire(command, mirror),
            given_ms: act_ms(),
        });
    }

    /// Why no motor can change its side now, whatever is shown of it: what was asked for last may not have
    /// been told yet, and a question may be open that has the sign of now.
    pub(crate) fn why_not_turn_sides(self) -> Option<String> {
        let just_asked = self.has_just_started();
        let asks = self.dialog.with_untracked(Option::is_some);
        (just_asked || asks).then(|| tr!("A motor is just being started. Try again.").to_owned())
    }

    /// Whether anything is driven, moves by what was driven, or may have been started a moment ago.
    pub(crate) fn is_anything_driven(self) -> bool {
        self.has_just_started() || self.latest.with_value(Session::is_anything_driven)
    }

    fn has_just_started(self) -> bool {
        page_now_ms() - self.started_ms.get_value() < TOLD_WITHIN_MS
    }

    /// Puts words on the notice board and a line into the log.
    pub(crate) fn say(self, words: NoticeText) {
        self.say_until(self.now(), words, Until::Dismissed);
    }

    /// The same about something that happened a moment ago, and is true until then.
    pub(crate) fn say_until(self, at: Instant, words: NoticeText, until: Until) {
        self.log(at, log_lines::of_words(&words));
        self.notices.update(|board| board.post_until(words, until));
    }

    /// This moment on the worker's clock.
    pub(crate) fn now(self) -> Instant {
        self.clock.get_value().instant(page_now_ms())
    }

    /// The newest state as a person counts it, with its ages as they are now.
    pub(crate) fn present(self) -> Session {
        let latest = Session {
            now: self.now(),
            ..self.latest.get_value()
        };
        let fleet = self.together.fleet;
        fleet.with_untracked(|fleet| latest.counted(fleet))
    }

    /// Another motor, or none: what was heard of the last says nothing of it.
    pub(crate) fn forget_motor(self) {
        self.feed.update_value(TwinFeed::clear);
        self.recent.update_value(Recent::clear);
    }

    /// Shows the newest state.
    pub(crate) fn show(self) {
        self.shown.set(self.present());
    }

    /// Shows the tab of the loop that the motor has, or is to have.
    pub(crate) fn follow(self, mode: Mode) {
        self.tab.update(|tab| *tab = tab.following(mode));
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

/// The desk of this page.
pub(crate) fn use_desk() -> Desk {
    expect_context()
}
