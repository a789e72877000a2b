//! Remote operation: who drives the motors of the server that the page comes from. Absent on any other page.

mod texts;
pub(crate) mod view;
