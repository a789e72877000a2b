//! The program of the worker that owns the port.

#[cfg(target_arch = "wasm32")]
fn main() {
    motorlink_worker::start_worker();
}

/// A worker runs in a browser only.
#[cfg(not(target_arch = "wasm32"))]
fn main() {}
