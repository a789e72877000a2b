//! What the system or the browser prefers.

use leptos::prelude::window;

pub(crate) fn prefers_dark() -> bool {
    matches("(prefers-color-scheme: dark)")
}

pub(crate) fn wants_less_motion() -> bool {
    matches("(prefers-reduced-motion: reduce)")
}

fn matches(query: &str) -> bool {
    let list = window().match_media(query).ok().flatten();
    list.is_some_and(|list| list.matches())
}
