//! The requests of the session worker to the recorder, on the channel between both.

use std::time::Duration;

use wasm_bindgen::JsValue;

/// A request for a part of what the recorder keeps.
#[derive(Clone, Copy, Debug)]
pub(crate) enum RecorderRequest {
    /// The first part: of everything, or of so much of its end.
    First(Option<Duration>),
    /// The next part.
    Next,
}

impl RecorderRequest {
    /// The message: seconds, or `false` for the next part.
    pub(crate) fn message(self) -> JsValue {
        match self {
            Self::First(last) => last.map_or(f64::INFINITY, |last| last.as_secs_f64()).into(),
            Self::Next => JsValue::FALSE,
        }
    }

    /// The request in a message; `None` if it is another message.
    pub(crate) fn of(message: &JsValue) -> Option<Self> {
        if let Some(seconds) = message.as_f64() {
            return Some(Self::First(Duration::try_from_secs_f64(seconds).ok()));
        }
        (message.as_bool() == Some(false)).then_some(Self::Next)
    }
}
