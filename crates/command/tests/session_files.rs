//! The command, as a person runs it.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_messages::experiments::{
    kept::{Outcome, RunHeader, run_from_json},
    runner::{Record as RunRecord, RecordPart, Sample},
};
use motorlink_protocol::{Current, Instant, Layout, Mode, MotorId};
use motorlink_session::{Event, EventKind, Writer};

struct Fixture(tempfile::TempDir);

/// A run with one reply.
fn run() -> (RunHeader, RunRecord) {
    let id = MotorId::new(1).unwrap();
    let header = RunHeader {
        number: 1_795_266_946,
        name: "../gravel \u{1b}[2J".to_owned(),
        study: String::new(),
        motors: vec![(id, "front left".to_owned())],
        model: "ddsm115".to_owned(),
        setup: "{}".to_owned(),
        page_version: "0.1.0".to_owned(),
        began_unix_ms: 1_795_266_946_962.0,
        began: Some(Instant::ZERO),
        request_hz: 50.0,
        outcome: Outcome::PageClosed,
        bytes: 0,
    };
    let mut record = header.record();
    record.add_part(RecordPart {
        samples: vec![Sample {
            id,
            at: Instant::from_millis(20),
            rpm: Some(98),
            current: Some(Current::from_raw(717)),
            degrees: Some(66.96),
            celsius: None,
        }],
        ..RecordPart::default()
    });
    (header, record)
}

const ROVER: &str = r#"{"wheel_radius_mm":51,"track_width_mm":300,"wheels":[{"id":1,"side":"left","forward_sign":1},{"id":2,"side":"right","forward_sign":-1}]}"#;

impl Fixture {
    fn new() -> Self {
        let fixture = Self(tempfile::tempdir().unwrap());
        let about = [("page", "0.1.0"), ("rover", ROVER)];
        let mut writer = Writer::new(1_795_266_936_962_000, &about);
        writer.event(
            Instant::ZERO,
            &Event::new(EventKind::Connected, "Connected"),
        );
        for n in 0..20 {
            let at = Instant::from_millis(n * 20);
            let frame = "01 64 00 64 00 00 00 00 00 4F".parse().unwrap();
            let mode = Some(Mode::Velocity);
            writer.line(&LineEvent {
                at,
                kind: LineEventKind::Sent { frame, mode },
            });
            let frame = "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap();
            let asked = Some(Layout::Drive);
            writer.line(&LineEvent {
                at: Instant::from_millis(n * 20 + 2),
                kind: LineEventKind::Received { frame, asked },
            });
        }
        writer.attach("setup.json", "application/json", b"{}");
        let (header, record) = run();
        writer.attach_run(&header, &record);
        fs::write(fixture.path("run.mcap"), writer.finish()).unwrap();
        fixture
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, arguments: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_motorlink"));
        command.arg("session");
        command.current_dir(self.0.path()).args(arguments);
        command.output().unwrap()
    }

    /// Writes `run.mcap` again as `copy.mcap`.
    fn copy(&self) {
        let to = ["--format", "mcap", "--out", "copy.mcap"];
        self.prints(&[&["export", "run.mcap"], &to[..]].concat());
    }

    /// What it prints, where it succeeds.
    fn prints(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{arguments:?}: {error}");
        String::from_utf8(output.stdout).unwrap()
    }
}

