//! Scenarios that judge the times of frames or the load of the page, which other browsers would change, and those whose
//! line is so bad that a late computer loses the motor.

mod bad_lines;
mod hidden;
mod rates;
mod stalling;
