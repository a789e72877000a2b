//! All robots as text: a head, and a line for each.

use super::{state::RobotState, watch::Row};
use crate::status::{Level, Phase};

/// What is over the columns.
pub const COLUMNS: [&str; 6] = [
    "ROBOT",
    "STATE",
    "DRIVEN BY",
    "HOTTEST",
    "WORST MOTOR",
    "PAGE",
];

/// How many robots there are, and how many of which kind.
#[must_use]
pub fn head(rows: &[Row], ignored: u64, has_router: bool) -> String {
    let count = |is: fn(&Row) -> bool| rows.iter().filter(|row| is(row)).count();
    let drives = count(|row| {
        let state = row.state.as_ref();
        state.is_some_and(|state| {
            matches!(state.drive().phase, Phase::Drives | Phase::DrivenByOther)
        })
    });
    let problems = count(|row| matches!(row.level(), Level::Error | Level::Warning));
    let not_heard = count(|row| !row.heard);
    let ignored = match ignored {
        0 => String::new(),
        _ => format!(", {ignored} messages ignored"),
    };
    let router = if has_router { "" } else { ", NO ROUTER" };
    format!(
        "{} robots, {drives} driving, {problems} with problems, {not_heard} not heard{ignored}{router}",
        rows.len()
    )
}

/// The columns of a robot.
#[must_use]
pub fn cells(row: &Row) -> [String; 6] {
    let Some(state) = &row.state else {
        let since = row.age_ms.map_or_else(
            || "not heard".to_owned(),
            |age| match age {
                ..1_000 => "NOT HEARD: it has gone".to_owned(),
                age => format!("NOT HEARD for {}.{} s", age / 1_000, age % 1_000 / 100),
            },
        );
        let empty = String::new;
        return [row.name.clone(), since, empty(), empty(), empty(), empty()];
    };
    [
        row.name.clone(),
        of_drive(row.level(), state),
        state.driven_by(),
        state.hottest().map_or_else(
            || "unknown".to_owned(),
            |hottest| format!("{hottest:.0} °C"),
        ),
        state
            .worst_motor()
            .map_or_else(String::new, |(id, status)| format!("{id}: {status}")),
        state.page.clone().unwrap_or_default(),
    ]
}

/// With its level in words: colour is not the only sign.
fn of_drive(level: Level, state: &RobotState) -> String {
    let drive = state.drive();
    match level {
        Level::Error | Level::Stale => format!("ERROR {drive}"),
        Level::Warning => format!("WARNING {drive}"),
        Level::Ok => drive.to_string(),
    }
}

/// The whole table, with columns as wide as their widest cell.
#[must_use]
pub fn plain(rows: &[Row], ignored: u64, has_router: bool) -> String {
    let all = std::iter::once(COLUMNS.map(str::to_owned)).chain(rows.iter().map(cells));
    let all: Vec<_> = all.collect();
    let mut widths = [0; 6];
    for cells in &all {
        for (width, cell) in widths.iter_mut().zip(cells) {
            *width = cell.chars().count().max(*width);
        }
    }
    let mut text = head(rows, ignored, has_router) + "\n";
    for cells in &all {
        let padded = cells.iter().zip(widths);
        let line: Vec<_> = padded
            .map(|(cell, width)| format!("{cell:width$}"))
            .collect();
        text += line.join("  ").trim_end();
        text += "\n";
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fleet::state::tests::json;

    #[test]
    fn the_table_says_in_words_what_is_wrong() {
        let row = |state: Option<String>| Row {
            name: "rover-1".to_owned(),
            session: "a1".to_owned(),
            age_ms: Some(1_250),
            heard: state.is_some(),
            state: state.and_then(|text| RobotState::read(text.as_bytes())),
        };
        let error = json("a1").replace(r#""faults":0"#, r#""silent":true"#);
        let text = plain(&[row(None), row(Some(error))], 3, false);
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(
            lines[0],
            "2 robots, 0 driving, 1 with problems, 1 not heard, 3 messages ignored, NO ROUTER"
        );
        assert_eq!(lines[2], "rover-1  NOT HEARD for 1.2 s");
        let expected = "rover-1  ERROR stopped: a page has control  page 3     28 °C    \
                        1: no reply for 2 s  http://rover.local:8055/";
        assert_eq!(lines[3], expected);
    }
}
