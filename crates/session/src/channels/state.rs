//! `/state`: what the page showed, for a replay. Each message is the time in microseconds of the session's clock, as eight
//! bytes with the lowest first, and a state as `motorlink_messages::stored_state` stores it.

use motorlink_messages::{Update, stored_state};
use motorlink_protocol::Instant;

/// The encoding of the messages, in the file.
pub(crate) const ENCODING: &str = "motorlink-state";

/// The message of a stored state.
pub(crate) fn message(at: Instant, stored: &[u8]) -> Vec<u8> {
    [&at.as_micros().to_le_bytes(), stored].concat()
}

/// The state in a message; `None` of its state if that is of another version.
pub(crate) fn read(data: &[u8]) -> Option<(Instant, Option<Update>)> {
    let (at, stored) = data.split_first_chunk()?;
    let at = Instant::from_micros(u64::from_le_bytes(*at));
    Some((at, stored_state::read(stored, at)))
}
