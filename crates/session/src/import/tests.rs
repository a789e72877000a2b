use motorlink_bus::{JunkBytes, LineEvent, LineEventKind};
use motorlink_protocol::{Frame, Instant, Layout, Mode, MotorId, family::Model};
use motorlink_recorder::{Charset, CsvLines, WallClock};

use super::*;
use crate::{
    reader::{for_each_record, open},
    record::{EventKind, Record, What},
};

/// 2026-11-21 13:15:36.962 UTC.
const ZERO_US: i64 = 1_795_266_936_962_000;

fn import(csv: &[u8], piece: usize) -> Result<(Vec<Record>, Problems), NotASession> {
    let mut import = Import::default();
    let mut file = Vec::new();
    for piece in csv.chunks(piece) {
        import.feed(piece);
        file.extend(import.take());
    }
    let (last, problems) = import.finish()?;
    file.extend(last);
    let mut source = &file[..];
    let session = open(&mut source).unwrap().unwrap();
    let mut records = Vec::new();
    let read = for_each_record(&mut source, &session, |record| records.push(record)).unwrap();
    assert!(read.is_empty(), "{read}");
    Ok((records, problems))
}

fn lines(records: &[Record]) -> Vec<LineEvent> {
    records.iter().filter_map(Record::line).collect()
}

fn sample() -> Vec<LineEvent> {
    let drive = "01 64 00 64 00 00 00 00 00 4F".parse().unwrap();
    let reply = "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap();
    let query = "01 74 00 00 00 00 00 00 00 04".parse().unwrap();
    let sent = |frame, mode| LineEventKind::Sent { frame, mode };
    let received = |asked| LineEventKind::Received {
        frame: reply,
        asked: Some(asked),
    };
    let kinds = [
        sent(query, None),
        received(Layout::Query),
        sent(drive, Some(Mode::Velocity)),
        received(Layout::Drive),
        LineEventKind::NotSent { frame: drive },
        LineEventKind::Junk(JunkBytes::new(&[1, 2, 3])),
        LineEventKind::Junk(JunkBytes::new(&[0x12])),
        LineEventKind::Silence {
            id: MotorId::FIRST,
            waited_us: 8_100,
        },
    ];
    let at = (0..).map(|n| Instant::from_millis(3 * n));
    let events = at.zip(kinds).map(|(at, kind)| LineEvent { at, kind });
    events.collect()
}

fn exported(mut lines: CsvLines) -> Vec<u8> {
    let clock = WallClock::from_us(ZERO_US, motorlink_recorder::LocalTime::default());
    let mut csv = Vec::new();
    lines.head(&mut csv);
    for event in sample() {
        lines.event(&mut csv, &event, clock);
    }
    lines.add_message(&mut csv, Instant::from_millis(30), true, "=1+1", clock);
    csv
}

#[test]
fn our_log_is_read_as_it_was_written() {
    let csv = exported(CsvLines::of_log(Charset::Utf8));
    for piece in [1, 7, csv.len()] {
        let (records, problems) = import(&csv, piece).unwrap();
        assert!(problems.is_empty());
        assert_eq!(lines(&records), sample());
        assert_eq!(records[0].utc_ns, 1_795_266_936_962_000_000);
        let What::Event(said) = &records[8].what else {
            panic!("the last line is a text")
        };
        assert_eq!((said.text.as_str(), said.error), ("=1+1", true));
    }
}

/// As the page wrote it before the byte order mark: an apostrophe before what a spreadsheet could run.
#[test]
fn a_log_of_an_earlier_version_is_read_as_it_was_written() {
    let csv = "time,elapsed_s,direction,id,hex,meaning\r
2026-11-21T13:15:36.962Z,0.000,TX,0x01,01 74 00 00 00 00 00 00 00 04,feedback query\r
2026-11-21T13:15:36.965Z,0.003,RX,0x01,01 02 02 CD 00 64 17 CF 00 8F,\"'+100 rpm, +0.175 A, 23 °C, 292.2°\"\r
2026-11-21T13:15:36.968Z,0.006,TX,0x01,01 64 00 64 00 00 00 00 00 4F,drive +100 rpm\r
2026-11-21T13:15:36.971Z,0.009,RX,0x01,01 02 02 CD 00 64 17 CF 00 8F,\"'+100 rpm, +0.175 A, 66.96°\"\r
2026-11-21T13:15:36.974Z,0.012,ERR,0x01,01 64 00 64 00 00 00 00 00 4F,not sent: adapter still busy with the previous frame\r
2026-11-21T13:15:36.977Z,0.015,ERR,,01 02 03,\"3 bytes, no valid frame\"\r
2026-11-21T13:15:36.980Z,0.018,ERR,,12,\"1 byte, no valid frame\"\r
2026-11-21T13:15:36.983Z,0.021,ERR,0x01,,no reply within 8.1 ms\r
2026-11-21T13:15:36.992Z,0.030,ERR,,,'=1+1\r
";
    let (records, problems) = import(csv.as_bytes(), 11).unwrap();
    assert!(problems.is_empty(), "{problems}");
    assert_eq!(lines(&records), sample());
    let What::Event(said) = &records[8].what else {
        panic!("the last line is a text")
    };
    assert_eq!((said.text.as_str(), said.error), ("=1+1", true));
}

