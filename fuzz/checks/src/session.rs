//! The reader of session files, and the import of CSV files.

use std::{convert::Infallible, ops::Range};

use motorlink_session::{
    About, Import, NotASession, Overview, Record, Source, Table, Writer, for_each_record, open,
    report,
};

/// Bytes that one piece of a session may have: a chunk with its head, which does not compress.
const READ_MAX: u64 = 33 << 20;
/// How often the file may be read while it is opened: its index, and if that is damaged, all heads.
const OPENED_BY: u64 = 6;
/// LZ4 makes at most 255 bytes of one, and no record has fewer bytes than that one.
const RECORDS_PER_BYTE: u64 = 255;

/// A file that counts what is read of it.
struct Counted<'a> {
    bytes: &'a [u8],
    read: u64,
}

impl Source for Counted<'_> {
    type Error = Infallible;

    fn len(&self) -> u64 {
        self.bytes.len() as u64
    }

    fn read(&mut self, range: Range<u64>) -> Result<Vec<u8>, Infallible> {
        assert!(range.start <= range.end && range.end <= self.len());
        let length = range.end - range.start;
        assert!(length <= READ_MAX, "{length} bytes at once");
        self.read += length;
        self.bytes.read(range)
    }
}

/// Whatever is opened as a session: a session file, or a CSV file that becomes one.
pub fn session_file(bytes: &[u8]) {
    match read(bytes) {
        Ok(records) => {
            // What was read is written and read as the same.
            let mut writer = Writer::new(0, &[]);
            for record in &records {
                writer.record(record);
            }
            let again = read(&writer.finish()).unwrap();
            assert_eq!(lines(&again), lines(&records));
        }
        Err(why) => assert!(!why.to_string().is_empty()),
    }
    let mut import = Import::default();
    let (first, second) = bytes.split_at(bytes.len() / 2);
    import.feed(first);
    let mut file = import.take();
    import.feed(second);
    file.extend(import.take());
    if let Ok((end, _)) = import.finish() {
        file.extend(end);
        read(&file).unwrap();
    }
}

/// Reads every record, and exports them.
fn read(bytes: &[u8]) -> Result<Vec<Record>, NotASession> {
    let mut source = Counted { bytes, read: 0 };
    let Ok(session) = open(&mut source);
    let len = source.len();
    assert!(source.read <= OPENED_BY * len, "{} of {len}", source.read);
    let session = session?;
    source.read = 0;
    let mut records = Vec::new();
    let Ok(problems) = for_each_record(&mut source, &session, |record| records.push(record));
    assert!(source.read <= len, "{} of {len}", source.read);
    assert!(records.len() as u64 <= RECORDS_PER_BYTE * len);

    let mut overview = Overview::default();
    for record in &records {
        overview.add(record);
    }
    let about = About {
        name: "fuzzed",
        problems: &session.problems().and(&problems),
    };
    assert!(report(&overview, about).trim_end().ends_with("</html>"));
    let mut table = Table::of_plot(&overview);
    let mut csv = Vec::new();
    table.head(&mut csv);
    for record in &records {
        table.record(&mut csv, record);
    }
    assert!(csv.starts_with(b"time"));
    Ok(records)
}

fn lines(records: &[Record]) -> Vec<motorlink_bus::LineEventKind> {
    let lines = records.iter().filter_map(Record::line);
    lines.map(|line| line.kind).collect()
}
