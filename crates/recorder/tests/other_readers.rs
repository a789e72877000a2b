//! Python's csv module, pandas and LibreOffice read the exported files.

use std::{
    env,
    ffi::OsString,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use motorlink_bus::LineEvent;
use motorlink_protocol::{Frame, Instant, Layout};
use motorlink_recorder::{CsvFile, Log, Recording};

use crate::line::{ALWAYS, at, drive, heard, junk, log, query, silence};

const NEEDS: &str =
    "needs other programs: cargo xtask test --only csv-readers, or csv-in-libreoffice";

/// Messages that spreadsheets could run, and with every character that needs quotes.
const ENGLISH: [&str; 4] = ["Connected: \"CH343\",\ntwo lines", "=1+1", "-5", "@SUM(A1)"];

const OTHER: [&str; 2] = ["Motor „links“ 66,96°", "电机已连接"];

/// A directory with the files, removed at the end.
struct Files(PathBuf);

impl Files {
    fn new(name: &str) -> Self {
        let dir = env::temp_dir().join(format!("motorlink-{name}-{}", std::process::id()));
        fs::create_dir_all(&dir).unwrap();
        let mut recording = Recording::default();
        for event in traffic() {
            recording.add_event(&event);
        }
        let mut english = log_with(&traffic(), &ENGLISH);
        let mut other = log_with(&[], &OTHER);
        let english_file = CsvFile::of_log(&mut english);
        let other_file = CsvFile::of_log(&mut other);
        for (name, log, file) in [
            ("log.csv", &english, english_file),
            ("other.csv", &other, other_file),
            (
                "telemetry.csv",
                &english,
                CsvFile::of_telemetry(&recording, &ALWAYS),
            ),
            ("plot.csv", &english, CsvFile::of_plot(&recording, &ALWAYS)),
        ] {
            fs::write(dir.join(name), whole(file, log, &recording)).unwrap();
        }
        Self(dir)
    }

    /// Compares what a reader finds in a file with these rows.
    fn assert_read(&self, reader: &str, name: &str, expected: &str) {
        let rows = self.0.join("expected");
        fs::write(&rows, expected).unwrap();
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/other_readers.py");
        let mut command = Command::new(program("MOTORLINK_PYTHON"));
        command.arg(script).arg(reader);
        let output = command.arg(self.0.join(name)).arg(rows).output().unwrap();
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{reader} {name}: {error}");
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn program(variable: &str) -> OsString {
    env::var_os(variable).expect(NEEDS)
}

fn log_with(traffic: &[LineEvent], messages: &[&str]) -> Log {
    let mut log = log(100);
    for event in traffic {
        log.add_event(event);
    }
    for (n, message) in (100..).zip(messages) {
        log.add_message(Instant::from_millis(n), false, message);
    }
    log
}

fn whole(mut file: CsvFile, log: &Log, recording: &Recording) -> Vec<u8> {
    while !file.advance(log, recording, 100) {}
    file.take()
}

/// By hand from the tables of the protocol, as in `csv_files`.
fn traffic() -> [LineEvent; 8] {
    let asked = Frame::with_crc([1, 2, 0x00, 0x0A, 0x00, 0x64, 0x21, 0x59, 0x00]);
    let driven = Frame::with_crc([1, 2, 0xFC, 0x00, 0xFF, 0x9C, 0x17, 0xCF, 0x12]);
    [
        at(0, query(1)),
        at(2, heard(asked, Some(Layout::Query))),
        at(4, drive(1, -100)),
        at(6, heard(driven, Some(Layout::Drive))),
        at(8, drive(1, 100)),
        at(16, silence(1)),
        at(20, junk(&[0x12])),
        at(30, junk(&[0x12, 0x34, 0x56])),
    ]
}

const LOG: &str = r#"["time", "elapsed_s", "direction", "id", "hex", "meaning"]
["2026-11-21T13:15:36.962Z", 0.000, "TX", "0x01", "01 74 00 00 00 00 00 00 00 04", "feedback query"]
["2026-11-21T13:15:36.964Z", 0.002, "RX", "0x01", "01 02 00 0A 00 64 21 59 00 89", "reply +100 rpm, +0.002 A, 33 C, 125.6 deg"]
["2026-11-21T13:15:36.966Z", 0.004, "TX", "0x01", "01 64 FF 9C 00 00 00 00 00 9A", "drive -100 rpm"]
["2026-11-21T13:15:36.968Z", 0.006, "RX", "0x01", "01 02 FC 00 FF 9C 17 CF 12 E4", "reply -100 rpm, -0.250 A, 66.96 deg, fault: bus overcurrent, over-temperature"]
["2026-11-21T13:15:36.970Z", 0.008, "TX", "0x01", "01 64 00 64 00 00 00 00 00 4F", "drive +100 rpm"]
["2026-11-21T13:15:36.978Z", 0.016, "ERR", "0x01", null, "no reply within 8.0 ms"]
["2026-11-21T13:15:36.982Z", 0.020, "ERR", null, "0x12", "1 byte, no valid frame"]
["2026-11-21T13:15:36.992Z", 0.030, "ERR", null, "12 34 56", "3 bytes, no valid frame"]
["2026-11-21T13:15:37.062Z", 0.100, "SYS", null, null, "Connected: \"CH343\",\ntwo lines"]
["2026-11-21T13:15:37.063Z", 0.101, "SYS", null, null, "text: =1+1"]
["2026-11-21T13:15:37.064Z", 0.102, "SYS", null, null, "text: -5"]
["2026-11-21T13:15:37.065Z", 0.103, "SYS", null, null, "text: @SUM(A1)"]"#;

const OTHER_LOG: &str = r#"["time", "elapsed_s", "direction", "id", "hex", "meaning"]
["2026-11-21T13:15:37.062Z", 0.000, "SYS", null, null, "Motor „links“ 66,96°"]
["2026-11-21T13:15:37.063Z", 0.001, "SYS", null, null, "电机已连接"]"#;

const TELEMETRY: &str = r#"["timestamp", "motor_id", "mode", "speed_rpm", "current_a", "temp_c", "position_deg", "error_code", "error_str", "raw_hex"]
["2026-11-21T13:15:36.964Z", 1, "Velocity", 100, 0.002, 33, 125.6, "0x00", "OK", "01 02 00 0A 00 64 21 59 00 89"]
["2026-11-21T13:15:36.968Z", 1, "Velocity", -100, -0.250, null, 66.96, "0x12", "bus overcurrent | over-temperature", "01 02 FC 00 FF 9C 17 CF 12 E4"]"#;

const PLOT: &str = r#"["time", "motor_1_unmirrored_speed_rpm", "motor_1_unmirrored_current_a", "motor_1_unmirrored_position_deg", "motor_1_temperature_c", "motor_1_mode", "motor_1_fault_code", "motor_1_unmirrored_setpoint", "motor_1_setpoint_mode", "motor_1_unmirrored_current_raw"]
[0.000000, 100, 0.002, 125.6, 33, 2, 0, null, null, 10]
[0.004000, -100, -0.250, 66.96, null, 2, 18, -100, 2, -1024]"#;

const FILES: [(&str, &str); 4] = [
    ("log", LOG),
    ("other", OTHER_LOG),
    ("telemetry", TELEMETRY),
    ("plot", PLOT),
];

#[test]
#[ignore = "needs pandas: cargo xtask test --only csv-readers"]
fn python_and_pandas_get_every_value_back() {
    let files = Files::new("python");
    for (name, expected) in FILES {
        for reader in ["csv", "pandas"] {
            files.assert_read(reader, &format!("{name}.csv"), expected);
        }
    }
}

#[test]
#[ignore = "needs LibreOffice: cargo xtask test --only csv-in-libreoffice"]
fn libreoffice_shows_figures_as_numbers_and_runs_no_text() {
    let files = Files::new("libreoffice");
    // As it opens files without a question.
    convert(&files.0, &["log", "telemetry", "plot"], None);
    // Without a window it asks nobody, and takes every file for Windows-1252: 76 is UTF-8.
    convert(&files.0, &["other"], Some("--infilter=CSV:44,34,76"));
    for (name, expected) in FILES {
        files.assert_read("fods", &format!("{name}.fods"), expected);
    }
}

/// Lets LibreOffice make a spreadsheet of each file.
fn convert(dir: &Path, names: &[&str], filter: Option<&str>) {
    // With a profile of its own, it does not matter whether another instance is open.
    let profile = dir.join("profile");
    let mut convert = Command::new(program("MOTORLINK_LIBREOFFICE"));
    convert
        .arg(format!(
            "-env:UserInstallation=file://{}",
            profile.display()
        ))
        .args(["--headless", "--convert-to", "fods"])
        .args(filter)
        .arg("--outdir")
        .arg(dir)
        .args(names.iter().map(|name| dir.join(format!("{name}.csv"))));
    let output = convert.output().unwrap();
    assert!(output.status.success(), "{output:?}");
}
