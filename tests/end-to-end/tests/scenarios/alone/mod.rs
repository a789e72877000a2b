//! Scenarios that judge the times of frames or the load of the page, which other browsers would change.

mod hidden;
mod rates;
mod stalling;
