//! The program of the session worker.

#[cfg(target_arch = "wasm32")]
fn main() {
    motorlink_worker::start_sessions();
}

/// A worker runs in a browser only.
#[cfg(not(target_arch = "wasm32"))]
fn main() {}
