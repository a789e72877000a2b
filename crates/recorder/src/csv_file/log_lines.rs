//! An entry of the log as a line.
//!
//! | column | content |
//! |---|---|
//! | `time` | ISO 8601, UTC, to the millisecond |
//! | `elapsed_s` | seconds since the first line, to the millisecond |
//! | `direction` | `TX`, `RX`, `SYS`, `ERR` |
//! | `id` | `0x01`; empty if it concerns no single motor |
//! | `hex` | the bytes; empty if there are none |
//! | `meaning` | the text of the entry |

use motorlink_messages::recorder::Kind;
use motorlink_protocol::Instant;

use super::cells::Cells;
use crate::{
    digits::push_hex,
    entry::Entry,
    meaning::{push_english, push_id},
    texts::Texts,
    wall_clock::{IsoWriter, WallClock, push_seconds},
};

pub(super) const HEAD: [&str; 6] = ["time", "elapsed_s", "direction", "id", "hex", "meaning"];

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
        cells.value(|out| push_hex(out, entry.bytes()));
        cells.text(|out| push_english(out, entry, texts));
    }
}
