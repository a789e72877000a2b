//! The local time of the browser.

use js_sys::Date;
use motorlink_recorder::LocalTime;

/// Local time from this moment until now, in milliseconds since 1970.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "milliseconds since 1970 are exact in a double, and no place is a day ahead"
)]
pub(crate) fn local_time(from_ms: i64) -> LocalTime {
    LocalTime::between(from_ms, Date::now() as i64, |unix_ms| {
        -Date::new(&(unix_ms as f64).into()).get_timezone_offset() as i32
    })
}
