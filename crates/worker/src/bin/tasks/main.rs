//! The program of the tasks beside the port: the recorder, the session worker, and the runs of experiments. Each
//! task is an instance of the program with a memory of its own, so that a trap in one damages no other.

#[cfg(target_arch = "wasm32")]
mod by_name;

/// The instance does nothing before its script calls `start`.
fn main() {}
