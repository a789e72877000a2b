//! CSV files in the formats of the page's own exports, by the same writer.

use motorlink_recorder::{Charset, CsvLines, LocalTime, WallClock};

use crate::{
    clock::zero_unix_us,
    overview::Overview,
    record::{Record, What},
};

/// A CSV file of records: the packet log, or telemetry in the columns of the article's monitor script or for
/// plotting.
#[derive(Debug)]
pub struct Table(CsvLines);

impl Table {
    /// A table of every entry of the packet log. The character set is that of all its records.
    #[must_use]
    pub fn of_log(charset: Charset) -> Self {
        Self(CsvLines::of_log(charset))
    }

    /// A table of every valid reply.
    #[must_use]
    pub fn of_telemetry() -> Self {
        Self(CsvLines::of_telemetry())
    }

    /// A table of every valid reply for plotting, with columns for each motor.
    #[must_use]
    pub fn of_plot(overview: &Overview) -> Self {
        Self(CsvLines::of_plot(overview.motors().map(|(id, _)| id)))
    }

    /// Adds the names of the columns.
    pub fn head(&mut self, out: &mut Vec<u8>) {
        self.0.head(out);
    }

    /// Adds the line of a record, if it has one.
    pub fn record(&mut self, out: &mut Vec<u8>, record: &Record) {
        let zero_us = zero_unix_us(record.at, record.utc_ns);
        let clock = WallClock::from_us(zero_us, LocalTime::default());
        match &record.what {
            What::Event(event) => {
                self.0
                    .add_message(out, record.at, event.error, &event.text, clock);
            }
            What::Line(_) => {
                if let Some(event) = record.line() {
                    self.0.event(out, &event, clock);
                }
            }
            What::State(_) => {}
        }
    }
}
