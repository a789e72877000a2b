//! The control panel: a tab for each loop.

pub(crate) mod actions;
pub(crate) mod current;
pub(crate) mod limit;
pub(crate) mod loop_head;
pub(crate) mod loop_panel;
pub(crate) mod one_stop;
pub(crate) mod open_loop;
pub(crate) mod position;
pub(crate) mod rate;
pub(crate) mod stop_and_start;
pub(crate) mod velocity;

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::protocol::Mode;

use crate::{
    features::drive::rate::CommandRate,
    model::{
        page::use_page,
        tab::{self, TABS},
    },
    ui::{
        choice_keys::move_choice,
        reactive::{dynamic, handler},
        tab_panel::{panel_id, tab_id},
    },
};

/// Tablist `Control`, with the place for its panels.
#[component]
pub(crate) fn ControlPanel() -> impl IntoView {
    view! {
        <section class="panel control-panel" aria-label=tr!("Control")>
            <div class="tabs" role="tablist" aria-label=tr!("Control")>
                {TABS.map(|mode| view! { <TabButton mode /> }).collect_view()}
            </div>
            <div class="tab-panels"></div>
            <CommandRate />
        </section>
    }
}

#[component]
fn TabButton(mode: Mode) -> impl IntoView {
    let page = use_page();
    let selected = move || page.loops.tab.get() == mode;
    view! {
        <button
            type="button"
            role="tab"
            class="tab"
            hidden=dynamic(move || !page.model.get().has(mode))
            id=tab_id(tab::key(mode))
            aria-controls=panel_id(tab::key(mode))
            aria-selected=dynamic(move || if selected() { "true" } else { "false" })
            tabindex=dynamic(move || if selected() { "0" } else { "-1" })
            on:click=handler(move |_| page.loops.tab.set(mode))
            on:keydown=handler(|event| move_choice(&event))
        >
            {tab::name(mode)}
        </button>
    }
}