#[test]
fn info_says_what_is_in_a_file() {
    let text = Fixture::new().prints(&["info", "run.mcap"]);
    let rover = format!("rover       {ROVER}");
    for part in [
        "page        0.1.0",
        &rover,
        "from        2026-11-21T13:15:36.962Z",
        "duration    0.382 s",
        "frames      20 sent, 20 received",
        "motor 1     20 replies, 0 lost, +100 rpm to +100 rpm, +0.175 A to +0.175 A, faults: OK",
        "attachment  setup.json",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
}

#[test]
fn check_passes_a_good_file_and_fails_a_damaged_one() {
    let fixture = Fixture::new();
    let text = fixture.prints(&["check", "run.mcap"]);
    assert_eq!(
        text,
        "40 entries of the line, 1 events and 0 states of the page read\nno damage found\n"
    );
    let mut bytes = fs::read(fixture.path("run.mcap")).unwrap();
    bytes.truncate(bytes.len() - 100);
    fs::write(fixture.path("cut.mcap"), bytes).unwrap();
    let output = fixture.run(&["check", "cut.mcap"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(
        text.contains("40 entries") && text.contains("end of the file is missing"),
        "{text}"
    );
}

#[test]
fn a_csv_file_that_was_exported_is_the_same_session_again() {
    let fixture = Fixture::new();
    let log = fixture.prints(&["export", "run.mcap", "--format", "log"]);
    assert_eq!(log.lines().count(), 42);
    fs::write(fixture.path("log.csv"), &log).unwrap();
    let out = fixture.path("again.mcap");
    let arguments = [
        "export",
        "log.csv",
        "--format",
        "mcap",
        "--out",
        "again.mcap",
    ];
    assert_eq!(fixture.prints(&arguments), "");
    assert!(Path::new(&out).is_file());
    assert_eq!(
        fixture.prints(&["export", "again.mcap", "--format", "log"]),
        log
    );
    assert_eq!(
        fixture.prints(&["export", "log.csv", "--format", "log"]),
        log
    );
}

#[test]
fn every_format_is_written() {
    let fixture = Fixture::new();
    let plot = fixture.prints(&["export", "run.mcap"]);
    assert!(
        plot.starts_with("time,motor_1_unmirrored_speed_rpm,motor_1_unmirrored_current_a,"),
        "{plot}"
    );
    assert_eq!(plot.lines().count(), 21);
    let first = plot.lines().nth(1);
    assert_eq!(first, Some("0.000000,100,0.175,66.96,,2,0,100,2,717"));
    let telemetry = fixture.prints(&["export", "run.mcap", "--format", "telemetry"]);
    assert!(
        telemetry.starts_with("timestamp,motor_id,mode,"),
        "{telemetry}"
    );
    assert_eq!(telemetry.lines().count(), 21);
    let report = fixture.prints(&["export", "run.mcap", "--format", "report"]);
    assert!(report.starts_with("<!DOCTYPE html>") && report.contains("run.mcap"));
    fixture.copy();
    assert!(
        fixture
            .prints(&["info", "copy.mcap"])
            .contains("setup.json")
    );
}

#[test]
fn runs_are_written_as_files_of_a_folder() {
    let fixture = Fixture::new();
    let text = fixture.prints(&["info", "run.mcap"]);
    assert!(
        text.contains("attachment  run-1795266946 ..-gravel"),
        "{text}"
    );
    let text = fixture.prints(&["runs", "run.mcap", "--out", "runs"]);
    assert_eq!(
        text,
        "..-gravel -[2J: runs/run-1795266946.json, runs/run-1795266946.csv\n"
    );
    let read = |name| fs::read_to_string(fixture.path(name)).unwrap();
    let table = read("runs/run-1795266946.csv");
    assert!(table.contains("\n0.020000,1,98,0.175,66.96,,"), "{table}");
    let (again, _) = run_from_json(&read("runs/run-1795266946.json")).unwrap();
    assert_eq!(again.motors, run().0.motors);
    // A copy of the session has it too.
    fixture.copy();
    assert_eq!(
        fixture.prints(&["runs", "copy.mcap"]),
        "..-gravel -[2J: ./run-1795266946.json, ./run-1795266946.csv\n"
    );
}

/// The runs are at the end of a file.
#[test]
fn a_file_whose_end_is_missing_does_not_seem_to_have_had_no_runs() {
    let fixture = Fixture::new();
    let whole = fs::read(fixture.path("run.mcap")).unwrap();
    fs::write(fixture.path("cut.mcap"), &whole[..whole.len() / 2]).unwrap();
    let output = fixture.run(&["runs", "cut.mcap", "--out", "runs"]);
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(
        error.contains("cut.mcap: The end of the file is missing"),
        "{error}"
    );
    assert!(!error.contains("experiments in it"), "{error}");
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn what_is_no_session_is_refused_in_words() {
    let fixture = Fixture::new();
    for (name, bytes, words) in [
        ("empty", &b""[..], "The file is empty."),
        ("notes.txt", b"a,b\n1,2\n", "no columns of a known export"),
        ("run.zip", b"PK\x03\x04....", "ZIP archive"),
        ("picture.png", b"\x89PNG\r\n\x1A\n", "Not a session file."),
    ] {
        fs::write(fixture.path(name), bytes).unwrap();
        let output = fixture.run(&["info", name]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{name}");
        assert!(error.contains(words), "{name}: {error}");
    }
    assert_eq!(fixture.run(&["info", "missing"]).status.code(), Some(2));
}

/// `run.mcap` with a damaged first chunk, and as another program compresses it.
fn with_losses(fixture: &Fixture) -> [&'static str; 2] {
    let whole = fs::read(fixture.path("run.mcap")).unwrap();
    let name = whole.windows(7).position(|seven| seven == b"\x03\0\0\0lz4");
    let name = name.unwrap();
    let mut damaged = whole.clone();
    damaged[name + 100] ^= 1;
    fs::write(fixture.path("damaged.mcap"), damaged).unwrap();
    // The chunk is longer by a byte, so no index fits. Without the end it has no overview either.
    let mut zstd = whole;
    zstd.splice(name..name + 7, *b"\x04\0\0\0zstd");
    zstd[name - 36] += 1;
    let overview = zstd.windows(13).position(|words| words == b"overview.json");
    zstd.truncate(overview.unwrap());
    fs::write(fixture.path("zstd.mcap"), zstd).unwrap();
    ["damaged.mcap", "zstd.mcap"]
}

#[test]
fn an_export_says_what_is_missing_and_fails() {
    let fixture = Fixture::new();
    let [damaged, zstd] = with_losses(&fixture);
    for format in ["plot", "telemetry", "log", "mcap", "report"] {
        for (file, words) in [
            (damaged, "damaged and was left out"),
            (zstd, "mcap compress --compression lz4"),
        ] {
            let output = fixture.run(&["export", file, "--format", format, "--out", "out"]);
            let error = String::from_utf8(output.stderr).unwrap();
            // The report of a file with its overview lacks nothing.
            let is_whole = format == "report" && file == damaged;
            let code = i32::from(!is_whole);
            assert_eq!(output.status.code(), Some(code), "{file} {format}: {error}");
            assert!(
                is_whole || error.contains(words),
                "{file} {format}: {error}"
            );
        }
    }
    let report = fs::read_to_string(fixture.path("out")).unwrap();
    assert!(report.contains("mcap compress"), "{report}");
}
