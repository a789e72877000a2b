//! The program of the page and of its workers: which it is, the scope tells in which it runs.

#[cfg(target_arch = "wasm32")]
fn main() {
    if web_sys::window().is_some() {
        motorlink::start();
    } else {
        motorlink_worker::start();
    }
}

/// The page's pure parts are built and tested natively, and this with them.
#[cfg(not(target_arch = "wasm32"))]
fn main() {}
