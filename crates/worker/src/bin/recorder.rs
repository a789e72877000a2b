//! The program of the recorder.

#[cfg(target_arch = "wasm32")]
fn main() {
    motorlink_worker::start_recorder();
}

/// A worker runs in a browser only.
#[cfg(not(target_arch = "wasm32"))]
fn main() {}
