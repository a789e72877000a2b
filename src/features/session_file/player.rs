//! Shows the open session as if it were the live line.

mod controls;
mod gate;

use std::{
    rc::Rc,
    sync::{
        Mutex,
        atomic::{AtomicBool, AtomicU64, Ordering::Relaxed},
    },
};

use derive_more::Deref;
use leptos::prelude::{Update as _, *};
use motorlink_i18n::tr;
use motorlink_messages::{
    Update,
    bus::Sample,
    protocol::Instant,
    recorder::{LogPage, Row},
    sessions::{
        ActivityChange, FaultChange, FromReplay, Place, PlaySpeed, SessionInfo, ToReplay,
        ToSessions,
    },
};

use crate::{
    features::session_file::bookmarks::Bookmarks,
    link::{clock::Clock, sessions_link::SessionsLink, worker_link::WorkerState},
    model::{
        guards::{is_in_use, port_blocked_by},
        names_and_sides::NamesAndSides,
        page::Page,
        replay,
        setup::Setup,
    },
    ui::clock::{page_now_ms, page_origin_ms},
};

/// The session worker, while it runs.
pub(super) type Link = StoredValue<Option<SessionsLink>, LocalStorage>;

/// What the instruments of the page have to do.
#[derive(Clone, Copy)]
pub(crate) enum Show<'a> {
    /// Set the live line aside, and show nothing but these names and sides.
    Begin(&'a NamesAndSides),
    /// Show nothing.
    Nothing,
    /// Show this state of the recording.
    Recorded(&'a Update),
    /// Add older replies to the graph.
    Past(&'a [Sample]),
    /// Add what motors did before to the graph.
    PastActivities(&'a [ActivityChange]),
    /// Show these faults instead of those so far.
    Faults(&'a [FaultChange]),
    /// Show these rows of the packet log.
    Rows(&'a LogPage),
    /// The recording closes.
    Close,
    /// Show the live line again.
    End,
}

/// The instruments of the page.
pub(crate) type Instruments = Box<dyn Fn(Show<'_>)>;

/// The replay of the open session.
///
/// A plain pointer: typed stored values would enlarge the first program.
#[derive(Clone, Copy, Deref)]
pub(crate) struct Player(#[deref(forward)] &'static Parts);

/// Its state.
pub(crate) struct Parts {
    pub(super) page: Page,
    link: Link,
    instruments: StoredValue<Instruments, LocalStorage>,
    /// The replayed session.
    pub(super) info: RwSignal<Option<Rc<SessionInfo>>, LocalStorage>,
    pub(super) place: RwSignal<Place>,
    pub(super) speed: RwSignal<PlaySpeed>,
    /// The last frame before the place that is shown.
    pub(super) frame: RwSignal<Option<Row>, LocalStorage>,
    /// The bookmarks of the open session.
    pub(super) bookmarks: RwSignal<Bookmarks, LocalStorage>,
    /// The place that the user has asked for, until it is shown.
    wanted: RwSignal<Option<u64>>,
    /// Whether the replay has paused because the file could not be read.
    pub(super) unreadable: RwSignal<bool>,
    /// Whether the worker is going to a place; the next one waits.
    going: AtomicBool,
    /// That place.
    asked: AtomicU64,
    /// Whether it plays once it is at the start.
    plays_at_start: AtomicBool,
    clocks: Mutex<Clocks>,
}

#[derive(Clone, Copy, Default)]
struct Clocks {
    /// The clock of the live line.
    live: Clock,
    /// The wall clock at zero of the times of the replay, after the origin of the page, in milliseconds.
    wall_ms: f64,
    /// The time of the first record.
    first: Instant,
}

impl Player {
    pub(super) fn new(page: Page, link: Link, instruments: Instruments) -> Self {
        Self(Box::leak(Box::new(Parts {
            page,
            link,
            instruments: StoredValue::new_local(instruments),
            info: RwSignal::new_local(None),
            place: RwSignal::new(Place::default()),
            speed: RwSignal::new(PlaySpeed::REAL_TIME),
            frame: RwSignal::new_local(None),
            bookmarks: RwSignal::new_local(Bookmarks::default()),
            wanted: RwSignal::new(None),
            unreadable: RwSignal::new(false),
            going: AtomicBool::new(false),
            asked: AtomicU64::new(0),
            plays_at_start: AtomicBool::new(false),
            clocks: Mutex::default(),
        })))
    }

    fn clocks(self) -> Clocks {
        self.clocks.lock().map(|clocks| *clocks).unwrap_or_default()
    }

    /// Replaces the clock of the page, and returns the one before.
    fn exchange_clock(self, clock: Clock) -> Clock {
        let mut before = clock;
        let of_page = self.page.worker.clock;
        of_page.update_value(|of_page| before = std::mem::replace(of_page, clock));
        before
    }

    fn post(self, message: ToReplay) {
        self.link.with_value(|link| {
            if let Some(link) = link {
                link.post(&ToSessions::Replay(message), &[], &[]);
            }
        });
    }

    fn show(self, what: Show<'_>) {
        self.instruments.with_value(|instruments| instruments(what));
    }

    /// Why no replay can begin: it never does while a port is open, or may be in a moment.
    pub(super) fn blocked_by(self) -> Option<String> {
        let worker = self.page.worker.state.get();
        if worker == WorkerState::Starting {
            return Some(tr!("The page is starting. Try again in a moment.").to_owned());
        }
        let is_open = self
            .page
            .shown
            .with(|session| is_in_use(session.connection))
            || self
                .page
                .latest
                .with_value(|session| is_in_use(session.connection));
        let reason = is_open.then(|| tr!("Disconnect first.").to_owned());
        reason.or_else(|| port_blocked_by(worker))
    }

    /// Replays the open file from its start. If it does not play at once, it waits there for `Play`.
    pub(super) fn begin(self, plays: bool) {
        let replays = self.info.with_untracked(Option::is_some);
        if !replays && untrack(|| self.blocked_by()).is_none() {
            self.plays_at_start.store(plays, Relaxed);
            self.post(ToReplay::Begin);
        }
    }

    pub(super) fn on_message(self, info: &Rc<SessionInfo>, message: FromReplay) {
        if let FromReplay::Begun {
            first,
            zero_unix_us,
            ..
        } = message
        {
            // Replay was pressed twice. The clock and the live line must not be set aside a second time.
            if self.info.with_untracked(Option::is_some) {
                return;
            }
            // A port may have been opened meanwhile.
            if untrack(|| self.blocked_by()).is_some() {
                self.post(ToReplay::End);
            } else {
                self.begun(info, first, zero_unix_us);
            }
            return;
        }
        if self.info.with_untracked(Option::is_none) {
            return;
        }
        match message {
            FromReplay::Begun { .. } => {}
            FromReplay::Jumped => self.show(Show::Nothing),
            FromReplay::Update { place, update } => self.arrived(place, &update),
            FromReplay::PastActivities(changes) => self.show(Show::PastActivities(&changes)),
            FromReplay::Faults(changes) => self.show(Show::Faults(&changes)),
            FromReplay::Past(samples) => self.show(Show::Past(&samples)),
            FromReplay::Log { rows, frame } => {
                self.frame.set(frame.map(|frame| *frame));
                self.show(Show::Rows(&rows));
            }
            FromReplay::Unreadable => self.unreadable.set(true),
        }
    }

    #[allow(
        clippy::cast_precision_loss,
        reason = "microseconds since 1970 are exact in a double"
    )]
    fn begun(self, info: &Rc<SessionInfo>, first: Instant, zero_unix_us: i64) {
        let wall_ms = zero_unix_us as f64 / 1_000.0 - page_origin_ms();
        self.place.set(Place::default());
        self.speed.set(PlaySpeed::REAL_TIME);
        self.wanted.set(None);
        self.going.store(false, Relaxed);
        self.unreadable.set(false);
        self.frame.set(None);
        self.bookmarks.update(Bookmarks::forget_warning);
        self.info.set(Some(Rc::clone(info)));
        replay::set_gate(Rc::new(move |message| self.keeps(message)));
        let clock = Clock::of_recording(wall_ms, first, page_now_ms(), 0.0);
        let live = self.exchange_clock(clock);
        if let Ok(mut clocks) = self.clocks.lock() {
            *clocks = Clocks {
                live,
                wall_ms,
                first,
            };
        }
        let setup = Setup::from_json(info.setup.as_bytes()).unwrap_or_default();
        self.show(Show::Begin(&setup.names.unwrap_or_default()));
    }

    /// Ends the replay, and shows the live line again.
    pub(super) fn end(self) {
        if self.info.with_untracked(Option::is_none) {
            return;
        }
        self.post(ToReplay::End);
        self.bookmarks.update(Bookmarks::end_draft);
        self.info.set(None);
        // What this reports is kept out of the log.
        self.show(Show::Close);
        replay::clear_gate();
        self.exchange_clock(self.clocks().live);
        self.show(Show::End);
    }

    fn set_clock(self, place: Instant, speed: f64) {
        let wall_ms = self.clocks().wall_ms;
        self.exchange_clock(Clock::of_recording(wall_ms, place, page_now_ms(), speed));
    }

    /// The worker has reached this place.
    fn arrived(self, place: Place, update: &Update) {
        let speed = if place.plays {
            f64::from(self.speed.get_untracked().per_mille()) / 1_000.0
        } else {
            0.0
        };
        self.set_clock(update.now, speed);
        self.show(Show::Recorded(update));
        if self.place.get_untracked() != place {
            self.place.set(place);
        }
        self.going.store(false, Relaxed);
        if self.plays_at_start.load(Relaxed) && place.after_us < self.duration_us() {
            self.plays_at_start.store(false, Relaxed);
            self.post(ToReplay::Play(self.speed.get_untracked()));
        }
        match self.wanted.get_untracked() {
            Some(after_us) if after_us != self.asked.load(Relaxed) => self.go(after_us),
            Some(_) => self.wanted.set(None),
            None => {}
        }
    }
}
