//! The recorder: keeps the packet log and the recording, filters them and writes them as CSV.
//!
//! It runs in its own web worker, so that filtering and writing a million entries delay neither the frames
//! nor the page. This crate uses no browser, and time is an argument. [`Recorder`] takes messages and line
//! events and returns messages and parts of files; the caller decides how much it does at a time.
//!
//! | file | what it holds |
//! |---|---|
//! | `recorder` | messages in, messages and files out |
//! | `log` | the packet log: the newest million entries in order of time |
//! | `view` | which entries are rows, and which row is which entry |
//! | `row_filter` | which entries match the filter |
//! | `routine` | which exchanges are routine |
//! | `row_words` | the words of an entry, as a row shows them |
//! | `recording` | samples of telemetry: ten minutes always, more when recorded |
//! | `states` | what the page showed |
//! | `commanded` | what each motor was told |
//! | `marks` | what is known of a motor, between samples that are kept alone |
//! | `saved` | the saved session: its files, how they are written and read |
//! | `kept` | everything that is kept, as one sequence for a session file |
//! | `restoring` | restores a saved session in slices |
//! | `csv_file`, `charset` | CSV files, written in slices |
//! | `wall_clock`, `local_time` | the time of day |
//! | `chunks`, `entry`, `stored_texts`, `digits` | compact storage and quick formatting |

mod charset;
mod chunks;
mod commanded;
mod csv_file;
pub mod digits;
mod entry;
mod kept;
mod local_time;
mod log;
mod marks;
mod recorder;
mod recording;
mod restoring;
mod routine;
mod row_filter;
mod row_words;
pub mod saved;
mod states;
mod stored_texts;
mod view;
mod wall_clock;

pub use charset::{Charset, spelled_out};
pub use commanded::{Commanded, Commands};
pub use csv_file::{CsvFile, CsvLines, REPLY, mode_cell, unmarked};
pub use local_time::LocalTime;
pub use log::{ENTRIES_MAX, Log};
pub use recorder::{Output, Recorder};
pub use recording::{RECORDED_MAX, ROLLING, ROLLING_MAX, Recording};
pub use wall_clock::{WallClock, push_iso};
