//! What is likely to be wrong with a line, by what happened on it.
//!
//! | file | idea |
//! |---|---|
//! | `tally` | what happened on the line, counted |
//! | `record` | the same, second by second |
//! | `doctor` | from that to the likely cause |
//! | `texts` | the cause and what to do about it, in words |

mod doctor;
mod record;
#[cfg(test)]
mod recorded_bus;
mod tally;
pub mod texts;

pub use doctor::{Diagnosis, Findings, MotorFindings, Verdict, diagnose};
pub use record::{Line, Record};
pub use tally::{Tally, echoed, garbled};
