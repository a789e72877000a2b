//! What is likely to be wrong with a line, by what happened on it.
//!
//! | file | idea |
//! |---|---|
//! | `record` | what happened on the line, second by second |
//! | `doctor` | from that to the likely cause |
//! | `texts` | the cause and what to do about it, in words |

mod doctor;
mod record;
mod texts;

pub use doctor::{Diagnosis, Findings, MotorFindings, Tally, Verdict, diagnose, echoed, garbled};
pub use record::{Line, Record};
pub use texts::{Advice, blocks, cause, judged, no_blocks, remedy, some_lost, too_little, well};
