//! The placeholder of a section until its part is loaded, or if loading fails.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::{
    app::{
        absent::{Absent, notice},
        features::Features,
        sections::Frame,
    },
    model::page::Dialog,
    ui::{
        drawer::{Drawer, panel_of_drawer},
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
        Frame::Panel(class) => view! { <section class=class>{notice}</section> }.into_any(),
        Frame::Tab(tab) => {
            tab_panel(tab.key(), move || page.loops.tab.get() != tab, notice).into_any()
        }
        Frame::Drawer(which) => {
            panel_of_drawer(page.drawer, which, title(which), notice).into_any()
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

fn title(drawer: Drawer) -> &'static str {
    match drawer {
        Drawer::Link => tr!("Link"),
        // The setup of the wheels and the session file come with the panel Drive together, and have no placeholder.
        Drawer::Together
        | Drawer::WheelSetup
        | Drawer::Session
        | Drawer::SetupLink
        | Drawer::Experiments => {
            tr!("Drive together")
        }
        Drawer::Settings => tr!("Settings"),
        Drawer::VirtualMotors => tr!("Virtual motors"),
    }
}