#[test]
fn our_telemetry_of_separate_frames_is_the_same_again() {
    let frame = |bytes| Frame::with_crc(bytes);
    for (model, offset) in [(Model::Ddsm210, 0), (Model::Ddsm400, 1)] {
        let received = |bytes| LineEventKind::Received {
            frame: frame(bytes),
            asked: None,
        };
        let kinds = [
            LineEventKind::ModelSelected(model),
            received([1, 0x75 + offset, 0, 0, 0, 0, 0, 0, 0]),
            received([1, 0x64 + offset, 1, 0xF4, 0, 8, 0, 31, 2]),
            received([1, 0x74 + offset, 0, 0, 0, 7, 0x40, 0, 0]),
        ];
        let clock = WallClock::from_us(ZERO_US, motorlink_recorder::LocalTime::default());
        let mut csv = Vec::new();
        let mut table = CsvLines::of_telemetry();
        table.head(&mut csv);
        for (n, kind) in (0..).zip(kinds) {
            let at = Instant::from_millis(n);
            table.event(&mut csv, &LineEvent { at, kind }, clock);
        }
        let (records, problems) = import(&csv, 100).unwrap();
        assert!(problems.is_empty(), "{problems}");
        let mut again = Vec::new();
        let mut table = CsvLines::of_telemetry();
        table.head(&mut again);
        // Its clock begins with the first row. It has an event for the fault, too.
        let clock = WallClock::from_us(ZERO_US + 2_000, motorlink_recorder::LocalTime::default());
        for event in lines(&records) {
            table.event(&mut again, &event, clock);
        }
        let text = |bytes| String::from_utf8(bytes).unwrap();
        let (csv, again) = (text(csv), text(again));
        assert_eq!(again, csv, "{model}");
        let current = if model == Model::Ddsm400 { "0.001" } else { "" };
        let hex = frame([1, 0x64 + offset, 1, 0xF4, 0, 8, 0, 31, 2]);
        let row = format!("1,Open loop,50,{current},31,,0x02,overcurrent,{hex}");
        assert!(csv.contains(&row), "{csv}");
    }
}

#[test]
fn our_telemetry_is_read_as_replies() {
    let (records, problems) = import(&exported(CsvLines::of_telemetry()), 100).unwrap();
    assert!(problems.is_empty());
    let replies = sample()
        .into_iter()
        .filter(|event| matches!(event.kind, LineEventKind::Received { .. }));
    let first = Instant::from_millis(3);
    let replies: Vec<_> = replies
        .map(|event| LineEvent {
            at: Instant::from_micros(event.at.as_micros() - first.as_micros()),
            ..event
        })
        .collect();
    assert_eq!(lines(&records), replies);
}

#[test]
fn the_log_of_the_articles_script_is_read() {
    // The sample of the article.
    let csv = b"timestamp,motor_id,mode,speed_rpm,current_a,temp_c,position_deg,error_code,error_str,raw_hex
13:15:36.962,1,Velocity,100,0.07,33,71.6,0x00,OK,01 02 00 0A 00 64 21 59 00 F5
";
    let (records, problems) = import(csv, 11).unwrap();
    let problems: Vec<_> = problems.iter().collect();
    // Its CRC is wrong: the article invented the sample.
    assert_eq!(problems, [(Problem::LineDamaged, 1)]);
    assert!(records.is_empty());
}

