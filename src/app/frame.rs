//! The placeholder of a section until its part is loaded, or if loading fails.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::{
    app::{
        absent::{Absent, notice},
        features::Features,
        sections::Frame,
    },
    model::{page::Dialog, tab},
    ui::{
        reactive::{dynamic, handler},
        tab_panel::tab_panel,
    },
};

/// The placeholder of a section. `retry` loads its part again.
pub(crate) fn frame(
    frame: Frame,
    features: Features,
    state: RwSignal<Absent>,
    retry: impl Fn() + Copy + 'static,
) -> AnyView {
    let page = features.page;
    let notice = notice(state, retry);
    match frame {
        Frame::Panel(class, is_open) => {
            view! { <section class=class hidden=dynamic(move || !is_open(page))>{notice}</section> }
                .into_any()
        }
        Frame::Tab(mode) => {
            tab_panel(tab::key(mode), move || page.loops.tab.get() != mode, notice).into_any()
        }
        Frame::Nothing => ().into_any(),
        Frame::Help => {
            let is_open = move || matches!(page.dialog.get(), Some(Dialog::Help(_)));
            view! {
                <div class="scrim" hidden=dynamic(move || !is_open())>
                    <div class="dialog help" role="dialog" aria-modal="true" aria-label=tr!("Help")>
                        {notice}
                        <button
                            type="button"
                            class="button"
                            on:click=handler(move |_| page.dialog.set(None))
                        >
                            {tr!("Close")}
                        </button>
                    </div>
                </div>
            }
            .into_any()
        }
    }
}
