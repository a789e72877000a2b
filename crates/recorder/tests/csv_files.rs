//! CSV files, parsed again.

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_messages::recorder::{Filter, Kind, Row, Window};
use motorlink_protocol::{Faults, Frame, Instant, Layout, Mode, family::Model};
use motorlink_recorder::{CsvFile, Log, REPLY, Recording, spelled_out, unmarked};
use proptest::prelude::*;

use crate::line::{ALWAYS, at, collapsed, drive, driven, heard, junk, log, query, reply, silence};

/// A complete file, written in slices of this many lines.
fn whole(mut file: CsvFile, log: &Log, recording: &Recording, slice: u64) -> (String, u64) {
    let mut bytes = Vec::new();
    while !file.advance(log, recording, slice) {
        if file.written() > 4_000 {
            bytes.append(&mut file.take());
        }
    }
    bytes.append(&mut file.take());
    (String::from_utf8(bytes).unwrap(), file.rows())
}

fn log_file(log: &mut Log, slice: u64) -> (String, u64) {
    let file = CsvFile::of_log(log);
    whole(file, log, &Recording::default(), slice)
}

fn telemetry_file(traffic: &[LineEvent]) -> String {
    let mut recording = Recording::default();
    for passed in traffic {
        recording.add_event(passed);
    }
    let file = CsvFile::of_telemetry(&recording, &ALWAYS);
    whole(file, &log(10), &recording, 3).0
}

fn read(file: &str) -> Vec<Vec<String>> {
    let mut reader = csv::Reader::from_reader(file.as_bytes());
    let records = reader.records().map(Result::unwrap);
    records
        .map(|record| record.iter().map(str::to_owned).collect())
        .collect()
}

#[test]
fn a_log_is_written_line_by_line() {
    let mut log = log(100);
    log.add_event(&at(0, drive(1, -100)));
    log.add_event(&at(
        2,
        heard(
            "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap(),
            Some(Layout::Drive),
        ),
    ));
    log.add_event(&at(10, silence(1)));
    log.add_event(&at(1_000, junk(&[1, 2, 3])));
    log.add_message(
        Instant::from_micros(61_001_999),
        false,
        "said \"so\", twice\nor more",
    );
    log.add_message(Instant::from_millis(61_002), true, "=1+1");
    log.add_event(&at(61_003, junk(&[0x12])));
    let (file, rows) = log_file(&mut log, 1_000);
    let expected = "\
time,elapsed_s,direction,id,hex,meaning\r
2026-11-21T13:15:36.962Z,0.000,TX,0x01,01 64 FF 9C 00 00 00 00 00 9A,drive -100 rpm\r
2026-11-21T13:15:36.964Z,0.002,RX,0x01,01 02 02 CD 00 64 17 CF 00 8F,\"reply +100 rpm, +0.175 A, 66.96 deg\"\r
2026-11-21T13:15:36.972Z,0.010,ERR,0x01,,no reply within 8.0 ms\r
2026-11-21T13:15:37.962Z,1.000,ERR,,01 02 03,\"3 bytes, no valid frame\"\r
2026-11-21T13:16:37.963Z,61.001,SYS,,,\"said \"\"so\"\", twice\nor more\"\r
2026-11-21T13:16:37.964Z,61.002,ERR,,,text: =1+1\r
2026-11-21T13:16:37.965Z,61.003,ERR,,0x12,\"1 byte, no valid frame\"\r
";
    assert_eq!(file, expected);
    assert_eq!(rows, 7);
}

#[test]
fn a_log_with_other_letters_is_utf_8_and_says_so() {
    let mut log = log(10);
    log.add_event(&at(0, drive(1, -100)));
    log.add_message(Instant::from_millis(1), false, "Motor „links“, −2°");
    let expected = "\
\u{FEFF}time,elapsed_s,direction,id,hex,meaning\r
2026-11-21T13:15:36.962Z,0.000,TX,0x01,01 64 FF 9C 00 00 00 00 00 9A,drive -100 rpm\r
2026-11-21T13:15:36.963Z,0.001,SYS,,,\"Motor „links“, −2°\"\r
";
    assert_eq!(log_file(&mut log, 10).0, expected);
}

#[test]
fn a_file_has_what_is_collapsed_or_filtered_out() {
    let mut log = log(5_000);
    for n in 0..3_000 {
        log.add_event(&driven(n));
    }
    log.filter(&collapsed());
    let (file, rows) = log_file(&mut log, 100);
    assert_eq!(rows, 3_000);
    assert_eq!(read(&file).len(), 3_000);
}

#[test]
fn seconds_are_counted_from_the_first_entry_that_is_kept() {
    let mut log = log(10);
    for n in 0..25 {
        log.add_event(&at(n * 500, query(1)));
    }
    let records = read(&log_file(&mut log, 3).0);
    assert_eq!(records[0][..2], ["2026-11-21T13:15:44.462Z", "0.000"]);
    assert_eq!(records[9][1], "4.500");
}

