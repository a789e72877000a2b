//! What was written is read: by this crate, and by the official one.

use std::collections::BTreeMap;

use motorlink_recorder::Charset;
use motorlink_session::{
    About, Cursor, Next, Overview, Problems, Session, Table, Writer, open, overview, report,
};

use crate::sample::{SETUP, ZERO_US, file_of, lines, read, read_file, records, without_derived};

#[test]
fn every_record_is_read_as_it_was_written() {
    let (read, problems) = read_file(&file_of(&records())).unwrap();
    assert!(problems.is_empty(), "{problems}");
    assert_eq!(
        read.len(),
        records().len() + 4,
        "two motors stall and recover"
    );
    assert_eq!(without_derived(read), records());
}

#[test]
fn a_session_without_records_opens() {
    let (read, problems) = read_file(&Writer::new(ZERO_US, &[]).finish()).unwrap();
    assert!(read.is_empty() && problems.is_empty());
}

#[test]
fn a_copy_is_the_same_session() {
    let (once, _) = read_file(&file_of(&records())).unwrap();
    let (twice, _) = read_file(&file_of(&once)).unwrap();
    assert_eq!(once, twice);
}

#[test]
fn the_index_says_where_everything_lies() {
    let file = file_of(&records());
    let mut source = &file[..];
    let session = open(&mut source).unwrap().unwrap();
    assert_eq!(session.about()["page"], "0.1.0");
    let range = session.attachment_range("setup.json").unwrap();
    let bytes = &file[usize::try_from(range.start).unwrap()..usize::try_from(range.end).unwrap()];
    assert_eq!(Session::attachment(bytes), Ok(SETUP.as_bytes()));
    assert_eq!(session.attachment_range("other"), None);
    assert_eq!(
        session.chunks(),
        5,
        "one in ten seconds, and the last event"
    );
}

#[test]
fn a_jump_gives_what_comes_from_there_on() {
    let file = file_of(&records());
    let mut source = &file[..];
    let session = open(&mut source).unwrap().unwrap();
    let (all, _) = read(&mut source, &session);
    for place in (0..all.len()).step_by(7) {
        let at = all[place].utc_ns;
        let mut cursor = Cursor::at(&session, at);
        let mut chunks = 0;
        let first = loop {
            match cursor.next(&session) {
                Next::Record(record) => break record,
                Next::Read(range) => {
                    chunks += 1;
                    let range =
                        usize::try_from(range.start).unwrap()..usize::try_from(range.end).unwrap();
                    cursor.supply(&file[range]);
                }
                Next::End => panic!("nothing from {place} on"),
            }
        };
        assert_eq!(first.utc_ns, at);
        assert!(chunks <= 2, "{chunks} chunks were read for one jump");
    }
    let mut behind = Cursor::at(&session, u64::MAX);
    assert_eq!(behind.next(&session), Next::End);
}

#[test]
fn the_stored_overview_is_that_of_every_record() {
    let file = file_of(&records());
    let mut source = &file[..];
    let session = open(&mut source).unwrap().unwrap();
    let (stored, _) = overview(&mut source, &session).unwrap();
    let mut computed = Overview::default();
    read(&mut source, &session)
        .0
        .iter()
        .for_each(|record| computed.add(record));
    assert_eq!(stored, computed);
    assert_eq!((stored.sent, stored.lost, stored.junk), (120, 1, 1));
    assert_eq!(stored.marks().len(), 7);
}

/// The official crate checks every CRC, and finds each message by the index and by reading from the start.
#[test]
fn the_official_crate_reads_every_message() {
    let file = file_of(&records());
    let summary = mcap::Summary::read(&file).unwrap().unwrap();
    let statistics = summary.stats.clone().unwrap();
    let mut counts = BTreeMap::new();
    for message in mcap::MessageStream::new(&file).unwrap() {
        let message = message.unwrap();
        let schema = message.channel.schema.clone().unwrap();
        assert_eq!(
            (
                schema.encoding.as_str(),
                message.channel.message_encoding.as_str()
            ),
            ("jsonschema", "json")
        );
        nojson::RawJson::parse(std::str::from_utf8(&message.data).unwrap()).unwrap();
        *counts.entry(message.channel.topic.clone()).or_insert(0) += 1;
    }
    let total: u64 = counts.values().sum();
    assert_eq!(statistics.message_count, total);
    assert_eq!(statistics.attachment_count, 3);
    let topics: Vec<&str> = counts.keys().map(String::as_str).collect();
    assert_eq!(
        topics,
        [
            "/events",
            "/link",
            "/motors/1/telemetry",
            "/motors/7/telemetry",
            "/wire"
        ]
    );
    let indexed: usize = summary
        .chunk_indexes
        .iter()
        .map(|chunk| {
            let indexes = summary.read_message_indexes(&file, chunk).unwrap();
            for (channel, entries) in &indexes {
                for entry in entries {
                    let found = summary.seek_message(&file, chunk, entry).unwrap();
                    assert_eq!((&found.channel, found.log_time), (channel, entry.log_time));
                }
            }
            indexes.values().map(Vec::len).sum::<usize>()
        })
        .sum();
    assert_eq!(indexed as u64, total);
    let attachment = summary
        .attachment_indexes
        .iter()
        .find(|one| one.name == "setup.json");
    let attachment = mcap::read::attachment(&file, attachment.unwrap()).unwrap();
    assert_eq!(attachment.data.as_ref(), SETUP.as_bytes());
    let metadata = mcap::read::metadata(&file, &summary.metadata_indexes[0]).unwrap();
    assert_eq!(metadata.metadata["version"], "1");
}

