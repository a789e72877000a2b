//! An entry of the log as a line.
//!
//! | column | content |
//! |---|---|
//! | `time` | ISO 8601, UTC, to the millisecond |
//! | `elapsed_s` | seconds since the first line, to the millisecond |
//! | `direction` | `TX`, `RX`, `SYS`, `ERR` |
//! | `id` | `0x01`; empty if it concerns no single motor |
//! | `hex` | the bytes; empty if there are none; `0x01` if it is only one, which a spreadsheet takes for a number otherwise |
//! | `meaning` | the text of the entry; of a reply, `reply` and then the text |

use motorlink_bus::LineEventKind;
use motorlink_messages::recorder::Kind;
use motorlink_protocol::Instant;

use super::cells::Cells;
use crate::{
    charset::Charset,
    digits::{push_0x, push_hex},
    entry::{Entry, EntryContent},
    row_words::{push_english, push_id},
    stored_texts::Texts,
    wall_clock::{IsoWriter, WallClock, push_seconds},
};

const HEAD: [&str; 6] = ["time", "elapsed_s", "direction", "id", "hex", "meaning"];

/// Precedes the meaning of a reply. It begins with the speed, `+100 rpm`, which a spreadsheet takes for a
/// formula.
pub const REPLY: &str = "reply ";

/// Adds the names of the columns, behind a byte order mark if the file is UTF-8.
pub(super) fn push_head(cells: &mut Cells, out: &mut Vec<u8>, charset: Charset) {
    if charset == Charset::Utf8 {
        out.extend_from_slice("\u{FEFF}".as_bytes());
    }
    cells.names(&HEAD);
    cells.end_line(out);
}

#[derive(Debug)]
pub(super) struct LogLines {
    first_at: Instant,
    times: IsoWriter,
}

impl LogLines {
    pub(super) fn new(first_at: Instant) -> Self {
        Self {
            first_at,
            times: IsoWriter::default(),
        }
    }

    pub(super) fn write(
        &mut self,
        cells: &mut Cells,
        entry: &Entry,
        texts: &Texts,
        clock: WallClock,
    ) {
        let elapsed = entry
            .at
            .as_micros()
            .saturating_sub(self.first_at.as_micros());
        cells.value(|out| self.times.push(out, clock.utc(entry.at)));
        cells.value(|out| push_seconds(out, elapsed));
        cells.plain(match entry.kind() {
            Kind::Tx => "TX",
            Kind::Rx => "RX",
            Kind::System => "SYS",
            Kind::Error => "ERR",
        });
        cells.value(|out| push_id(out, entry));
        cells.value(|out| match entry.bytes() {
            [byte] => push_0x(out, *byte),
            bytes => push_hex(out, bytes),
        });
        cells.text(|out| {
            if let EntryContent::Line(LineEventKind::Received { .. }) = entry.content {
                out.push_str(REPLY);
            }
            push_english(out, entry, texts);
        });
    }
}
