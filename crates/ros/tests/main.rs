//! The program against a real motorlink with virtual motors on a pseudo-terminal, where the state of the wheels is known, a Zenoh router,
//! and `hiroz`, another implementation of ROS 2 over Zenoh. MOTORLINK names the command `motorlink`. `cargo xtask test --only ros` runs
//! this.
#![cfg(test)]
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "a test that cannot go on fails"
)]

mod bench;
mod driving;
mod fleet;
mod interoperation;
mod odometry;
