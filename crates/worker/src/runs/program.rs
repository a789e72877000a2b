//! The program of the runs, as the port worker calls it.

use std::cell::RefCell;

use motorlink_messages::{decode, encode, runs::to_page};
use motorlink_protocol::Instant;
use motorlink_runs::Program;

use crate::scope::{post_bytes, report};

thread_local! {
    static PROGRAM: RefCell<Program> = RefCell::default();
}

/// Handles an encoded input and returns the encoded output; nothing if a message cannot be read or written, which the
/// port worker treats as a failure.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float cast saturates, and the time is whole microseconds since the start"
)]
pub(crate) fn handle(input: &[u8], now_us: f64) -> Vec<u8> {
    let now = Instant::from_micros(now_us as u64);
    let Ok(input) = decode(input) else {
        return Vec::new();
    };
    let (output, messages) = PROGRAM.with_borrow_mut(|program| {
        let output = program.handle(now, &input);
        (output, program.take_messages())
    });
    for message in messages {
        match to_page(&message) {
            Ok(bytes) => post_bytes(&bytes),
            Err(error) => report("a message of a run", &error.to_string().into()),
        }
    }
    encode(&output).unwrap_or_default()
}
