//! The recorder: keeps the packet log and the recording, filters them and writes them as CSV.
//!
//! It runs in a web worker of its own, beside the one that owns the port: a million entries are filtered
//! and written while frames go on and while the page scrolls. Here it is pure: no browser, and time is an
//! argument. [`Recorder`] takes messages and traffic and gives messages and parts of files; whoever calls
//! it decides how much it does in one go.
//!
//! | file | what it holds |
//! |---|---|
//! | `recorder` | the whole: messages in, messages and files out |
//! | `log` | the packet log: the newest million entries in the order of their times |
//! | `view` | which entries are rows, and which row is which entry |
//! | `row_filter` | whether an entry is asked for |
//! | `routine` | which exchanges are routine |
//! | `words` | an entry in words |
//! | `recording` | samples of telemetry: ten minutes always, more when recorded |
//! | `kept` | the session on disk: what is written, and how it is read back |
//! | `restoring` | a kept session on its way into the recorder, a slice at a time |
//! | `csv_file` | CSV files, made a slice at a time |
//! | `wall_clock`, `local_time` | the time of day |
//! | `chunks`, `entry`, `texts`, `digits` | how it is kept small and quick |

mod chunks;
mod csv_file;
pub mod digits;
mod entry;
pub mod kept;
mod local_time;
mod log;
mod recorder;
mod recording;
mod restoring;
mod routine;
mod row_filter;
mod texts;
mod view;
mod wall_clock;
mod words;

pub use csv_file::{CsvFile, CsvLines};
pub use local_time::LocalTime;
pub use log::{ENTRIES_MAX, Log};
pub use recorder::{Output, Recorder};
pub use recording::{RECORDED_MAX, ROLLING, ROLLING_MAX, Recording};
pub use wall_clock::{WallClock, push_iso};