#[test]
fn entries_that_go_or_come_while_a_file_is_made_leave_it_true() {
    let mut log = log(100);
    let recording = Recording::default();
    for n in 0..100 {
        log.add_event(&at(n, query(1)));
    }
    let mut file = CsvFile::of_log(&mut log);
    assert_eq!(file.rows_in_all(), 100);
    assert!(!file.advance(&log, &recording, 20));
    for n in 100..150 {
        log.add_event(&at(n, query(2)));
    }
    log.add_message(Instant::from_millis(90), false, "late");
    assert!(file.advance(&log, &recording, 1_000));
    assert_eq!((file.rows(), file.rows_in_all()), (69, 69));
    let records = read(&String::from_utf8(file.take()).unwrap());
    assert_eq!(records.len(), 69);
    assert!(
        records.iter().all(|record| record[3] == "0x01"),
        "none that came later"
    );
    let seconds: Vec<_> = records.iter().map(|record| record[1].as_str()).collect();
    assert_eq!(
        (seconds[19], seconds[20], seconds[68]),
        ("0.019", "0.051", "0.099")
    );
}

#[test]
fn a_file_of_a_log_that_was_cleared_ends() {
    let mut log = log(5_000);
    let recording = Recording::default();
    for n in 0..3_000 {
        log.add_event(&driven(n));
    }
    let mut file = CsvFile::of_log(&mut log);
    assert!(!file.advance(&log, &recording, 1_000));
    log.clear();
    log.add_event(&driven(5_000));
    assert!(file.advance(&log, &recording, 1));
    assert_eq!((file.rows(), file.rows_in_all()), (1_000, 1_000));
}

/// By hand from the tables of the protocol: current = raw x 8 / 32767, angle = raw x 360 / 32767 or
/// raw x 360 / 255.
#[test]
fn telemetry_has_the_columns_of_the_article() {
    let asked = Frame::with_crc([1, 2, 0x00, 0x0A, 0x00, 0x64, 0x21, 0x59, 0x00]);
    let faulty = Frame::with_crc([7, 1, 0xFC, 0x00, 0xFF, 0x9C, 0x21, 0x59, 0x12]);
    let odd = Frame::with_crc([254, 3, 0, 0, 0, 0, 0x7F, 0xFF, 0x20]);
    let file = telemetry_file(&[
        at(0, query(1)),
        at(2, heard(asked, Some(Layout::Query))),
        at(4, drive(1, 100)),
        at(
            6,
            heard(
                "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap(),
                Some(Layout::Drive),
            ),
        ),
        at(8, silence(1)),
        at(9, junk(&[1; 10])),
        at(10, heard(faulty, None)),
        at(12, heard(odd, Some(Layout::Drive))),
    ]);
    let expected = format!(
        "timestamp,motor_id,mode,speed_rpm,current_a,temp_c,position_deg,error_code,error_str,raw_hex\r
2026-11-21T13:15:36.964Z,1,Velocity,100,0.002,33,125.6,0x00,OK,{asked}\r
2026-11-21T13:15:36.968Z,1,Velocity,100,0.175,,66.96,0x00,OK,01 02 02 CD 00 64 17 CF 00 8F\r
2026-11-21T13:15:36.972Z,7,Current,-100,-0.250,,,0x12,bus overcurrent | over-temperature,{faulty}\r
2026-11-21T13:15:36.974Z,254,Position,0,0.000,,360.00,0x20,unknown bits 0x20,{odd}\r
"
    );
    assert_eq!(file, expected);
}

/// A file for plotting of this traffic, written in slices of this many lines.
fn plot_file(traffic: &[LineEvent], slice: u64) -> String {
    let mut recording = Recording::default();
    for passed in traffic {
        recording.add_event(passed);
    }
    let file = CsvFile::of_plot(&recording, &ALWAYS);
    whole(file, &log(10), &recording, slice).0
}

