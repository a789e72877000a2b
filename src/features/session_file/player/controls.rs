//! What the controls of a replay do.

use std::sync::atomic::Ordering::Relaxed;

use leptos::prelude::{Update as _, *};
use motorlink_messages::{
    protocol::Instant,
    sessions::{PlaySpeed, ToReplay},
};
use wasm_bindgen::JsCast;
use web_sys::HtmlElement;

use crate::features::session_file::{bookmarks::Bookmarks, player::Player};

impl Player {
    pub(in crate::features::session_file) fn play_or_pause(self) {
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
            self.plays_at_start.store(true, Relaxed);
            self.seek(0);
        } else {
            self.post(ToReplay::Play(self.speed.get_untracked()));
        }
    }

    pub(super) fn pause(self) {
        self.plays_at_start.store(false, Relaxed);
        self.post(ToReplay::Pause);
    }

    pub(in crate::features::session_file) fn set_speed(self, speed: PlaySpeed) {
        self.speed.set(speed);
        if self.place.with_untracked(|place| place.plays) {
            self.post(ToReplay::Play(speed));
        }
    }

    pub(in crate::features::session_file) fn step(self, forward: bool) {
        self.unreadable.set(false);
        self.plays_at_start.store(false, Relaxed);
        self.post(ToReplay::Step { forward });
    }

    pub(in crate::features::session_file) fn duration_us(self) -> u64 {
        self.info
            .with_untracked(|info| info.as_ref().map_or(0, |info| info.duration_us))
    }

    /// The place that is shown, or is about to be.
    pub(in crate::features::session_file) fn shown_us(self) -> u64 {
        let place_us = self.place.with(|place| place.after_us);
        self.wanted.get().unwrap_or(place_us)
    }

    /// Goes to a place. While the worker goes to another one, only the last of them is remembered: a slider that is
    /// dragged asks for sixty a second.
    pub(in crate::features::session_file) fn seek(self, after_us: u64) {
        let after_us = after_us.min(self.duration_us());
        self.wanted.set(Some(after_us));
        if !self.going.load(Relaxed) {
            self.go(after_us);
        }
    }

    pub(super) fn go(self, after_us: u64) {
        self.unreadable.set(false);
        self.going.store(true, Relaxed);
        self.asked.store(after_us, Relaxed);
        self.post(ToReplay::Seek { after_us });
    }

    /// Goes to a time on the clock of the replay.
    pub(super) fn seek_moment(self, at: Instant) {
        let first_us = self.clocks().first.as_micros();
        self.seek(at.as_micros().saturating_sub(first_us));
    }

    /// Begins a bookmark at the place that is shown.
    pub(in crate::features::session_file) fn add_bookmark(self) {
        let here_us = untrack(|| self.shown_us());
        self.bookmarks.update(|bookmarks| bookmarks.begin(here_us));
    }

    /// Ends the writing of a note. What had the focus is gone after it.
    pub(in crate::features::session_file) fn end_note(self, act: impl FnOnce(&mut Bookmarks)) {
        self.bookmarks.update(act);
        let add = document().query_selector(".replay-add").ok().flatten();
        if let Some(add) = add.and_then(|found| found.dyn_into::<HtmlElement>().ok()) {
            // If it cannot be focused, the browser decides.
            let _ = add.focus();
        }
    }

    /// Cancels the note if its field has the focus. Returns whether it has.
    pub(super) fn cancels_note(self) -> bool {
        let focused = document().query_selector(".replay-bookmark input:focus");
        let is_written = matches!(focused, Ok(Some(_)));
        if is_written {
            self.end_note(Bookmarks::cancel);
        }
        is_written
    }

    /// Goes that much further, or back.
    pub(in crate::features::session_file) fn seek_by(self, by_us: i64) {
        self.seek(untrack(|| self.shown_us()).saturating_add_signed(by_us));
    }

    /// Goes to the next event, or to the one before.
    pub(in crate::features::session_file) fn seek_event(self, forward: bool) {
        let here_us = untrack(|| self.shown_us());
        let plays = self.place.with_untracked(|place| place.plays);
        let found = self.info.with_untracked(|info| {
            let marks = info.as_ref()?.marks.iter();
            let marks = marks
                .filter(|mark| !mark.is_bookmark)
                .map(|mark| mark.after_us);
            self.bookmarks.with_untracked(|bookmarks| {
                let entries = bookmarks.entries().iter();
                let bookmarks = entries.map(|entry| entry.bookmark.after_us);
                next_event(marks.chain(bookmarks), here_us, forward, plays)
            })
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
