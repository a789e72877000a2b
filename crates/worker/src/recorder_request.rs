//! The requests of the session worker to the recorder, on the channel between both.

use std::time::Duration;

use motorlink_messages::sessions::SaveRange;
use wasm_bindgen::JsValue;

/// A request for a part of what the recorder keeps.
#[derive(Clone, Copy, Debug)]
pub(crate) enum RecorderRequest {
    /// The first part of this range.
    First(SaveRange),
    /// The next part.
    Next,
}

/// The numbers of ranges; others are seconds.
const LINE: f64 = -1.0;
const LINE_BEFORE: f64 = -2.0;
const RECORDING: f64 = -3.0;

impl RecorderRequest {
    /// The message: the number of a range, or `false` for the next part.
    pub(crate) fn message(self) -> JsValue {
        match self {
            Self::First(SaveRange::Line) => LINE.into(),
            Self::First(SaveRange::LineBefore) => LINE_BEFORE.into(),
            Self::First(SaveRange::Recording) => RECORDING.into(),
            Self::First(SaveRange::Last(last)) => last.as_secs_f64().into(),
            Self::Next => JsValue::FALSE,
        }
    }

    /// The request in a message; `None` if it is another message.
    pub(crate) fn of(message: &JsValue) -> Option<Self> {
        if let Some(number) = message.as_f64() {
            // A range without a time has a number that is none.
            let last = Duration::try_from_secs_f64(number).ok();
            let other = if number == LINE_BEFORE {
                SaveRange::LineBefore
            } else if number == RECORDING {
                SaveRange::Recording
            } else {
                SaveRange::Line
            };
            return Some(Self::First(last.map_or(other, SaveRange::Last)));
        }
        (message.as_bool() == Some(false)).then_some(Self::Next)
    }
}
