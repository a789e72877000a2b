//! The program of the worker that connects the page to a server.

#[cfg(target_arch = "wasm32")]
fn main() {
    motorlink_worker::start_remote();
}

/// A worker runs in a browser only.
#[cfg(not(target_arch = "wasm32"))]
fn main() {}
