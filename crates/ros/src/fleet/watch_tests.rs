//! What is known of robots, over virtual time, and what is not taken from the network.
#![cfg(test)]

use super::*;
use crate::fleet::state::tests::json;

const STATE: &str = "motorlink/rover-1/state";

fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

fn names(rows: &[Row]) -> Vec<(&str, bool)> {
    let each = rows.iter();
    each.map(|row| (row.name.as_str(), row.heard)).collect()
}

/// The state after that of `json`.
fn next(session: &str) -> String {
    json(session).replace(r#""number":7"#, r#""number":8"#)
}

/// A robot with its token and one state.
fn hear(watch: &mut Watch, now: Instant, name: &str, session: &str, level: &str) {
    watch.take_token(now, &format!("motorlink/@alive/{name}/{session}"), true);
    let state = json(session).replace(r#""level":"ok""#, &format!(r#""level":"{level}""#));
    watch.take_state(now, &format!("motorlink/{name}/state"), state.as_bytes());
}

#[test]
fn a_robot_is_heard_while_its_token_and_a_new_state_are_there() {
    let start = Instant::now();
    let mut watch = Watch::default();
    watch.take_state(start, STATE, json("a1").as_bytes());
    assert_eq!(names(&watch.rows(start)), [("rover-1", false)]);
    watch.take_token(start, "motorlink/@alive/rover-1/a1", true);
    let rows = watch.rows(start + ms(80));
    assert_eq!(names(&rows), [("rover-1", true)]);
    assert_eq!((rows[0].age_ms, rows[0].session.as_str()), (Some(80), "a1"));
    let rows = watch.rows(start + ms(1_001));
    assert_eq!((rows[0].heard, rows[0].age_ms), (false, Some(1_001)));
    assert_eq!(rows[0].state, None);
    // One that the network has delayed tells nothing about now.
    watch.take_state(start + ms(1_100), STATE, json("a1").as_bytes());
    assert!(!watch.rows(start + ms(1_100))[0].heard);
    watch.take_state(start + ms(1_100), STATE, next("a1").as_bytes());
    assert!(watch.rows(start + ms(1_100))[0].heard);
    watch.take_token(start + ms(1_101), "motorlink/@alive/rover-1/a1", false);
    assert!(!watch.rows(start + ms(1_101))[0].heard);
}

#[test]
fn a_robot_that_was_never_heard_has_no_age() {
    let start = Instant::now();
    let mut watch = Watch::default();
    watch.take_token(start, "motorlink/@alive/rover-1/a1", true);
    let rows = watch.rows(start + ms(500));
    assert_eq!(
        serde_json::to_string(&rows).unwrap(),
        r#"[{"name":"rover-1","session":"a1","heard":false}]"#
    );
}

#[test]
fn problems_come_first_and_then_names() {
    let start = Instant::now();
    let mut watch = Watch::default();
    for (name, level) in [("d", "ok"), ("b", "warning"), ("c", "error"), ("a", "ok")] {
        hear(&mut watch, start, name, "a1", level);
    }
    watch.take_token(start, "motorlink/@alive/e/a1", true);
    let rows = watch.rows(start);
    let order: Vec<_> = rows.iter().map(|row| row.name.as_str()).collect();
    assert_eq!(order, ["e", "c", "b", "a", "d"]);
}

#[test]
fn two_robots_with_one_name_are_two_rows_until_one_has_gone_for_long() {
    let start = Instant::now();
    let mut watch = Watch::default();
    hear(&mut watch, start, "rover-1", "a1", "ok");
    hear(&mut watch, start, "rover-1", "b2", "ok");
    assert_eq!(watch.rows(start).len(), 2);
    watch.take_token(start, "motorlink/@alive/rover-1/a1", false);
    assert_eq!(
        names(&watch.rows(start + ms(900))),
        [("rover-1", false), ("rover-1", true)]
    );
    let later = start + ms(60_001);
    watch.take_state(later, STATE, next("b2").as_bytes());
    assert_eq!(names(&watch.rows(later)), [("rover-1", true)]);
    // Without another one it stays.
    let much_later = later + ms(3_600_000);
    assert_eq!(names(&watch.rows(much_later)), [("rover-1", false)]);
}

#[test]
fn what_is_no_state_is_ignored_and_counted() {
    let now = Instant::now();
    let mut watch = Watch::default();
    let valid = json("a1");
    let wrong = [
        ("motorlink/a b/state", valid.clone()),
        ("motorlink/rover-1/other", valid.clone()),
        ("motorlink/\x1b[2J/state", valid.clone()),
        (STATE, String::new()),
        (STATE, "{".repeat(10_000)),
        (STATE, "[".repeat(10_000)),
        (STATE, valid.clone() + &" ".repeat(17_000)),
        (STATE, json("not hex")),
        (STATE, json("")),
        (STATE, json(&"a".repeat(33))),
    ];
    let replaced = [
        (r#""format":1"#, r#""format":2"#),
        (r#""ok""#, r#""fine""#),
        ("99.8", "NaN"),
        ("99.8", "1e999"),
        ("99.8", "1e39"),
        ("left_wheel_joint", r"a\u001b[2J"),
        ("left_wheel_joint", r"a\u202eb"),
        ("http://rover.local:8055/", "javascript:alert(1)"),
        ("http://rover.local:8055/", r"http://a/\u001b[2J"),
        (r#""id":1"#, r#""id":0"#),
        (r#""id":1"#, r#""id":300"#),
        (r#""number":7"#, r#""number":-7"#),
    ];
    let replaced = replaced.map(|(from, to)| {
        assert!(valid.contains(from), "{from}");
        (STATE, valid.replace(from, to))
    });
    let mut count = 0;
    for (key, text) in wrong.iter().chain(&replaced) {
        watch.take_state(now, key, text.as_bytes());
        count += 1;
        assert_eq!(watch.ignored(), count, "{key:?} {text:.200}");
    }
    watch.take_state(now, STATE, &[0xff, 0xfe]);
    for key in [
        "motorlink/@alive/a/xyz",
        "motorlink/a/b",
        "motorlink/@alive/a b/a1",
    ] {
        watch.take_token(now, key, true);
    }
    assert_eq!(watch.ignored(), count + 4);
    assert!(watch.rows(now).is_empty());
}

#[test]
fn more_robots_than_the_limit_are_ignored_and_one_that_has_gone_makes_room() {
    let start = Instant::now();
    let mut watch = Watch::default();
    for number in 0..ROBOTS_MAX + 5 {
        watch.take_token(start, &format!("motorlink/@alive/r{number}/a1"), true);
    }
    assert_eq!((watch.rows(start).len(), watch.ignored()), (ROBOTS_MAX, 5));
    let later = start + ms(60_001);
    hear(&mut watch, later, "r1", "a1", "ok");
    assert_eq!(names(&watch.rows(later)), [("r1", true)]);
    hear(&mut watch, later, "new", "a1", "ok");
    assert_eq!(watch.rows(later).len(), 2);
}
