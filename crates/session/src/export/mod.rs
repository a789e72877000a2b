//! Exports of a session: CSV tables and a report.

mod article;
mod graph;
mod html;
mod plot;
mod report;

pub use article::Table;
pub use plot::PlotTable;
pub use report::{About, report};
