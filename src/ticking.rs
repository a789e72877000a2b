//! Readings grow old by themselves: the state is shown anew while the page is seen.

use leptos::prelude::*;

use crate::{clock::page_now_ms, desk::Desk};

/// Ten times a second: figures that change faster cannot be read.
const SHOWN_EVERY_MS: f64 = 100.0;

/// Shows the newest state from now on. Animation frames stop while the page is hidden, and this
/// with them.
pub(crate) fn keep_showing(desk: Desk) {
    let cleared = StoredValue::new(false);
    on_cleanup(move || cleared.set_value(true));
    next_frame(desk, cleared, page_now_ms());
}

fn next_frame(desk: Desk, cleared: StoredValue<bool>, shown_ms: f64) {
    request_animation_frame(move || {
        // A cleaned-up value is gone altogether.
        if cleared.try_get_value().unwrap_or(true) {
            return;
        }
        let now_ms = page_now_ms();
        let due = now_ms - shown_ms >= SHOWN_EVERY_MS;
        let anything = desk.latest.with_value(|session| !session.motors.is_empty());
        if due && anything {
            desk.show();
        }
        next_frame(desk, cleared, if due { now_ms } else { shown_ms });
    });
}
