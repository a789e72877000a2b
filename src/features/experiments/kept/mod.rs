//! The runs that the browser keeps: headers and records, in its database.
//!
//! | file | idea |
//! |---|---|
//! | `runs` | the handle: begins, extends, ends, renames and deletes runs |
//! | `storing` | what the handle reads and writes |
//! | `database` | the database of the browser |
//! | `bound` | which runs go when there are too many |

mod bound;
mod database;
mod runs;
mod storing;

pub(crate) use runs::{KeptRuns, NewRun};
