//! What `motorlink doctor` finds on lines that are good, dead or lossy, and that it turns no wheel unasked.

use std::{thread::sleep, time::Duration};

use crate::{
    bench::{Bench, Said},
    controller::attempts,
};

/// Runs it, and returns the highest speed of motor 1 meanwhile.
fn watched(bench: &mut Bench, line: &str) -> (Said, f64) {
    let mut child = bench.command(line).spawn().unwrap();
    let mut fastest = 0.0_f64;
    while child.try_wait().unwrap().is_none() {
        bench.until(|rpm| {
            fastest = fastest.max(rpm.abs());
            true
        });
        sleep(Duration::from_millis(20));
    }
    (Said::of(child.wait_with_output().unwrap()), fastest)
}

/// On a busy machine replies are late, and the line is rightly not healthy: hence [`attempts`].
#[test]
fn a_good_line_is_healthy_at_rest_and_while_the_wheel_turns() {
    attempts(|| {
        let mut bench = Bench::new(&[]);
        let (said, fastest) = watched(&mut bench, "doctor --secs 6 --rpm 60 --yes");
        assert_eq!(said.code, Some(0), "{said:?}");
        assert_eq!(said.out.matches("Bus healthy").count(), 2, "{said:?}");
        assert!((50.0..70.0).contains(&fastest), "{fastest} rpm");
        let stood = "Motor 0x01 stands, confirmed.";
        assert!(said.err.contains(stood), "{said:?}");
        assert!(bench.stands());
    });
}

#[test]
fn a_line_on_which_nobody_answers_says_what_to_check() {
    let said = Bench::new(&["--loss", "1"]).run("--id 1 doctor --secs 6 --rpm 60 --yes");
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(said.out.contains("No bytes received"), "{said:?}");
    assert!(said.out.contains("Swap orange and white"), "{said:?}");
}

#[test]
fn an_adapter_that_only_echoes_is_told_from_a_dead_line() {
    let said = Bench::new(&["--loss", "1", "--echo", "whole"]).run("--id 1 doctor --secs 6");
    assert!(said.out.contains("Only echoes received"), "{said:?}");
}

#[test]
fn lost_replies_are_named_with_their_figures_and_no_wheel_turns_on_such_a_line() {
    let mut bench = Bench::new(&["--lose-replies", "0.3"]);
    let (said, fastest) = watched(&mut bench, "--id 1 doctor --secs 8 --rpm 60 --yes --json");
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(fastest < 1.0, "{fastest} rpm: {said:?}");
    let found: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(found["at_rest"]["verdict"], "faulty", "{found}");
    assert!(found["turning"].is_null(), "{found}");
    let cause = found["at_rest"]["causes"][0]["cause"].as_str().unwrap();
    assert!(cause.starts_with("Replies are lost"), "{found}");
    let motor = &found["counted"][0];
    let lost = motor["without_reply"].as_u64().unwrap();
    assert!(lost >= 5 && motor["motor_id"] == 1, "{found}");
}

/// They reply to the ID query at once, so that only the scan shows their model. [`attempts`] as above.
#[test]
fn several_motors_of_another_model_are_watched_as_that_model() {
    attempts(|| {
        let said = Bench::new(&["--model", "ddsm210", "--ids", "1,2"]).run("doctor --secs 6");
        assert_eq!(said.code, Some(0), "{said:?}");
        assert!(said.out.contains("Bus healthy"), "{said:?}");
    });
}

#[test]
fn no_wheel_turns_unless_a_person_agrees() {
    let mut bench = Bench::new(&[]);
    for (line, why) in [
        ("doctor --rpm 60", "use --yes"),
        ("doctor --rpm 900 --yes", "900"),
        ("doctor --secs 1 --rpm 60 --yes", "--secs"),
    ] {
        let (said, fastest) = watched(&mut bench, line);
        assert_eq!(said.code, Some(2), "{said:?}");
        assert!(said.err.contains(why), "{said:?}");
        assert!(fastest < 1.0, "{fastest} rpm");
    }
}

#[test]
fn of_several_motors_none_turns_that_nobody_named() {
    let mut bench = Bench::new(&["--ids", "1,2"]);
    let (said, fastest) = watched(&mut bench, "doctor --secs 6 --rpm 60 --yes");
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(
        said.err.contains("name those that may turn with --id"),
        "{said:?}"
    );
    assert!(fastest < 1.0, "{fastest} rpm");
}
