//! The player: requests of the page in, messages to it out.

use std::{collections::VecDeque, ops::Range};

use motorlink_bus::Sample;
use motorlink_messages::{
    recorder::PAST_SAMPLES_MAX,
    sessions::{FaultChange, FromReplay, Place, ToReplay},
};
use motorlink_protocol::Instant;
use motorlink_recorder::{LocalTime, WallClock};

use super::{
    log_rows::{LogRows, Rows},
    look_back::LookBack,
    playing::Playing,
    search::{Context, Found, Search},
    times::Times,
    track::{Progress, Track},
};
use crate::{overview::Overview, reader::Session};

/// What the caller of a player does next.
#[derive(Clone, Debug, PartialEq)]
pub enum Todo {
    /// Read these bytes of the file, then call [`Player::supply`] or [`Player::unreadable`].
    Read(Range<u64>),
    /// Post a message to the page.
    Post(FromReplay),
    /// Poll again. Receive messages in between, after some milliseconds.
    Work,
    /// Wait for a message of the page, at most until this time.
    Wait(Option<Instant>),
}

/// Replays an open session. It does no I/O, and the time is an argument.
///
/// The caller polls it after every message until it returns [`Todo::Wait`], and again at the time in it. No poll takes
/// longer than a few milliseconds.
#[derive(Debug)]
pub struct Player {
    times: Times,
    clock: WallClock,
    look_back: LookBack,
    place: Instant,
    track: Track,
    /// What the track does now.
    moving: Option<Moving>,
    playing: Option<Playing>,
    search: Option<Search>,
    /// The place to go to after the search.
    next_place: Option<Instant>,
    /// Samples before a jump that the page does not have yet.
    past: VecDeque<Sample>,
    /// The changes of faults in the whole session.
    faults: Vec<FaultChange>,
    rows: LogRows,
    outgoing: VecDeque<FromReplay>,
}

#[derive(Clone, Copy, Debug)]
enum Moving {
    /// Up to this time.
    To(Instant),
    /// To the next frame of the line.
    ToNextFrame,
}

impl Player {
    /// A replay of this session, paused at its first record. `local_time` is for the packet log.
    #[must_use]
    pub fn new(session: &Session, overview: &Overview, local_time: LocalTime) -> Self {
        Self::with_look_back(session, overview, local_time, LookBack::default())
    }

    /// The same with other bounds.
    #[must_use]
    pub fn with_look_back(
        session: &Session,
        overview: &Overview,
        local_time: LocalTime,
        look_back: LookBack,
    ) -> Self {
        let times = Times::of(overview);
        let clock = WallClock::from_us(times.zero_unix_us(), local_time);
        let begun = FromReplay::Begun {
            first: times.first,
            zero_unix_us: times.zero_unix_us(),
            duration_us: times.after_us(times.end),
        };
        Self {
            times,
            clock,
            look_back,
            place: times.first,
            track: Track::at(session, times, 0, clock),
            moving: Some(Moving::To(times.first)),
            playing: None,
            search: None,
            next_place: None,
            past: VecDeque::new(),
            faults: overview.fault_changes().to_vec(),
            rows: LogRows::default(),
            outgoing: VecDeque::from([begun]),
        }
    }

    /// Handles a request of the page. [`ToReplay::Begin`] and [`ToReplay::End`] are for the caller.
    pub fn handle(&mut self, session: &Session, message: ToReplay, now: Instant) {
        match message {
            ToReplay::Begin | ToReplay::End => {}
            ToReplay::Play(speed) => {
                // The page may have asked for another place just before.
                let place = self.next_place.or_else(|| self.search.as_ref()?.target());
                let is_before_end = place.unwrap_or(self.place) < self.times.end;
                self.playing = is_before_end.then(|| Playing::begin(now, speed));
                self.update();
            }
            ToReplay::Pause => {
                self.pause();
                self.update();
            }
            ToReplay::Seek { after_us } => self.seek(session, self.times.at(after_us)),
            ToReplay::Step { forward } => {
                self.pause();
                self.step(session, forward);
            }
            ToReplay::SeekRow(row) => {
                if let Some(at) = self.track.log.time_of_row(row) {
                    self.seek(session, at);
                }
            }
            ToReplay::ShowRows(window) => self.rows.show(window),
            ToReplay::Filter(filter) => self.rows.set_filter(filter, &mut self.track.log),
            ToReplay::Toggle(row) => self.rows.toggle(row, &mut self.track.log),
            ToReplay::SetLanguage { language, texts } => {
                self.rows
                    .set_language(&language, texts, &mut self.track.log);
            }
        }
    }

    /// Takes the bytes that were requested.
    pub fn supply(&mut self, range: &Range<u64>, bytes: &[u8]) {
        let search = self.search.as_mut();
        if !search.is_some_and(|search| search.supply(range, bytes)) {
            self.track.supply(range, bytes);
        }
    }

    /// The requested bytes cannot be read: the replay pauses.
    pub fn unreadable(&mut self) {
        self.search = None;
        self.next_place = None;
        self.pause();
        self.outgoing.push_back(FromReplay::Unreadable);
        self.update();
    }

