//! The list of the events and bookmarks in an open file.

use leptos::{either::Either, prelude::*};
use motorlink_i18n::tr;
use motorlink_messages::sessions::{SessionInfo, SessionMark};

use crate::{
    features::session_file::{bookmarks::Entry, player::Player, texts},
    ui::{
        format::grouped,
        reactive::{dynamic, handler},
    },
};

/// Events in the list, so that it stays short. Bookmarks come on top of them: the list always has all of them.
const EVENTS_MAX: usize = 200;

/// The list, and how many events are not in it.
pub(super) fn events(player: Player, info: &SessionInfo) -> impl IntoView + use<> {
    let marks = info.marks.iter().filter(|mark| !mark.is_bookmark);
    let count = marks.clone().count();
    let marks: Vec<SessionMark> = marks.take(EVENTS_MAX).cloned().collect();
    let left_out = count.saturating_sub(EVENTS_MAX) as u64 + info.marks_left_out;
    let more = (left_out > 0).then(|| {
        tr!(
            "More events in the file: {count}",
            count = grouped(left_out)
        )
    });
    let rows = move || {
        let entries = player
            .bookmarks
            .with(|bookmarks| bookmarks.entries().to_vec());
        in_order(&marks, &entries)
            .into_iter()
            .map(|row| match row {
                Row::Event(mark) => Either::Left(event_row(player, mark)),
                Row::Bookmark(entry) => Either::Right(bookmark_row(player, entry)),
            })
            .collect_view()
    };
    view! {
        <h4>{tr!("Events")}</h4>
        <ol class="session-events" tabindex="0" aria-label=tr!("Events")>
            {rows}
        </ol>
        <p class="quiet">{more}</p>
    }
}

#[derive(Debug, PartialEq, Eq)]
enum Row<'a> {
    Event(&'a SessionMark),
    Bookmark(&'a Entry),
}

impl Row<'_> {
    const fn after_us(&self) -> u64 {
        match self {
            Self::Event(mark) => mark.after_us,
            Self::Bookmark(entry) => entry.bookmark.after_us,
        }
    }
}

fn in_order<'a>(marks: &'a [SessionMark], entries: &'a [Entry]) -> Vec<Row<'a>> {
    let mut rows: Vec<_> = marks.iter().map(Row::Event).collect();
    for entry in entries {
        let place = rows.partition_point(|row| row.after_us() <= entry.bookmark.after_us);
        rows.insert(place, Row::Bookmark(entry));
    }
    rows
}

/// An event. During a replay its button goes there.
fn event_row(player: Player, mark: &SessionMark) -> impl IntoView + use<> {
    let class = if mark.error { "bad" } else { "" };
    let text = mark.text.clone();
    let words = view! { <span class=class>{text}</span> };
    view! { <li>{place(player, mark.after_us, words.into_any())}</li> }
}

/// A bookmark. During a replay its note can be changed.
fn bookmark_row(player: Player, entry: &Entry) -> impl IntoView + use<> {
    let key = entry.key;
    let after_us = entry.bookmark.after_us;
    let words = view! {
        <span>
            <strong class="session-bookmark">{tr!("Bookmark")}</strong>
            " "
            {entry.bookmark.text.clone()}
        </span>
    };
    let name = tr!("Edit bookmark at {time}", time = texts::elapsed(after_us));
    view! {
        <li class="with-edit">
            {place(player, after_us, words.into_any())}
            <button
                type="button"
                class="button small session-edit"
                aria-label=name
                disabled=dynamic(move || reason(player).is_some())
                title=dynamic(move || reason(player))
                aria-description=dynamic(move || reason(player))
                on:click=handler(move |_| {
                    player.seek(after_us);
                    player.bookmarks.update(|bookmarks| bookmarks.edit(key));
                })
            >
                {tr!("Edit")}
            </button>
        </li>
    }
}

/// Why a button cannot be pressed: only a replay has places.
fn reason(player: Player) -> Option<&'static str> {
    let replays = player.info.with(Option::is_some);
    (!replays).then(|| tr!("Press Replay first."))
}

fn place(player: Player, after_us: u64, words: AnyView) -> impl IntoView {
    view! {
        <button
            type="button"
            class="session-event"
            disabled=dynamic(move || reason(player).is_some())
            title=dynamic(move || reason(player))
            aria-description=dynamic(move || reason(player))
            on:click=handler(move |_| player.seek(after_us))
        >
            <span class="session-time">{texts::elapsed(after_us)}</span>
            " "
            {words}
        </button>
    }
}

#[cfg(test)]
mod tests {
    use motorlink_messages::sessions::Bookmark;

    use super::*;

    #[test]
    fn bookmarks_are_between_the_events_of_their_time() {
        let mark = |after_us| SessionMark {
            after_us,
            error: false,
            text: String::new(),
            is_bookmark: false,
        };
        let entry = |key, after_us| Entry {
            key,
            bookmark: Bookmark {
                after_us,
                text: String::new(),
            },
        };
        let (marks, entries) = ([mark(1), mark(5)], [entry(1, 0), entry(2, 5), entry(3, 7)]);
        let rows = in_order(&marks, &entries);
        let times: Vec<_> = rows.iter().map(Row::after_us).collect();
        assert_eq!(times, [0, 1, 5, 5, 7]);
        assert_eq!(rows[2], Row::Event(&marks[1]));
    }
}
