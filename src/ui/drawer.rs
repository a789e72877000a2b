//! The drawer's frame: a panel that lies over the right of the desk and closes nothing off. STOP and
//! the rest of the page stay in reach.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::{
    model::{desk::use_desk, drawer::Drawer},
    ui::{button::PressButton, reactive::live},
};

/// A panel of the drawer, mounted once and shown while it is wanted.
pub(crate) fn panel_of_drawer(
    which: Drawer,
    title: &'static str,
    content: impl IntoView + 'static,
) -> impl IntoView {
    let desk = use_desk();
    let closed = move || desk.drawer.get() != Some(which);
    view! {
        <section class="panel drawer" aria-label=title hidden=live(closed)>
            <div class="drawer-head">
                <h2>{title}</h2>
                <PressButton
                    label=tr!("Close")
                    name=tr!("Close the panel")
                    class="button small"
                    on_press=move || desk.drawer.set(None)
                />
            </div>
            {content}
        </section>
    }
}
