//! What `motorlink doctor` finds on lines that are good, dead or lossy.

use crate::bench::Bench;

fn healthy(said: &str) -> bool {
    said.contains("Bus healthy")
}

#[test]
fn a_good_line_is_healthy_at_rest_and_while_the_wheel_turns() {
    let mut bench = Bench::new(&[]);
    let said = bench.run("doctor --secs 6 --rpm 60 --yes");
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(healthy(&said.out), "{said:?}");
    assert!(
        said.err.contains("Motor 0x01 stands, confirmed."),
        "{said:?}"
    );
    assert!(bench.stands());
}

#[test]
fn a_line_on_which_nobody_answers_says_what_to_check() {
    let said = Bench::new(&["--loss", "1"]).run("--id 1 doctor --secs 4 --rpm 60 --yes");
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(said.out.contains("No bytes received"), "{said:?}");
    assert!(said.out.contains("Swap orange and white"), "{said:?}");
}

#[test]
fn an_adapter_that_only_echoes_is_told_from_a_dead_line() {
    let said = Bench::new(&["--loss", "1", "--echo", "whole"]).run("--id 1 doctor --secs 4");
    assert!(said.out.contains("Only echoes received"), "{said:?}");
}

#[test]
fn lost_replies_are_named_with_their_figures() {
    let said = Bench::new(&["--lose-replies", "0.3"]).run("doctor --secs 8 --json");
    assert_eq!(said.code, Some(1), "{said:?}");
    let found: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(found["verdict"], "faulty", "{found}");
    let cause = found["causes"][0]["cause"].as_str().unwrap();
    assert!(cause.starts_with("Replies are lost"), "{found}");
    let motor = &found["counted"][0];
    let lost = motor["without_reply"].as_u64().unwrap();
    assert!(lost >= 5 && motor["of"] == "0x01", "{found}");
}

#[test]
fn no_wheel_turns_unless_a_person_agrees() {
    let mut bench = Bench::new(&[]);
    let said = bench.run("doctor --secs 1 --rpm 60");
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("use --yes"), "{said:?}");
    assert!(bench.stands());
    let wrong = bench.run("doctor --secs 1 --rpm 900 --yes");
    assert_eq!(wrong.code, Some(2), "{wrong:?}");
    assert!(bench.stands());
}
