//! The runs of experiments that the browser keeps, in its database.
//!
//! The page stores each run while it goes on. The session worker reads the runs of a session that is saved, and adds the
//! runs of a file that is open.
//!
//! | module | what it holds |
//! |---|---|
//! | `database` | headers and records in the browser's database (IndexedDB) |
//! | `bounds` | how many runs are kept |
//! | `placing` | where a run of a file goes among them |

mod bounds;
mod database;
mod placing;

pub use bounds::{BYTES_MAX, RUNS_MAX, too_many};
pub use database::{Database, Headers, erase};
pub use placing::Placing;
