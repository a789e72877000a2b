//! Exports of a run of the virtual motor.

use crate::bench::{Bench, ONE};
use motorlink_experiments::{
    chart::{charts, compared_charts, file},
    kept::{
        Outcome, ReportRun, ReportTexts, RunHeader, figures_to_csv, figures_to_json, record_to_csv,
        report, run_from_json, run_to_json,
    },
    runner::{Cause, End, Mark, Record, RecordPart, Sample, SentSetpoint},
    sequence::Sequence,
    study::{Measured, StepStudy, Study},
};
use motorlink_protocol::{Current, Instant, MotorId, Setpoint, SpeedTarget};
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
fn a_run_with_a_part_that_was_not_stored_lacks_data() {
    let (_, mut header, _) = run();
    assert!(!header.lacks_data(0));
    header.bytes = 3_000;
    assert!(!header.lacks_data(3_000));
    assert!(header.lacks_data(2_000));
    // The page was closed before the size of the last part was stored.
    assert!(!header.lacks_data(4_000));
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
fn a_file_has_no_json_in_strings_and_an_older_one_with_them_is_read() {
    let (study, header, record) = run();
    let text = run_to_json(&header, &record);
    let now = format!("\"study\":{},", study.to_json());
    let before = format!("\"study\":{},", nojson::Json(study.to_json()));
    assert!(text.contains(&now) && text.contains("\"setup\":{\"rate\":50},"));
    let older = text
        .replacen("\"motorlink_run\":2", "\"motorlink_run\":1", 1)
        .replacen(&now, &before, 1)
        .replacen("{\"rate\":50}", r#""{\"rate\":50}""#, 1);
    let (again, _) = run_from_json(&older).unwrap();
    assert_eq!(again.study(), Some(study));
    assert_eq!(again.setup, header.setup);
}

#[test]
fn the_limits_of_a_run_are_the_lower_of_page_and_sequence() {
    let (_, mut header, _) = run();
    header.setup = r#"{"speed_limit_rpm":200,"current_limit_ma":2700}"#.to_owned();
    let text = r#"{ "motorlink_sequence": 1, "limits": { "rpm": 150, "celsius": 60 },
                    "steps": [{ "rpm": 50, "for_s": 1 }] }"#;
    header.study = Study::Sequence(Sequence::from_json(text).unwrap()).to_json();
    let limits = header.limits();
    assert_eq!(limits.rpm, Some(150.0));
    assert_eq!(limits.amps, Some(2.7));
    assert_eq!(limits.celsius, Some(60.0));
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
            "\"motorlink_run\":2",
            "\"motorlink_run\":3",
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
    assert_eq!(
        compared_charts(&runs, &|byte| format!("acceleration {byte}"))[0]
            .lines
            .len(),
        2
    );
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
    let stranger = text.replacen("\"samples\":[[", "\"samples\":[[0,9,1,1,1,1],[", 1);
    assert_eq!(run_from_json(&stranger).unwrap_err().place, "samples");
    let unordered = text.replacen("\"samples\":[[", "\"samples\":[[90000000,1,1,1,1,1],[", 1);
    assert_eq!(run_from_json(&unordered).unwrap_err().place, "samples");
}

/// The largest file that is read: 16 motors, 400,000 replies, 100,000 steps and as many setpoints. `cargo xtask experiments`
/// shows what it prints.
#[test]
fn the_largest_run_is_read_back_and_evaluated() {
    let (_, mut header, _) = run();
    let ids = || (1..=16).map(|id| MotorId::new(id).unwrap());
    header.motors = ids().map(|id| (id, String::new())).collect();
    let text = r#"{ "motorlink_sequence": 1, "steps": [{ "rpm": 50, "for_s": 1 }] }"#;
    header.study = Study::Sequence(Sequence::from_json(text).unwrap()).to_json();
    header.began = Some(Instant::ZERO);
    let at = |n: u32| Instant::from_micros(u64::from(n) * 2_500);
    let id = |n: u32| ids().nth(n as usize % 16).unwrap();
    let speed = |n: u32| SpeedTarget::new(i32::try_from(n % 100).unwrap()).unwrap();
    let part = RecordPart {
        samples: (0..400_000)
            .map(|n| Sample {
                id: id(n),
                at: at(n),
                rpm: Some(i16::try_from(n % 120).unwrap()),
                current: Some(Current::from_raw(300)),
                degrees: Some(66.96),
                celsius: None,
            })
            .collect(),
        sent: (0..100_000)
            .map(|n| SentSetpoint {
                id: id(n),
                at: at(4 * n),
                setpoint: Setpoint::velocity(speed(n)),
            })
            .collect(),
        marks: (0..100_000)
            .map(|n| Mark {
                at: at(4 * n),
                step: 0,
            })
            .collect(),
    };
    let mut record = header.record();
    record.add_part(part);
    let text = run_to_json(&header, &record);
    let now = std::time::Instant::now();
    let (header, record) = run_from_json(&text).unwrap();
    println!(
        "{} MB, read and checked in {:?}",
        text.len() / 1_000_000,
        now.elapsed()
    );
    assert_eq!(record.samples().len(), 400_000);
    assert!(run_to_json(&header, &record) == text, "another run");
    let now = std::time::Instant::now();
    let found = header
        .study()
        .unwrap()
        .evaluate(&record, &header.measured());
    println!("figures of a sequence in {:?}", now.elapsed());
    let now = std::time::Instant::now();
    let charts = charts(&found, &|byte| byte.to_string());
    assert!(!charts.is_empty());
    println!("{} charts in {:?}", charts.len(), now.elapsed());
    let now = std::time::Instant::now();
    let svg = file(&charts, &|name| format!("{name:?}"));
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>"));
    println!("{} kB of SVG in {:?}", svg.len() / 1_000, now.elapsed());
}