#[test]
fn the_log_of_the_original_page_is_read() {
    let csv = "Timestamp,Type,Content
\"23:59:59.990\",\"system\",\"[System] Connected\"
\"23:59:59.995\",\"TX\",\"→ TX [ID 0x01]: 01 64 00 64 00 00 00 00 00 4F\"
\"00:00:00.000\",\"RX\",\"← RX [ID 0x01]: 01 02 02 CD 00 64 17 CF 00 8F\"
\"00:00:01.000\",\"Error\",\"[Write Error] gone\"
\"00:00:01.000\",\"RX\",\"← RX [ID 0x01]: 01 02\"
";
    let (records, problems) = import(csv.as_bytes(), 5).unwrap();
    assert_eq!(
        (
            problems.times(Problem::NoDate),
            problems.times(Problem::LineDamaged)
        ),
        (1, 1)
    );
    let at: Vec<_> = records.iter().map(|record| record.at.as_micros()).collect();
    assert_eq!(at, [0, 5_000, 10_000, 1_010_000]);
    let [sent, received] = lines(&records)[..] else {
        panic!("two lines have frames")
    };
    assert!(matches!(sent.kind, LineEventKind::Sent { mode: None, .. }));
    assert!(matches!(
        received.kind,
        LineEventKind::Received {
            asked: Some(Layout::Drive),
            ..
        }
    ));
    let What::Event(error) = &records[3].what else {
        panic!("the last line is a text")
    };
    assert_eq!((error.kind, error.error), (EventKind::Notice, true));
}

/// As spreadsheet programs save a file again.
#[test]
fn a_file_with_another_separator_or_in_utf_16_is_read() {
    let log = String::from_utf8(exported(CsvLines::of_log(Charset::Utf8))).unwrap();
    let log = log.trim_start_matches('\u{FEFF}');
    let with = |separator: char| {
        let mut reader = csv::ReaderBuilder::new();
        let mut reader = reader.has_headers(false).from_reader(log.as_bytes());
        let mut writer = csv::WriterBuilder::new();
        let separator = u8::try_from(separator).unwrap();
        let mut writer = writer.delimiter(separator).from_writer(Vec::new());
        for row in reader.records() {
            writer.write_record(&row.unwrap()).unwrap();
        }
        String::from_utf8(writer.into_inner().unwrap()).unwrap()
    };
    let texts = [
        with(';'),
        format!("\u{FEFF}{}", with(';')),
        format!("sep=;\r\n{}", with(';')),
        format!("sep=|\n{}", with('|')),
        with('\t'),
    ];
    for text in texts {
        let utf_16 = |unit: fn(u16) -> [u8; 2]| -> Vec<u8> {
            let text = format!("\u{FEFF}{}", text.trim_start_matches('\u{FEFF}'));
            text.encode_utf16().flat_map(unit).collect()
        };
        for file in [
            text.clone().into_bytes(),
            utf_16(u16::to_le_bytes),
            utf_16(u16::to_be_bytes),
        ] {
            assert_eq!(
                open(&mut &file[..]).unwrap().unwrap_err(),
                NotASession::Text
            );
            for piece in [1, 7, file.len()] {
                let (records, problems) = import(&file, piece).unwrap();
                assert!(problems.is_empty(), "{text}: {problems}");
                assert_eq!(lines(&records), sample(), "{text}");
            }
        }
    }
}

/// `15:36.9` is what Excel makes of a time of day.
#[test]
fn a_line_whose_time_is_lost_is_left_out_with_its_cause() {
    let csv = "time,elapsed_s,direction,id,hex,meaning
2026-11-21T13:15:36.962Z,0.000,TX,0x01,01 74 00 00 00 00 00 00 00 04,feedback query
13:15:36.965,0.003,TX,0x01,01 74 00 00 00 00 00 00 00 04,feedback query
15:36.9,0.006,TX,0x01,01 74 00 00 00 00 00 00 00 04,feedback query
2026-11-21T13:15:37.962Z,1.000,TX,0x01,01 74 00 00 00 00 00 00 00 04,feedback query
";
    let (records, problems) = import(csv.as_bytes(), 7).unwrap();
    let at: Vec<_> = records.iter().map(|record| record.at.as_micros()).collect();
    assert_eq!(at, [0, 1_000_000]);
    assert_eq!(
        problems.iter().collect::<Vec<_>>(),
        [(Problem::TimeLost, 2)]
    );
}

#[test]
fn another_text_is_no_session() {
    for other in ["", "\n", "a,b\n1,2\n", "{}", "time,elapsed_s\n"] {
        assert_eq!(import(other.as_bytes(), 3).unwrap_err(), NotASession::Text);
    }
    let (records, _) = import(b"Timestamp,Type,Content\n", 3).unwrap();
    assert!(records.is_empty());
}
