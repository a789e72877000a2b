//! Exports of a run of the virtual motor.

use crate::bench::{Bench, ONE};
use motorlink_experiments::{
    chart::{charts, compared_charts, file},
    kept::{
        Outcome, ReportRun, ReportTexts, RunHeader, figures_to_csv, figures_to_json, record_to_csv,
        report, run_from_json, run_to_json,
    },
    runner::{Cause, End, Record},
    study::{Measured, StepStudy, Study},
};
use motorlink_protocol::Instant;
use motorlink_simulator::MotorConfig;

fn run() -> (Study, RunHeader, Record) {
    let study = Study::Step(StepStudy {
        repeats: 2,
        ..StepStudy::of(ONE)
    });
    let mut bench = Bench::new(7, MotorConfig::default());
    bench.run_sequence(&study.sequence());
    let record = bench.record.clone();
    let header = RunHeader {
        number: 1_790_000_000,
        name: "Step, \"front left\"".to_owned(),
        study: study.to_json(),
        motors: vec![(ONE, "front left".to_owned())],
        model: "DDSM115".to_owned(),
        setup: r#"{"rate":50}"#.to_owned(),
        page_version: "0.1.0".to_owned(),
        began_unix_ms: 1_790_000_000_123.0,
        began: record.began_at(),
        request_hz: 200.0,
        outcome: Outcome::Ended(record.end().unwrap()),
        bytes: 0,
    };
    (study, header, record)
}

#[test]
fn a_run_survives_its_file_with_the_same_figures() {
    let (study, header, record) = run();
    let text = run_to_json(&header, &record);
    let (again, read) = run_from_json(&text).unwrap();
    assert_eq!(again.name, header.name);
    assert_eq!(again.motors, header.motors);
    assert_eq!(again.setup, header.setup);
    assert_eq!(again.study().unwrap(), study);
    assert_eq!(read.samples().len(), record.samples().len());
    assert_eq!(read.marks().len(), record.marks().len());
    let measured = Measured::default();
    assert_eq!(
        study.evaluate(&read, &measured),
        study.evaluate(&record, &measured)
    );
    // Times count from the start in a file, so a second one is equal to the first.
    assert_eq!(run_to_json(&again, &read), text);
}

#[test]
fn an_aborted_run_says_why_in_its_file() {
    let (_, mut header, record) = run();
    for (outcome, name) in [
        (Outcome::PageClosed, "page_closed"),
        (
            Outcome::Ended(End::Aborted {
                cause: Cause::Unplugged,
                at: Instant::from_millis(2_000),
            }),
            "unplugged",
        ),
    ] {
        header.outcome = outcome;
        let text = run_to_json(&header, &record);
        assert!(text.contains(&format!("\"outcome\":\"{name}\"")), "{name}");
        let (again, _) = run_from_json(&text).unwrap();
        assert_eq!(again.outcome.cause(), outcome.cause());
    }
}

#[test]
fn a_damaged_file_is_refused_at_its_place() {
    let (_, header, record) = run();
    let text = run_to_json(&header, &record);
    for (from, to, place) in [
        ("{", "", "JSON"),
        (
            "\"motorlink_run\":1",
            "\"motorlink_run\":2",
            "motorlink_run",
        ),
        (
            "\"request_hz\":200",
            "\"request_hz\":\"fast\"",
            "request_hz",
        ),
        (
            "\"outcome\":\"finished\"",
            "\"outcome\":\"melted\"",
            "outcome",
        ),
        ("\"samples\":[[", "\"samples\":[[true,", "samples"),
        ("\"sent\":[[", "\"sent\":[[-1,", "sent"),
    ] {
        let damaged = text.replacen(from, to, 1);
        assert_ne!(damaged, text, "{place}");
        assert_eq!(run_from_json(&damaged).unwrap_err().place, place);
    }
}

