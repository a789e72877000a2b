//! The program of the runs of experiments. The port worker loads it into its own thread.

#[cfg(target_arch = "wasm32")]
use wasm_bindgen::prelude::wasm_bindgen;

/// Handles an encoded input at this time, in microseconds, and returns the encoded output.
#[cfg(target_arch = "wasm32")]
#[wasm_bindgen]
#[must_use]
pub fn run_program(input: &[u8], now_us: f64) -> Vec<u8> {
    motorlink_worker::run_program(input, now_us)
}

fn main() {}
