//! Readings grow old by themselves: the state is shown again while the page is seen.

use leptos::prelude::*;

use crate::{
    model::page::Page,
    ui::animation::{Frames, Next},
};

/// Ten times a second: figures that change faster cannot be read.
const SHOWN_EVERY_MS: f64 = 100.0;

/// Shows the newest state from now on. Animation frames stop while the page is hidden, and this
/// with them.
pub(crate) fn refresh_while_visible(page: Page) {
    let frames = Frames::new(move |now_ms| {
        let anything = page
            .latest
            .try_with_value(|session| !session.motors.is_empty());
        if anything == Some(true) {
            page.show();
        }
        page.recorder().show();
        Next::in_step(SHOWN_EVERY_MS, now_ms)
    });
    let frames = StoredValue::new_local(Some(frames));
    on_cleanup(move || {
        let _ = frames.try_update_value(Option::take);
    });
}
