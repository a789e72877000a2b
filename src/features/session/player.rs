//! Shows the open session as if it were the live line, and controls the replay.

use std::{
    ops::Deref,
    rc::Rc,
    sync::{
        Mutex,
        atomic::{AtomicBool, AtomicU64, Ordering::Relaxed},
    },
};

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::{
    ToWorker, Update,
    bus::{Command, Sample},
    protocol::Instant,
    recorder::{FromRecorder, LogPage, ToRecorder},
    sessions::{FromReplay, Place, PlaySpeed, SessionInfo, ToReplay, ToSessions},
};

use crate::{
    link::{clock::Clock, sessions_link::SessionsLink, worker_link::WorkerState},
    model::{
        guards::{is_in_use, port_blocked_by},
        page::Page,
        replay::{self, Crossing},
    },
    ui::clock::{page_now_ms, page_origin_ms},
};

/// The session worker, while it runs.
pub(super) type Link = StoredValue<Option<SessionsLink>, LocalStorage>;

/// What the instruments of the page have to do.
#[derive(Clone, Copy)]
pub(crate) enum Show<'a> {
    /// Set the live line aside, and show nothing.
    Begin,
    /// Show nothing.
    Nothing,
    /// Show this state of the recording.
    Recorded(&'a Update),
    /// Add older replies to the graph.
    Past(&'a [Sample]),
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
/// A pointer to plain values: stored values of types that the first program stores too would add to it.
#[derive(Clone, Copy)]
pub(crate) struct Player(&'static Parts);

impl Deref for Player {
    type Target = Parts;

    fn deref(&self) -> &Parts {
        self.0
    }
}

/// Its state.
pub(crate) struct Parts {
    pub(super) page: Page,
    link: Link,
    instruments: StoredValue<Instruments, LocalStorage>,
    /// The replayed session.
    pub(super) info: RwSignal<Option<Rc<SessionInfo>>, LocalStorage>,
    pub(super) place: RwSignal<Place>,
    pub(super) speed: RwSignal<PlaySpeed>,
    /// The place that the user has asked for, until it is shown.
    wanted: RwSignal<Option<u64>>,
    /// Whether the replay has paused because the file could not be read.
    pub(super) unreadable: RwSignal<bool>,
    /// Whether the worker is going to a place; the next one waits.
    going: AtomicBool,
    /// That place.
    asked: AtomicU64,
    /// Whether it plays once it is at the start again.
    plays_again: AtomicBool,
    clocks: Mutex<Clocks>,
}

#[derive(Clone, Copy, Default)]
struct Clocks {
    /// The clock of the live line.
    live: Clock,
    /// The wall clock at zero of the times of the replay, after the origin of the page, in milliseconds.
    wall_ms: f64,
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
            wanted: RwSignal::new(None),
            unreadable: RwSignal::new(false),
            going: AtomicBool::new(false),
            asked: AtomicU64::new(0),
            plays_again: AtomicBool::new(false),
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

    pub(super) fn begin(self) {
        if untrack(|| self.blocked_by()).is_none() {
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
            FromReplay::Past(samples) => self.show(Show::Past(&samples)),
            FromReplay::Log(rows) => self.show(Show::Rows(&rows)),
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
        self.plays_again.store(false, Relaxed);
        self.unreadable.set(false);
        self.info.set(Some(Rc::clone(info)));
        replay::set_gate(Rc::new(move |message| self.keeps(message)));
        let clock = Clock::of_recording(wall_ms, first, page_now_ms(), 0.0);
        let live = self.exchange_clock(clock);
        if let Ok(mut clocks) = self.clocks.lock() {
            *clocks = Clocks { live, wall_ms };
        }
        self.show(Show::Begin);
    }

    /// Ends the replay, and shows the live line again.
    pub(super) fn end(self) {
        if self.info.with_untracked(Option::is_none) {
            return;
        }
        self.post(ToReplay::End);
        self.info.set(None);
        // What this reports is kept out of the log.
        self.show(Show::Close);
        replay::clear_gate();
        self.exchange_clock(self.clocks().live);
        self.show(Show::End);
    }

    /// Decides which messages cross between the recording and the live line.
    fn keeps(self, message: Crossing<'_>) -> bool {
        match message {
            Crossing::ToWorker(message) => self.keeps_from_worker(message),
            Crossing::FromWorker(update) => {
                let is_open = is_in_use(update.connection);
                if is_open {
                    self.end();
                }
                !is_open
            }
            Crossing::WorkerLost => {
                self.end();
                false
            }
            Crossing::ToRecorder(message) => self.keeps_from_recorder(message),
            Crossing::FromRecorder(FromRecorder::Log(_)) => true,
            Crossing::FromRecorder(message) => {
                let replaces_the_log = matches!(
                    message,
                    FromRecorder::Restored | FromRecorder::Past { .. } | FromRecorder::Died
                );
                if replaces_the_log {
                    self.end();
                }
                false
            }
            Crossing::Stop => {
                self.pause();
                true
            }
            Crossing::Row(number) => {
                self.post(ToReplay::SeekRow(number));
                true
            }
        }
    }

    /// A second lock: nothing but stops reaches the port worker. What opens a port ends the replay.
    fn keeps_from_worker(self, message: &ToWorker) -> bool {
        match message {
            ToWorker::ConnectSerial { .. } | ToWorker::ConnectVirtual(_) => {
                self.end();
                false
            }
            ToWorker::Disconnect
            | ToWorker::Pong { .. }
            | ToWorker::Command {
                command: Command::StopAll(_) | Command::Stop(_),
                ..
            } => false,
            ToWorker::Command { .. } | ToWorker::Select(_) | ToWorker::VirtualWire(_) => true,
        }
    }

    /// The packet log is that of the recording; what the page writes is left out of it.
    fn keeps_from_recorder(self, message: &ToRecorder) -> bool {
        let of_replay = match message {
            ToRecorder::Show(rows) => ToReplay::ShowRows(*rows),
            ToRecorder::Filter(filter) => ToReplay::Filter(filter.clone()),
            ToRecorder::Toggle(row) => ToReplay::Toggle(*row),
            ToRecorder::SetLanguage { language, texts } => ToReplay::SetLanguage {
                language: language.clone(),
                texts: texts.clone(),
            },
            ToRecorder::AddMessage { .. }
            | ToRecorder::Clear
            | ToRecorder::EndClear { undo: true }
            | ToRecorder::Export(_)
            | ToRecorder::Record(_) => return true,
            ToRecorder::Restore | ToRecorder::Erase => {
                self.end();
                return false;
            }
            ToRecorder::Epoch { .. }
            | ToRecorder::EndClear { undo: false }
            | ToRecorder::CancelExport
            | ToRecorder::Forget => return false,
        };
        self.post(of_replay);
        true
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
        if self.plays_again.load(Relaxed) && place.after_us < self.duration_us() {
            self.plays_again.store(false, Relaxed);
            self.post(ToReplay::Play(self.speed.get_untracked()));
        }
        match self.wanted.get_untracked() {
            Some(after_us) if after_us != self.asked.load(Relaxed) => self.go(after_us),
            Some(_) => self.wanted.set(None),
            None => {}
        }
    }

    pub(super) fn play_or_pause(self) {
        if self.place.with_untracked(|place| place.plays) {
            self.pause();
        } else {
            self.play();
        }
    }

    /// Plays, from the start if it is at the end.
    fn play(self) {
        let place = self.place.get_untracked();
        self.unreadable.set(false);
        if place.after_us >= self.duration_us() {
            // The end has nothing to play, so the order to play waits for the start.
            self.plays_again.store(true, Relaxed);
            self.seek(0);
        } else {
            self.post(ToReplay::Play(self.speed.get_untracked()));
        }
    }

    fn pause(self) {
        self.plays_again.store(false, Relaxed);
        self.post(ToReplay::Pause);
    }

    pub(super) fn set_speed(self, speed: PlaySpeed) {
        self.speed.set(speed);
        if self.place.with_untracked(|place| place.plays) {
            self.post(ToReplay::Play(speed));
        }
    }

    pub(super) fn step(self, forward: bool) {
        self.post(ToReplay::Step { forward });
    }

    pub(super) fn duration_us(self) -> u64 {
        self.info
            .with_untracked(|info| info.as_ref().map_or(0, |info| info.duration_us))
    }

    /// The place that is shown, or is about to be.
    pub(super) fn shown_us(self) -> u64 {
        let place_us = self.place.with(|place| place.after_us);
        self.wanted.get().unwrap_or(place_us)
    }

    /// Goes to a place. While the worker goes to another one, only the last of them is remembered: a slider that is
    /// dragged asks for sixty a second.
    pub(super) fn seek(self, after_us: u64) {
        let after_us = after_us.min(self.duration_us());
        self.wanted.set(Some(after_us));
        if !self.going.load(Relaxed) {
            self.go(after_us);
        }
    }

    fn go(self, after_us: u64) {
        self.going.store(true, Relaxed);
        self.asked.store(after_us, Relaxed);
        self.post(ToReplay::Seek { after_us });
    }

    /// Goes that much further, or back.
    pub(super) fn seek_by(self, by_us: i64) {
        self.seek(untrack(|| self.shown_us()).saturating_add_signed(by_us));
    }

    /// Goes to the next event, or to the one before.
    pub(super) fn seek_event(self, forward: bool) {
        let here_us = untrack(|| self.shown_us());
        let plays = self.place.with_untracked(|place| place.plays);
        let found = self.info.with_untracked(|info| {
            let marks = info.as_ref()?.marks.iter().map(|mark| mark.after_us);
            next_event(marks, here_us, forward, plays)
        });
        if let Some(after_us) = found {
            self.seek(after_us);
        }
    }
}

/// While it plays, an event that has only just passed is not the one before: a second press goes further back.
const JUST_PASSED_US: u64 = 500_000;

fn next_event(
    marks: impl Iterator<Item = u64>,
    here_us: u64,
    forward: bool,
    plays: bool,
) -> Option<u64> {
    if forward {
        return marks.filter(|at_us| *at_us > here_us).min();
    }
    let before_us = if plays {
        here_us.saturating_sub(JUST_PASSED_US)
    } else {
        here_us
    };
    marks.filter(|at_us| *at_us < before_us).max()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_event_is_found_on_both_sides() {
        let marks = [2_000_000, 5_000_000, 9_000_000];
        let from = |here_us, forward, plays| next_event(marks.into_iter(), here_us, forward, plays);
        assert_eq!(from(0, true, false), Some(2_000_000));
        assert_eq!(from(2_000_000, true, false), Some(5_000_000));
        assert_eq!(from(9_000_000, true, false), None);
        assert_eq!(from(5_000_000, false, false), Some(2_000_000));
        assert_eq!(from(5_100_000, false, true), Some(2_000_000));
        assert_eq!(from(5_100_000, false, false), Some(5_000_000));
        assert_eq!(from(0, false, false), None);
    }
}
