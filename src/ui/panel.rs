//! A panel of a place. STOP and the rest of the page stay usable.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::ui::{button::PressButton, reactive::dynamic};

/// What `Close` does.
pub(crate) type OnClose = Option<Box<dyn Fn() + Send + Sync>>;

/// A panel, mounted once and shown while it is open. One that a button opens has a button to close it. All panels have the
/// same elements, so that they share their code.
pub(crate) fn panel(
    class: &'static str,
    title: &'static str,
    is_open: impl Fn() -> bool + Send + 'static,
    on_close: OnClose,
    content: impl IntoView + 'static,
) -> impl IntoView {
    framed(class, title, dynamic(move || !is_open()), on_close, content)
}

fn framed(
    class: &'static str,
    title: &'static str,
    is_closed: Box<dyn FnMut() -> bool + Send>,
    on_close: OnClose,
    content: impl IntoView + 'static,
) -> impl IntoView {
    let is_fixed = on_close.is_none();
    let close = move || {
        if let Some(close) = &on_close {
            close();
        }
    };
    view! {
        <section class=class aria-label=title hidden=is_closed>
            <div class="place-head">
                <h2>{title}</h2>
                <PressButton
                    label=tr!("Close")
                    name=tr!("Close the panel")
                    class=if is_fixed { "closed" } else { "button small" }
                    on_press=close
                />
            </div>
            {content}
        </section>
    }
}