    /// What to do next.
    pub fn poll(&mut self, session: &Session, now: Instant) -> Todo {
        if let Some(message) = self.outgoing.pop_front() {
            return Todo::Post(message);
        }
        if let Some(moving) = self.moving {
            return self.go_on(session, moving);
        }
        if let Some(search) = self.search.take() {
            if let Some(playing) = &mut self.playing {
                playing.wait(now);
            }
            return self.search_on(session, search);
        }
        if let Some(part) = self.next_past() {
            return Todo::Post(FromReplay::Past(part));
        }
        if let Some(playing) = &mut self.playing
            && playing.due() <= now
        {
            let to = playing.step(now, self.place);
            self.moving = Some(Moving::To(to.min(self.times.end)));
            return Todo::Work;
        }
        let played = self.playing.map(Playing::due);
        match self.rows.poll(now, &mut self.track.log) {
            Rows::Post(rows) => Todo::Post(rows),
            Rows::Work => Todo::Work,
            Rows::Wait(due) => Todo::Wait([played, due].into_iter().flatten().min()),
        }
    }

    fn pause(&mut self) {
        self.playing = None;
        // Records may have been read on the way to a place.
        self.place = self.place.max(self.track.last);
        self.moving = None;
    }

    fn seek(&mut self, session: &Session, place: Instant) {
        self.moving = None;
        self.past.clear();
        if self.search.as_ref().is_none_or(Search::is_replaceable) {
            self.search = Some(Search::picture(self.context(session), place));
            self.next_place = None;
        } else {
            self.next_place = Some(place);
        }
    }

    fn step(&mut self, session: &Session, forward: bool) {
        if !self.search.as_ref().is_none_or(Search::is_replaceable) {
            // The place is not known yet.
            return;
        }
        if forward {
            self.moving = Some(Moving::ToNextFrame);
        } else if let Some(at) = self.track.frame_before(self.place) {
            self.seek(session, at);
        } else if self.place > self.times.first {
            let search = Search::frame_before(self.context(session), self.place);
            self.search = Some(search);
        }
    }

    const fn context<'a>(&self, session: &'a Session) -> Context<'a> {
        Context {
            session,
            times: self.times,
            clock: self.clock,
            look_back: self.look_back,
        }
    }

    /// Reads on to where the track goes.
    fn go_on(&mut self, session: &Session, moving: Moving) -> Todo {
        let progress = match moving {
            Moving::To(at) => self.track.advance(session, at),
            Moving::ToNextFrame => self.track.advance_to_frame(session, self.place),
        };
        match (progress, moving) {
            (Progress::Read(range), _) => Todo::Read(range),
            (Progress::More, _) => Todo::Work,
            (Progress::Reached, Moving::ToNextFrame) => {
                self.moving = Some(Moving::To(self.track.next_at()));
                Todo::Work
            }
            (Progress::Reached, Moving::To(at)) => {
                self.moving = None;
                self.place = at.max(self.track.last);
                if self.track.is_at_end() && self.playing.is_some() {
                    self.place = self.times.end;
                }
                if self.place >= self.times.end {
                    self.playing = None;
                }
                self.update();
                Todo::Work
            }
        }
    }

    fn search_on(&mut self, session: &Session, search: Search) -> Todo {
        let context = self.context(session);
        let (found, next) = search.step(context, self.place);
        self.search = next;
        match found {
            Found::Progress(Progress::Read(range)) => return Todo::Read(range),
            Found::Progress(_) => {}
            Found::Frame(at) => self.search = Some(Search::picture(context, at)),
            Found::Picture(target, mut track) => {
                let from = track.from.unwrap_or(target);
                if from > self.times.first {
                    // The first state has replies from before it. They come with the past.
                    track.state.samples.retain(|sample| sample.at >= from);
                }
                self.put(track);
                self.place = target;
                if self.place >= self.times.end {
                    self.playing = None;
                }
                self.outgoing.push_back(FromReplay::Jumped);
                self.update();
                let until = self.track.state.shown_at(target);
                let faults = self.faults.iter().filter(|change| change.at <= until);
                let faults = FromReplay::Faults(faults.copied().collect());
                self.outgoing.push_back(faults);
                self.search = match self.next_place.take() {
                    Some(next) => Some(Search::picture(context, next)),
                    None if from <= self.times.first => None,
                    None => Some(Search::near(context, target, from)),
                };
            }
            Found::Near(track, past) => {
                self.put(track);
                self.past = past.samples;
                if !past.activities.is_empty() {
                    let message = FromReplay::PastActivities(past.activities);
                    self.outgoing.push_back(message);
                }
                self.update();
            }
        }
        Todo::Work
    }

    /// Replaces the track, and the rows of the log.
    fn put(&mut self, track: Track) {
        let before = std::mem::replace(&mut self.track, track);
        self.track.log.replace(&before.log, &self.rows.filter);
        self.rows.is_changed = true;
    }

    /// The next part of the samples before a jump: the newest ones.
    fn next_past(&mut self) -> Option<Vec<Sample>> {
        let from = self.past.len().saturating_sub(PAST_SAMPLES_MAX.into());
        let part: Vec<Sample> = self.past.split_off(from).into();
        (!part.is_empty()).then_some(part)
    }

    /// Posts the state at the present place.
    fn update(&mut self) {
        // On the way to a place, records behind this one may have been read.
        let at = self.place.max(self.track.last);
        let update = self.track.state.update(at);
        let place = Place {
            after_us: self.times.after_us(at),
            plays: self.playing.is_some(),
        };
        self.rows.is_changed = true;
        self.outgoing.push_back(FromReplay::Update {
            place,
            update: update.into(),
        });
    }
}