/// Values by hand, as in the test before: current = raw x 8 / 32767, angle = raw x 360 / 32767.
#[test]
fn a_file_for_plotting_has_commanded_beside_measured_values() {
    let reply_in = |address, mode| {
        let frame = Frame::with_crc([address, mode, 0xFC, 0x00, 0xFF, 0x9C, 0x17, 0xCF, 0x08]);
        heard(frame, Some(Layout::Drive))
    };
    let asked = Frame::with_crc([7, 2, 0x00, 0x0A, 0x00, 0x64, 0x21, 0x59, 0x00]);
    let in_loop = |frame: &str, mode| LineEventKind::Sent {
        frame: frame.parse().unwrap(),
        mode,
    };
    let traffic = [
        at(0, query(7)),
        at(2, heard(asked, Some(Layout::Query))),
        at(4, drive(7, -100)),
        at(6, heard(asked, Some(Layout::Query))),
        // The value before it was for another loop.
        at(10, in_loop("01 A0 00 00 00 00 00 00 00 01", None)),
        at(12, reply_in(1, 1)),
        at(
            20,
            in_loop("01 64 FC 00 00 00 00 00 00 11", Some(Mode::Current)),
        ),
        at(22, reply_in(1, 1)),
        at(
            30,
            in_loop("01 64 20 00 00 00 00 00 00 BF", Some(Mode::Position)),
        ),
        at(32, reply_in(1, 3)),
        // Nothing drives the motor any more.
        at(1_531, heard(asked, None)),
    ];
    let expected = "\
time,motor_1_unmirrored_speed_rpm,motor_1_unmirrored_current_a,motor_1_unmirrored_position_deg,motor_1_temperature_c,motor_1_mode,motor_1_fault_code,motor_1_unmirrored_setpoint,motor_1_setpoint_mode,motor_1_unmirrored_current_raw,\
motor_7_unmirrored_speed_rpm,motor_7_unmirrored_current_a,motor_7_unmirrored_position_deg,motor_7_temperature_c,motor_7_mode,motor_7_fault_code,motor_7_unmirrored_setpoint,motor_7_setpoint_mode,motor_7_unmirrored_current_raw\r
0.000000,,,,,,,,,,100,0.002,125.6,33,2,0,,,10\r
0.004000,,,,,,,,,,100,0.002,125.6,33,2,0,-100,2,10\r
0.010000,-100,-0.250,66.96,,1,8,,,-1024,,,,,,,,,\r
0.020000,-100,-0.250,66.96,,1,8,-0.250,1,-1024,,,,,,,,,\r
0.030000,-100,-0.250,66.96,,3,8,90.00,3,-1024,,,,,,,,,\r
1.529000,,,,,,,,,,100,0.002,,,2,0,,,10\r
";
    for slice in [1, 4, 1_000] {
        assert_eq!(plot_file(&traffic, slice), expected);
    }
}

#[test]
fn every_fault_has_its_name() {
    let all = Model::Ddsm115.spec().faults.iter();
    let all = all.copied().fold(Faults::NONE, Faults::with);
    let frame = Frame::with_crc([1, 2, 0, 0, 0, 0, 0, 0, all.byte()]);
    let records = read(&telemetry_file(&[at(0, heard(frame, None))]));
    let names = "sensor | bus overcurrent | phase overcurrent | stall | over-temperature";
    assert_eq!(records[0][7..9], ["0x1F", names]);
}

#[test]
fn a_recording_is_written_instead_of_the_last_ten_minutes() {
    let mut recording = Recording::default();
    recording.add_event(&at(0, reply(1, 0)));
    recording.record(true);
    recording.add_event(&at(10, reply(2, 0)));
    recording.record(false);
    recording.add_event(&at(20, reply(3, 0)));
    let file = CsvFile::of_telemetry(&recording, &ALWAYS);
    let records = read(&whole(file, &log(10), &recording, 10).0);
    assert_eq!(records.len(), 1);
    assert_eq!(records[0][1], "2");
}

/// The direction column of a kind.
fn direction(kind: Kind) -> &'static str {
    match kind {
        Kind::Tx => "TX",
        Kind::Rx => "RX",
        Kind::System => "SYS",
        Kind::Error => "ERR",
    }
}

proptest! {
    /// A parsed file equals the log, for any messages and any slices.
    #[test]
    fn a_file_read_back_is_the_log(
        said in prop::collection::vec((any::<bool>(), "[-=+@,\"'\t\r\n a-c°−Ω]{0,12}"), 0..20),
        frames in prop::collection::vec(any::<[u8; 10]>(), 0..20),
        slice in 1..10_u64,
    ) {
        let mut log = log(1_000);
        log.filter(&Filter::default());
        for (n, frame) in (0..).zip(&frames) {
            log.add_event(&at(n, heard(Frame::new(*frame), Some(Layout::Drive))));
            log.add_event(&at(n, junk(&frame[..(usize::from(frame[0]) % 10)])));
        }
        for (n, (error, text)) in (100..).zip(&said) {
            log.add_message(Instant::from_millis(n), *error, text);
        }
        let (file, rows) = log_file(&mut log, slice);
        let shown = log.page(Window { first: None, rows: 400 }).rows;
        prop_assert_eq!(file.starts_with('\u{FEFF}'), !file.is_ascii());
        let records = read(&file);
        prop_assert_eq!(rows, shown.len() as u64);
        prop_assert_eq!(records.len(), shown.len());
        for (record, Row { kind, time, id, hex, meaning, .. }) in records.iter().zip(&shown) {
            prop_assert_eq!(&record[0], &format!("2026-11-21T{time}Z"));
            prop_assert_eq!(&record[2..4], [direction(*kind), id]);
            let hex = if hex.len() == 2 { format!("0x{hex}") } else { hex.clone() };
            prop_assert_eq!(&record[4], &hex);
            let meant = match kind {
                Kind::Rx => record[5].strip_prefix(REPLY).unwrap_or("no reply"),
                _ => unmarked(&record[5]),
            };
            prop_assert_eq!(meant, spelled_out(meaning.clone()));
            let is_run = |cell: &String| cell.trim_start().starts_with(['=', '+', '-', '@']);
            prop_assert!(!record.iter().any(is_run), "{:?}", record);
        }
    }
}
