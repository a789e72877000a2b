//! Experiments in a terminal: figures and files at their end, a stopped motor whatever ends them.

use rustix::process::Signal;

use crate::bench::{Bench, Said, signal};

const ONE_STEP: &str = "step --yes repeats=1 hold_s=1 rest_s=0.5";

#[test]
fn a_step_response_prints_its_figures_and_writes_its_files() {
    let mut bench = Bench::new(&[]);
    let folder = bench.file("results");
    let said = bench.run(&format!("{ONE_STEP} --json --out {folder}"));
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(
        said.err.contains("Motor 0x01 stands, confirmed."),
        "{said:?}"
    );
    let figures: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    let rise = figures["figures"][0]["rise_s"].as_f64().unwrap();
    assert!((0.05..0.5).contains(&rise), "{figures}");
    assert!(bench.stands());
    let files = std::fs::read_dir(folder).unwrap();
    let mut ends: Vec<String> = files
        .map(|file| {
            let name = file.unwrap().file_name().into_string().unwrap();
            name.split_once('.').unwrap().1.to_owned()
        })
        .collect();
    ends.sort();
    assert_eq!(ends, ["csv", "figures.csv", "html", "json"]);
}

#[test]
fn a_motor_in_another_loop_is_switched_first() {
    let mut bench = Bench::new(&[]);
    let driven = bench.run("drive current 0.1 --secs 0.2");
    assert_eq!(driven.code, Some(0), "{driven:?}");
    let said = bench.run(ONE_STEP);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(said.out.contains("rise_s"), "{said:?}");
    assert!(bench.stands());
}

#[test]
fn ctrl_c_in_a_run_stops_both_wheels_and_prints_what_was_measured() {
    let mut bench = Bench::new(&["--ids", "1,2"]);
    let file = bench.file("long.json");
    let long = r#"{ "motorlink_sequence": 1, "steps": [{ "rpm": 60, "for_s": 50 }] }"#;
    std::fs::write(&file, long).unwrap();
    let run = bench.drive(&format!("--id 1,-2 run {file} --yes"), 50.0);
    signal(&run, Signal::INT);
    let said = Said::of(run.wait_with_output().unwrap());
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(said.out.contains("worst_error"), "{said:?}");
    let both = "Motor 0x01 stands, confirmed. Motor 0x02 stands, confirmed.";
    assert!(said.err.contains(both), "{said:?}");
    assert!(bench.stands());
}

#[test]
fn what_cannot_run_is_refused_in_one_line_before_a_wheel_turns() {
    let mut bench = Bench::new(&[]);
    let file = bench.file("sequence.json");
    let wrong = r#"{ "motorlink_sequence": 1, "steps": [{ "rpm": 900, "for_s": 1 }] }"#;
    std::fs::write(&file, wrong).unwrap();
    let cases = [
        (
            format!("run {file} --yes"),
            "steps[0].rpm: 900 is above 330",
        ),
        ("run no.json --yes".to_owned(), "no.json: No such file"),
        (
            "step --yes speed=3".to_owned(),
            "speed: expected one of from_rpm",
        ),
        (
            "step --yes to_rpm=fast".to_owned(),
            "to_rpm: expected a number",
        ),
        (
            "step --yes to_rpm=900".to_owned(),
            "to_rpm: 900 is above 330",
        ),
        (ONE_STEP.replace("--yes", ""), "no terminal to ask on"),
    ];
    for (line, says) in cases {
        let said = bench.run(&line);
        assert_eq!(said.code, Some(2), "{line}: {said:?}");
        assert_eq!(said.err.lines().count(), 1, "{line}: {said:?}");
        assert!(said.err.contains(says), "{line}: {said:?}");
        assert!(bench.stands(), "{line}");
    }
}
