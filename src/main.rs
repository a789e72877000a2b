//! The program of the page. Its workers are programs of their own, in `crates/worker`.

#[cfg(target_arch = "wasm32")]
fn main() {
    motorlink::start();
}

/// The parts of the page that need no browser are built and tested natively, and this with them.
#[cfg(not(target_arch = "wasm32"))]
fn main() {}
