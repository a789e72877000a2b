//! The control panel: a tab for each loop, and one for each tool.

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
use wasm_bindgen::JsCast;
use web_sys::{HtmlElement, KeyboardEvent};

use crate::{
    features::drive::rate::Settings,
    model::{
        page::{Page, use_page},
        tab::Tab,
    },
    ui::{
        reactive::{dynamic, handler},
        tab_panel::{panel_id, tab_id},
    },
};

/// Tablist `Control`, with the place for its panels.
#[component]
pub(crate) fn ControlPanel() -> impl IntoView {
    view! {
        // The skip link leads here.
        <section class="panel control-panel" aria-label=tr!("Control") id="control" tabindex="-1">
            <div class="tabs" role="tablist" aria-label=tr!("Control")>
                {Tab::ALL.map(|tab| view! { <TabButton tab /> }).collect_view()}
            </div>
            <div class="tab-panels"></div>
            <Settings />
        </section>
    }
}

#[component]
fn TabButton(tab: Tab) -> impl IntoView {
    let page = use_page();
    let selected = move || page.loops.tab.get() == tab;
    // A repeated frame continues when another tab is opened, so its tab shows that.
    let working = page.of_motor(move |session, _| match tab {
        Tab::Loop(_) => false,
        Tab::IdManager => session.job.is_some(),
        Tab::RawHex => session.raw.is_some_and(|raw| raw.running),
    });
    view! {
        <button
            type="button"
            role="tab"
            class="tab"
            class:working=working
            hidden=dynamic(move || !tab.is_of(page.model.get()))
            id=tab_id(tab.key())
            aria-controls=panel_id(tab.key())
            aria-selected=dynamic(move || if selected() { "true" } else { "false" })
            tabindex=dynamic(move || if selected() { "0" } else { "-1" })
            on:click=handler(move |_| page.open_tab(tab))
            on:keydown=handler(move |event| move_between_tabs(page, tab, &event))
        >
            {tab.name()}
        </button>
    }
}

/// Arrow keys, Home and End choose a tab and take the focus with them.
fn move_between_tabs(page: Page, from: Tab, event: &KeyboardEvent) {
    let model = page.model.get_untracked();
    let tabs: Vec<Tab> = Tab::ALL
        .into_iter()
        .filter(|tab| tab.is_of(model))
        .collect();
    let last = tabs.len() - 1;
    let place = tabs.iter().position(|tab| *tab == from).unwrap_or(0);
    let place = match event.key().as_str() {
        "ArrowRight" if place == last => 0,
        "ArrowRight" => place + 1,
        "ArrowLeft" => place.checked_sub(1).unwrap_or(last),
        "Home" => 0,
        "End" => last,
        _ => return,
    };
    event.prevent_default();
    if let Some(tab) = tabs.get(place) {
        page.open_tab(*tab);
        let tab = document().get_element_by_id(&tab_id(tab.key()));
        if let Some(tab) = tab.and_then(|tab| tab.dyn_into::<HtmlElement>().ok()) {
            // The tab is selected even if it cannot be focused.
            let _ = tab.focus();
        }
    }
}
