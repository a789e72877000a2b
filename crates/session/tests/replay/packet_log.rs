//! The packet log of a replay.

use motorlink_messages::{
    recorder::{Filter, Kind, LogPage, Row, Window},
    sessions::{FromReplay, ToReplay},
};
use motorlink_protocol::family::Model;

use super::{
    driver::Replay,
    live::{Live, ms, rpm},
};

const NEWEST: Window = Window {
    first: None,
    rows: 20,
};

fn pages(messages: &[FromReplay]) -> Vec<LogPage> {
    let pages = messages.iter().filter_map(|message| match message {
        FromReplay::Log { rows, .. } => Some((**rows).clone()),
        _ => None,
    });
    pages.collect()
}

/// The rows after this request.
fn ask(replay: &mut Replay<'_>, message: ToReplay) -> LogPage {
    let before = replay.messages.len();
    replay.handle(message);
    replay.run(ms(100));
    pages(&replay.messages[before..]).pop().unwrap()
}

/// The last frame that was told.
fn frame(replay: &Replay<'_>) -> Option<Row> {
    let told = replay.messages.iter().rev();
    let mut frames = told.filter_map(|message| match message {
        FromReplay::Log { frame, .. } => Some(frame.as_deref().cloned()),
        _ => None,
    });
    frames.next()?
}

fn file() -> Vec<u8> {
    let mut live = Live::of(Model::Ddsm115);
    live.drive(1, rpm(50));
    live.run(ms(4_000));
    live.end().0
}

#[test]
fn the_log_has_the_rows_before_the_place_in_local_time() {
    let file = file();
    let mut replay = Replay::of(&file);
    let at_start = ask(&mut replay, ToReplay::ShowRows(NEWEST));
    assert_eq!(at_start.end - at_start.oldest, 1);
    // An hour ahead of UTC.
    assert!(
        at_start.rows[0].time.starts_with("14:15:37.9"),
        "{at_start:?}"
    );
    let later = ask(
        &mut replay,
        ToReplay::Seek {
            after_us: 2_000_000,
        },
    );
    let last = later.rows.last().unwrap();
    assert!(
        last.time.as_str() <= "14:15:39.962" && last.time.as_str() > "14:15:39.9",
        "{last:?}"
    );
    assert!(later.kept > 100 && later.rows.len() == 20);
    assert_ne!(later.generation, at_start.generation);
    // It grows while it plays.
    replay.play(1_000);
    let before = replay.messages.len();
    replay.run(ms(500));
    let growing = pages(&replay.messages[before..]);
    assert!(growing.len() > 5);
    assert!(growing.last().unwrap().kept > later.kept + 20);
}

#[test]
fn a_filter_stays_across_jumps() {
    let file = file();
    let mut replay = Replay::of(&file);
    ask(&mut replay, ToReplay::ShowRows(NEWEST));
    let filter = Filter {
        kind: Some(Kind::Rx),
        ..Filter::default()
    };
    ask(
        &mut replay,
        ToReplay::Seek {
            after_us: 1_000_000,
        },
    );
    let filtered = ask(&mut replay, ToReplay::Filter(filter));
    assert!(filtered.rows.iter().all(|row| row.kind == Kind::Rx) && !filtered.rows.is_empty());
    let jumped = ask(
        &mut replay,
        ToReplay::Seek {
            after_us: 3_000_000,
        },
    );
    assert!(jumped.rows.iter().all(|row| row.kind == Kind::Rx) && !jumped.rows.is_empty());
    assert!(jumped.kept > jumped.end - jumped.oldest);
    let collapsed = Filter {
        collapse: true,
        ..Filter::default()
    };
    let collapsed = ask(&mut replay, ToReplay::Filter(collapsed));
    let hides = collapsed
        .rows
        .iter()
        .find(|row| row.collapsed_before > 0)
        .unwrap()
        .number;
    let opened = ask(&mut replay, ToReplay::Toggle(hides));
    assert!(opened.end - opened.oldest > collapsed.end - collapsed.oldest);
}

#[test]
fn a_row_leads_to_its_place() {
    let file = file();
    let mut replay = Replay::of(&file);
    ask(&mut replay, ToReplay::ShowRows(NEWEST));
    let page = ask(
        &mut replay,
        ToReplay::Seek {
            after_us: 3_000_000,
        },
    );
    let row = page.rows[3].clone();
    let there = ask(&mut replay, ToReplay::SeekRow(row.number));
    let place = replay.last().0;
    assert!(
        (2_000_000..3_000_000).contains(&place.after_us),
        "{place:?}"
    );
    let last = there.rows.last().unwrap();
    assert_eq!((&last.time, &last.hex), (&row.time, &row.hex));
    // A row that is not there leads nowhere.
    assert!(replay.ask(ToReplay::SeekRow(u64::MAX)).is_empty());
}

#[test]
fn a_change_of_language_sends_the_rows_again() {
    let file = file();
    let mut replay = Replay::of(&file);
    let before = ask(&mut replay, ToReplay::ShowRows(NEWEST));
    let language = "en".to_owned();
    let texts = None;
    let after = ask(&mut replay, ToReplay::SetLanguage { language, texts });
    assert_ne!(before.generation, after.generation);
    assert_eq!(before.rows.len(), after.rows.len());
}

#[test]
fn the_frame_at_the_place_is_told_whatever_rows_are_shown() {
    let file = file();
    let mut replay = Replay::of(&file);
    ask(&mut replay, ToReplay::ShowRows(NEWEST));
    ask(
        &mut replay,
        ToReplay::Seek {
            after_us: 2_000_000,
        },
    );
    let first = frame(&replay).unwrap();
    for _ in 0..3 {
        // Other rows, and none: the filter matches nothing.
        ask(
            &mut replay,
            ToReplay::ShowRows(Window {
                first: Some(0),
                rows: 1,
            }),
        );
        assert_eq!(frame(&replay).unwrap().hex, first.hex);
        let filter = Filter {
            text: "no frame says this".to_owned(),
            ..Filter::default()
        };
        let rows = ask(&mut replay, ToReplay::Filter(filter));
        assert!(rows.rows.is_empty());
        assert_eq!(frame(&replay).unwrap().hex, first.hex);
    }
    let stepped = |replay: &mut Replay<'_>| {
        ask(replay, ToReplay::Step { forward: true });
        frame(replay).unwrap()
    };
    let next: Vec<String> = (0..4).map(|_| stepped(&mut replay).time).collect();
    assert!(next.is_sorted() && next[0] >= first.time, "{next:?}");
    assert!(next[0] < next[3], "{next:?}");
}
