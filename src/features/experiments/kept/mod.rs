//! The runs that the browser keeps: headers and records, in its database.
//!
//! | file | idea |
//! |---|---|
//! | `runs` | the handle: begins, extends, ends, renames and deletes runs |
//! | `storing` | what the handle reads and writes |
//!
//! `crates/kept-runs` has the database, and the bounds.

mod runs;
mod storing;

pub(crate) use runs::{KeptRuns, NewRun};
