//! Scenarios that judge the times of frames or the load of the page, which other browsers would change, those whose line
//! is so bad that a late computer loses the motor, and those that compare all replies with the line's: a late computer
//! counts some as lost.

mod bad_lines;
mod exports;
mod hidden;
mod plotting;
mod rates;
mod session;
mod stalling;