/// As `mcap compress` or another program saves it: other chunks, linked LZ4 blocks, or no compression.
#[test]
fn a_file_that_the_official_crate_wrote_is_read() {
    let file = file_of(&records());
    for compression in [Some(mcap::Compression::Lz4), None] {
        let mut out = std::io::Cursor::new(Vec::new());
        let options = mcap::WriteOptions::new()
            .compression(compression)
            .chunk_size(Some(40_000));
        let mut writer = options.create(&mut out).unwrap();
        for message in mcap::MessageStream::new(&file).unwrap() {
            writer.write(&message.unwrap()).unwrap();
        }
        writer.finish().unwrap();
        drop(writer);
        let (read, problems) = read_file(&out.into_inner()).unwrap();
        assert!(problems.is_empty(), "{problems}");
        assert_eq!(without_derived(read), records());
    }
}

#[test]
fn tables_have_a_line_for_each_record() {
    let file = file_of(&records());
    let mut source = &file[..];
    let session = open(&mut source).unwrap().unwrap();
    let (overview, _) = overview(&mut source, &session).unwrap();
    let (records, _) = read(&mut source, &session);

    let mut csv = Vec::new();
    let mut table = Table::of_log(Charset::Ascii);
    table.head(&mut csv);
    for record in &records {
        table.record(&mut csv, record);
    }
    let mut reader = csv::Reader::from_reader(&csv[..]);
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), records.len());
    assert_eq!(&rows[1][0], "2026-11-21T13:15:36.963Z");

    let mut plot = Table::of_plot(&overview);
    let mut csv = Vec::new();
    plot.head(&mut csv);
    for record in &records {
        plot.record(&mut csv, record);
    }
    let mut reader = csv::Reader::from_reader(&csv[..]);
    let head = reader.headers().unwrap().clone();
    assert_eq!(
        (&head[0], &head[1], &head[10]),
        (
            "time",
            "motor_1_unmirrored_speed_rpm",
            "motor_7_unmirrored_speed_rpm"
        )
    );
    assert_eq!(head.len(), 19);
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(
        rows.len(),
        lines(&records).len() / 2 - 2,
        "a row for each reply; silence and junk have no value"
    );
    let cells = |row: usize| rows[row].iter().collect::<Vec<_>>().join(",");
    assert_eq!(cells(0), "0.000000,0,0.000,0.00,,2,0,100,2,0,,,,,,,,,");
    assert_eq!(cells(1), "0.300000,,,,,,,,,,1,0.009,10.89,,2,0,100,2,37");
}

#[test]
fn a_report_says_what_happened_and_needs_nothing_else() {
    let file = file_of(&records());
    let mut source = &file[..];
    let session = open(&mut source).unwrap().unwrap();
    let (overview, _) = overview(&mut source, &session).unwrap();
    let problems = Problems::default();
    let about = About {
        name: "<run> & co",
        problems: &problems,
    };
    let html = report(&overview, about);
    for part in [
        "<title>Session &lt;run&gt; &amp; co</title>",
        "2026-11-21T13:15:36.962Z",
        "0:00:36.200",
        "<h2>Motor 7</h2>",
        "stall",
        "sign of the motor itself",
        "Adapter &quot;lost&quot;",
        "1 (0.8 %)",
        "<path d=\"M0.0 147.5V148.5M15.3 144.8V145.8",
    ] {
        assert!(html.contains(part), "{part}\n{html}");
    }
    assert!(!html.contains("http") && !html.contains("<script"));
}
