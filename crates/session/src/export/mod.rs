//! Exports of a session: CSV tables and a report.

mod graph;
mod report;
mod table;

pub use report::{About, report};
pub use table::Table;