#[test]
fn the_table_has_a_row_for_each_reply() {
    let (_, _, record) = run();
    let table = record_to_csv(&record);
    let mut lines = table.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(head[..4], ["time", "motor", "speed_rpm", "current_a"]);
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), record.samples().len());
    assert!(rows.iter().all(|row| row.len() == head.len()));
    let fastest = rows.iter().map(|row| row[2].parse::<i32>().unwrap()).max();
    assert!((95..=105).contains(&fastest.unwrap()));
    let at_speed = rows.iter().filter(|row| row[6] == "100" && row[7] == "rpm");
    assert!(at_speed.count() > 800);
}

#[test]
fn figures_as_csv_and_json_have_a_row_for_each_step_with_the_parameters() {
    let (study, header, record) = run();
    let found = study.evaluate(&record, &header.measured());
    let table = figures_to_csv(&header, &study, &found);
    let rows: Vec<Vec<&str>> = table
        .lines()
        .map(|line| line.split(',').collect())
        .collect();
    let cell = |name: &str| {
        let place = rows[0].iter().position(|head| *head == name).unwrap();
        rows[1][place]
    };
    assert!(rows.iter().all(|row| row.len() == rows[0].len()));
    let cells = [
        "model",
        "from_rpm",
        "to_rpm",
        "hold_s",
        "acceleration",
        "repeat",
    ]
    .map(cell);
    assert_eq!(cells, ["DDSM115", "0", "100", "3", "1", "1"]);
    assert_eq!((cell("settled"), cell("overshoot")), ("true", "0"));
    let rise_s: f64 = cell("rise_s").parse().unwrap();
    assert!((0.2..0.5).contains(&rise_s), "{rise_s}");
    let json = figures_to_json(&header, &study, &found);
    for part in [
        "{\"motorlink_figures\":1,\"model\":\"DDSM115\",".to_owned(),
        format!("\"study\":{},", study.to_json()),
        format!("\"rise_s\":{},", cell("rise_s")),
    ] {
        assert!(json.contains(&part), "{part} in {json}");
    }
}

#[test]
fn charts_and_report_are_whole_files_that_escape() {
    let (study, header, record) = run();
    let found = study.evaluate(&record, &Measured::default());
    let charts = charts(&found, &|byte| format!("Acceleration {byte}"));
    assert_eq!(charts.len(), 1);
    let svg = file(&charts, &|name| format!("{name:?}"));
    assert!(svg.contains("Acceleration 1") && svg.ends_with("</svg>"));
    let runs = [("a".to_owned(), found.clone()), ("b".to_owned(), found)];
    assert_eq!(compared_charts(&runs)[0].lines.len(), 2);
    let texts = ReportTexts {
        language: "en",
        title: "<Runs>".to_owned(),
    };
    let section = ReportRun {
        name: header.name,
        rows: vec![("Latency".to_owned(), "22 ms".to_owned())],
        meaning: vec!["a < b".to_owned()],
    };
    let html = report(&texts, &[section], &charts, &|name| format!("{name:?}"));
    assert!(html.starts_with("<!DOCTYPE html>\n<html lang=\"en\">"));
    for part in [
        "&lt;Runs&gt;",
        "Step, &quot;front left&quot;",
        "a &lt; b",
        "22 ms",
    ] {
        assert!(html.contains(part), "{part}");
    }
    assert!(!html.contains("src=") && !html.contains("href="));
}

/// The file of a stranger: the page would evaluate each of its steps.
#[test]
fn a_file_with_more_steps_than_its_study_is_refused() {
    let (_, header, record) = run();
    let text = run_to_json(&header, &record);
    let (before, marks) = text.rsplit_once("\"marks\":[").unwrap();
    let many = format!("{}{marks}", "[1,0],".repeat(100_000));
    let refused = run_from_json(&format!("{before}\"marks\":[{many}")).unwrap_err();
    assert_eq!(refused.place, "marks");
    let unordered = text.replacen("\"samples\":[[", "\"samples\":[[90000000,1,1,1,1,1],[", 1);
    assert_eq!(run_from_json(&unordered).unwrap_err().place, "samples");
}
