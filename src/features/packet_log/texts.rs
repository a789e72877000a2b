//! The texts around the rows of the packet log. `crates/recorder/src/row_words.rs` has those of the rows.

use motorlink_i18n::tr;

use crate::{features::packet_log::feed::LogState, ui::format::grouped};

/// Two lines about the entries of the log: how many are visible, and how many are hidden or dropped.
pub(crate) fn of_entries(log: &LogState) -> (String, String) {
    let entries = entries(log.kept);
    let mut others = Vec::new();
    if log.kept > 0 && log.filtered_per_mille < 1000 {
        others.push(tr!(
            "filtering: {percent} %",
            percent = log.filtered_per_mille / 10
        ));
    } else if log.collapsed > 0 {
        others.push(tr!("{count} collapsed", count = grouped(log.collapsed)));
    }
    if log.gone > 0 {
        others.push(tr!("{count} dropped", count = grouped(log.gone)));
    }
    (entries, others.join(", "))
}

/// The same at length.
pub(crate) fn of_entries_at_length(log: &LogState) -> String {
    let (entries, others) = of_entries(log);
    let kept = tr!("{entries} in the log", entries);
    match (others.is_empty(), log.gone) {
        (true, _) => kept,
        (false, 0) => format!("{kept}, {others}"),
        (false, _) => tr!("{kept}, {others} to make room", kept, others),
    }
}

/// The text instead of rows if there are none.
pub(crate) fn of_no_rows(log: &LogState, alive: bool) -> &'static str {
    if !alive {
        tr!("The packet log has stopped. Motors keep running.")
    } else if log.kept == 0 {
        tr!("No frames yet. Each is listed here with its time, to the millisecond.")
    } else if log.shown > 0 || log.filtered_per_mille < 1000 {
        ""
    } else if log.collapsed == log.kept {
        tr!("Only status polls so far. Turn off Collapse status polls to show them.")
    } else {
        tr!("No entries match the filter.")
    }
}

/// `1 entry`, `18 402 entries`
fn entries(number: u64) -> String {
    match number {
        1 => tr!("1 entry").to_owned(),
        count => tr!("{count} entries", count = grouped(count)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOG: LogState = LogState {
        kept: 18_402,
        collapsed: 17_950,
        gone: 3,
        filtered_per_mille: 1000,
        shown: 452,
        following: true,
        new_rows: 0,
    };

    fn plain(text: &str) -> String {
        text.replace('\u{202F}', " ")
    }

    #[test]
    fn the_entries_are_counted_with_what_is_not_shown() {
        let (entries, others) = of_entries(&LOG);
        assert_eq!(plain(&entries), "18 402 entries");
        assert_eq!(plain(&others), "17 950 collapsed, 3 dropped");
        assert_eq!(
            plain(&of_entries_at_length(&LOG)),
            "18 402 entries in the log, 17 950 collapsed, 3 dropped to make room"
        );
        let one = LogState {
            kept: 1,
            filtered_per_mille: 1000,
            ..LogState::default()
        };
        assert_eq!(of_entries(&one), ("1 entry".to_owned(), String::new()));
        assert_eq!(of_entries_at_length(&one), "1 entry in the log");
    }

    #[test]
    fn a_filter_under_way_says_how_far_it_is() {
        let half = LogState {
            filtered_per_mille: 456,
            gone: 0,
            ..LOG
        };
        assert_eq!(of_entries(&half).1, "filtering: 45 %");
        assert_eq!(of_entries(&LogState::default()).1, "");
    }

    #[test]
    fn an_empty_list_says_why() {
        assert!(of_no_rows(&LogState::default(), true).contains("No frames yet"));
        assert!(of_no_rows(&LOG, false).contains("has stopped"));
        assert_eq!(of_no_rows(&LOG, true), "");
        let nothing_shown = LogState { shown: 0, ..LOG };
        assert!(of_no_rows(&nothing_shown, true).contains("No entries match"));
        let all_routine = LogState {
            collapsed: 18_402,
            ..nothing_shown
        };
        assert!(of_no_rows(&all_routine, true).contains("Collapse status polls"));
        let looking = LogState {
            filtered_per_mille: 10,
            ..nothing_shown
        };
        assert_eq!(of_no_rows(&looking, true), "");
    }
}
