//! A view that was updated entry by entry equals a new view.

use motorlink_messages::recorder::{Filter, Kind, LogPage, Row, Window};
use motorlink_protocol::Instant;
use motorlink_recorder::Log;
use proptest::prelude::*;

use crate::line::{
    ALL, at, collapsed, drive, finish, id, log, of_kind, query, reply, silence, text,
};

fn millis(at: u64) -> Instant {
    Instant::from_millis(at)
}

/// A random step.
#[derive(Clone, Debug)]
enum Step {
    Pass(u8),
    Message { late_ms: u64, text: &'static str },
    Filter(u8),
    Advance(u64),
    Toggle(u64),
    Clear,
    UndoClear,
}

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        6_000 => any::<u8>().prop_map(Step::Pass),
        300 => (0..20_u64, prop::sample::select(vec!["drive on", "other"]))
            .prop_map(|(late_ms, text)| Step::Message { late_ms, text }),
        10 => (0..5_u8).prop_map(Step::Filter),
        20 => (1..2_000_u64).prop_map(Step::Advance),
        20 => any::<u64>().prop_map(Step::Toggle),
        1 => Just(Step::Clear),
        2 => Just(Step::UndoClear),
    ]
}

fn filter(which: u8) -> Filter {
    match which {
        0 => Filter::default(),
        1 => text("drive"),
        2 => collapsed(),
        3 => of_kind(Kind::System),
        _ => Filter {
            collapse: true,
            id: Some(id(1)),
            ..Filter::default()
        },
    }
}

fn play(log: &mut Log, now: u64, which: u8, step: &Step) {
    match step {
        Step::Pass(kind) => {
            let address = kind % 2 + 1;
            log.add_event(&at(
                now,
                match kind % 8 {
                    0 | 1 => drive(address, 50),
                    2 => drive(address, (kind / 8).into()),
                    3 => query(address),
                    4..=6 => reply(address, 5),
                    _ => silence(address),
                },
            ));
        }
        Step::Message { late_ms, text } => log.add_message(millis(now - late_ms), false, text),
        Step::Filter(next) => log.filter(&filter(*next)),
        Step::Advance(budget) => _ = log.advance(*budget),
        Step::Toggle(any) => toggle(log, *any),
        Step::Clear => log.clear(),
        Step::UndoClear => _ = log.undo_clear(&filter(which)),
    }
}

/// Opens what is collapsed before one of the newest rows, and closes it: the rows are as before.
fn toggle(log: &mut Log, any: u64) {
    let before = log.page(ALL);
    let hides = |row: &&Row| row.collapsed_before > 0;
    let Some(row) = before.rows.iter().filter(hides).nth((any % 5) as usize) else {
        return;
    };
    let (place, count) = (row.number, row.collapsed_before);
    log.toggle(place);
    let page = log.page(ALL);
    assert_eq!(page.end, before.end + u64::from(count));
    assert_eq!(page.collapsed, before.collapsed - u64::from(count));
    let at = |number| Window {
        first: Some(number),
        rows: 1,
    };
    let first = &log.page(at(place)).rows[0];
    assert_eq!((first.opened, first.collapsed_before), (count, 0));
    let behind = &log.page(at(place + u64::from(count))).rows[0];
    assert_eq!((behind.opened, behind.collapsed_before), (0, 0));
    assert_eq!(behind.meaning, row.meaning);
    // One of them stays open while more comes.
    if !any.is_multiple_of(3) {
        log.toggle(place);
        assert_eq!(log.page(ALL), before);
    }
}

/// All rows, window by window.
fn rows(log: &Log) -> Vec<Row> {
    let LogPage { oldest, end, .. } = log.page(Window {
        first: None,
        rows: 0,
    });
    let windows = (oldest..end).step_by(400);
    windows
        .flat_map(|first| {
            log.page(Window {
                first: Some(first),
                rows: 400,
            })
            .rows
        })
        .collect()
}

/// Asserts that the log shows the same rows after its filter is applied again.
fn assert_agrees_with_new(log: &mut Log, which: u8) {
    finish(log);
    let opened: Vec<u64> = rows(log)
        .iter()
        .filter(|row| row.opened > 0)
        .map(|row| row.number)
        .collect();
    for row in opened.into_iter().rev() {
        log.toggle(row);
    }
    let grown = log.page(ALL);
    let grown_rows = rows(log);
    log.filter(&filter(which));
    finish(log);
    let new = log.page(ALL);
    let new_rows = rows(log);
    assert_eq!(grown.filtered_per_mille, 1000);
    assert_eq!(grown.end - grown.oldest, new.end - new.oldest);
    assert_eq!(
        (grown.collapsed, grown.kept, grown.gone),
        (new.collapsed, new.kept, new.gone)
    );
    assert_eq!(grown_rows.len() as u64, grown.end - grown.oldest);
    for (number, (grown_row, new_row)) in (grown.oldest..).zip(grown_rows.iter().zip(&new_rows)) {
        let renumbered = Row {
            number,
            ..new_row.clone()
        };
        assert_eq!(grown_row, &renumbered);
    }
    if which == 1 || which == 3 {
        log.filter(&Filter::default());
        finish(log);
        let all = rows(log);
        let asked_for = |row: &&Row| match which {
            1 => row.meaning.contains("drive"),
            _ => row.kind == Kind::System,
        };
        let expected = all.iter().filter(asked_for).map(|row| &row.meaning);
        assert!(new_rows.iter().map(|row| &row.meaning).eq(expected));
    }
    let collapsed = grown_rows.iter().map(|row| u64::from(row.collapsed_before));
    assert!(collapsed.sum::<u64>() <= grown.collapsed);
}

#[test]
fn late_lines_at_every_place_leave_rows_and_counts_true() {
    for which in 0..5 {
        let mut log = log(2_500);
        log.filter(&filter(which));
        for now in 100..4_000 {
            play(
                &mut log,
                now,
                which,
                &Step::Pass(u8::try_from(now % 251).unwrap()),
            );
            if now % 3 == 0 {
                let text = "drive on";
                let late_ms = now % 17;
                play(&mut log, now, which, &Step::Message { late_ms, text });
            }
        }
        assert_agrees_with_new(&mut log, which);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// A view shows the same rows as a new one of the same entries, and its rows are consecutive.
    #[test]
    fn a_view_that_grew_equals_a_new_one(steps in prop::collection::vec(step(), 1..6_000)) {
        let mut log = log(2_500);
        let mut which = 0;
        for (now, step) in (100..).zip(&steps) {
            play(&mut log, now, which, step);
            if let Step::Filter(filter) = step {
                which = *filter;
            }
        }
        assert_agrees_with_new(&mut log, which);
    }
}
