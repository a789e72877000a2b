//! Files of the page, read as another program would.

use anyhow::{Context, Result, ensure};
use csv::ReaderBuilder;
use end_to_end::{Download, Frame, WireLog};

/// The columns of the packet log.
pub const LOG_HEAD: [&str; 6] = ["time", "elapsed_s", "direction", "id", "hex", "meaning"];

/// The columns of the article's monitor script.
pub const TELEMETRY_HEAD: [&str; 10] = [
    "timestamp",
    "motor_id",
    "mode",
    "speed_rpm",
    "current_a",
    "temp_c",
    "position_deg",
    "error_code",
    "error_str",
    "raw_hex",
];

/// A table: rows of cells.
pub struct Table {
    pub head: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads a CSV file, every row of which has to have as many cells as the head.
    pub fn read(file: &Download) -> Result<Self> {
        ensure!(file.extension() == "csv", "{}", file.name);
        let bytes = file.bytes()?;
        ensure!(
            bytes.ends_with(b"\r\n"),
            "RFC 4180 ends every line with CR LF"
        );
        let mut reader = ReaderBuilder::new().from_reader(bytes.as_slice());
        let cells = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect();
        let head = cells(reader.headers()?);
        let rows = reader
            .records()
            .map(|record| Ok(cells(&record?)))
            .collect::<Result<_>>()?;
        Ok(Self { head, rows })
    }

    /// The cells of one column.
    pub fn column(&self, name: &str) -> Result<Vec<&str>> {
        let place = self.head.iter().position(|head| head == name);
        let place = place.with_context(|| format!("no column {name}"))?;
        Ok(self.rows.iter().map(|row| row[place].as_str()).collect())
    }
}

/// How long a frame is on the wire, microseconds: ten bytes at 115200 baud.
const AIRTIME_US: u64 = 868;
/// From the last bit of a request to the last of its reply, on the bench's own lines.
const REPLY_US: u64 = 600 + AIRTIME_US;

/// A reply on the wire.
pub struct Reply {
    pub frame: Frame,
    /// Whether a feedback query had asked for it.
    pub queried: bool,
    /// How many frames of the host were sent up to the one that had asked for it.
    pub behind: usize,
}

/// The replies that came undisturbed. On a machine that is held up the page gives a motor up and asks
/// again while the first reply is on its way; they spoil each other, on the wire as in the log.
pub fn undisturbed_replies(wire: &WireLog) -> Vec<Reply> {
    let host = wire.from_host();
    let motors = wire.from_motors();
    let disturbed = |frame: &Frame| {
        let overlaps = |host: &&Frame| host.at_us.abs_diff(frame.at_us) < AIRTIME_US;
        host.frames.iter().any(|host| overlaps(&host))
    };
    let replies = motors.frames.iter().filter(|frame| !disturbed(frame));
    replies
        .map(|frame| {
            let asked_us = frame.at_us - REPLY_US;
            let asked = |host: &Frame| host.at_us.abs_diff(asked_us) <= 2;
            let place = host.frames.iter().position(asked);
            let place = place.expect("every reply has a request");
            Reply {
                frame: frame.clone(),
                queried: host.frames[place].bytes[1] == 0x74,
                behind: place + 1,
            }
        })
        .collect()
}

/// `01 74 ..`
pub fn hex(frame: &Frame) -> String {
    let bytes: Vec<String> = frame
        .bytes
        .iter()
        .map(|byte| format!("{byte:02X}"))
        .collect();
    bytes.join(" ")
}

/// Milliseconds of an ISO 8601 time in UTC, `2025-11-21T13:15:36.962Z`, within its day.
pub fn ms_of_day(time: &str) -> Result<u64> {
    let parse = || {
        let (date, clock) = time.strip_suffix('Z')?.split_once('T')?;
        let mut lengths = date.split('-').map(str::len);
        let iso = (lengths.next(), lengths.next(), lengths.next()) == (Some(4), Some(2), Some(2));
        let (clock, ms) = clock.split_once('.')?;
        let fields: Vec<u64> = clock
            .split(':')
            .map(|field| field.parse().ok().filter(|_| field.len() == 2))
            .collect::<Option<_>>()?;
        let [hours, minutes, seconds] = *fields.as_slice() else {
            return None;
        };
        let ms: u64 = ms.parse().ok().filter(|_| ms.len() == 3)?;
        iso.then_some(((hours * 60 + minutes) * 60 + seconds) * 1000 + ms)
    };
    parse().with_context(|| format!("no time of ISO 8601 to the millisecond: {time:?}"))
}
