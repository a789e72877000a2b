//! The program of the runs, as part of this one. If it fails, the thread does, which stops the motors.

use motorlink_protocol::Instant;
use motorlink_runs::{Decides, Input, Output, Program};

/// The program that decides.
#[derive(Debug, Default)]
pub(crate) struct OwnProgram {
    pub(crate) program: Program,
    /// The driver fails in every turn, for tests.
    #[cfg(test)]
    pub(crate) fails: bool,
}

impl Decides for OwnProgram {
    fn decide(&mut self, now: Instant, input: &Input) -> Option<Output> {
        self.program.decide(now, input)
    }
}
