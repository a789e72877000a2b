//! The clock of the page, which includes the time that the computer slept, and the time of day.

use std::cell::Cell;

use motorlink_messages::AwakeClock;
use wasm_bindgen::JsCast;

use crate::ui::mathematics::modulo;

const DAY_MS: f64 = 86_400_000.0;

thread_local! {
    /// The worker includes the time asleep as well. Without it here, all actions after a sleep would seem too old.
    static AWAKE: Cell<AwakeClock> = Cell::default();
}

/// The page's `performance.now()` including the time that the computer slept; 0 without a browser.
pub(crate) fn page_now_ms() -> f64 {
    performance().map_or(0.0, |performance| {
        let mut awake = AWAKE.get();
        let now_ms = awake.read(performance.now(), js_sys::Date::now());
        AWAKE.set(awake);
        now_ms
    })
}

/// A time of the browser, such as that of an event or of a frame, as [`page_now_ms`] counts.
pub(crate) fn with_time_asleep(browser_ms: f64) -> f64 {
    AWAKE.get().of_event(browser_ms)
}

/// The page's `performance.timeOrigin`.
pub(crate) fn page_origin_ms() -> f64 {
    performance().map_or(0.0, |performance| performance.time_origin())
}

/// `13:02:11`, the local time of day at a moment of the wall clock in milliseconds.
pub(crate) fn local_time(wall_ms: f64) -> String {
    time_of_day(local_ms(wall_ms))
}

/// `2026-11-21`, the local date at a moment of the wall clock in milliseconds.
pub(crate) fn local_date(wall_ms: f64) -> String {
    let iso: String = js_sys::Date::new(&local_ms(wall_ms).into())
        .to_iso_string()
        .into();
    iso.chars().take(10).collect()
}

/// Shifts a time of the wall clock, in milliseconds, by the local offset from UTC.
fn local_ms(wall_ms: f64) -> f64 {
    let date = js_sys::Date::new(&wall_ms.into());
    wall_ms - date.get_timezone_offset() * 60_000.0
}

/// Microseconds since local midnight at a moment of the wall clock in milliseconds.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and a day"
)]
pub(crate) fn day_us(wall_ms: f64) -> u64 {
    (modulo(local_ms(wall_ms), DAY_MS) * 1_000.0) as u64
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the seconds of a day are few and not negative"
)]
fn time_of_day(local_ms: f64) -> String {
    let second = modulo((local_ms / 1000.0).floor(), 86_400.0) as u32;
    format!(
        "{:02}:{:02}:{:02}",
        second / 3600,
        second / 60 % 60,
        second % 60
    )
}

/// The time of the user's action that is being handled, in milliseconds of the page's `performance.now()`. It is the
/// event's own time, which stays right if the page hung; without an event it is now.
pub(crate) fn act_ms() -> f64 {
    let event =
        web_sys::window().and_then(|window| window.event().dyn_into::<web_sys::Event>().ok());
    let now_ms = page_now_ms();
    event.map_or(now_ms, |event| with_time_asleep(event.time_stamp()))
}

fn performance() -> Option<web_sys::Performance> {
    web_sys::window()?.performance()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_of_day_is_cut_off_at_the_second() {
        let midnight_ms = 20_000.0 * 86_400_000.0;
        for (ms, text) in [
            (0.0, "00:00:00"),
            (46_931_999.0, "13:02:11"),
            (86_399_999.9, "23:59:59"),
            (86_400_000.0, "00:00:00"),
            // West of Greenwich the local date may be the day before.
            (-1.0, "23:59:59"),
        ] {
            assert_eq!(time_of_day(midnight_ms + ms), text);
        }
    }
}
