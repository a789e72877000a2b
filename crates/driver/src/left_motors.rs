//! What is done on a port with the motors that were left driven.

/// What is done on a port with the motors that an earlier driver left driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LeftMotors {
    /// They are stopped first.
    Stop,
    /// Nothing: they were stopped on this port and did not answer. They stay in the file.
    Leave,
}
