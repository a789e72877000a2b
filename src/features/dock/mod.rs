//! The dock with graph and packet log: its edge resizes it, its title folds it. Where there is no room for both, tabs
//! choose one.

mod edge;

use leptos::prelude::*;
use motorlink_i18n::tr;
use wasm_bindgen::JsCast;
use web_sys::{Element, HtmlElement, KeyboardEvent};

use self::edge::Edge;
use crate::{
    model::dock::{self, Look},
    ui::reactive::{dynamic, handler},
};

/// Separator `Height of graph and packet log`, button `Graph and packet log`, and tabs `Graph` and `Packet log`.
#[component]
pub(crate) fn Dock() -> impl IntoView {
    let look = RwSignal::new(dock::look());
    let change = move |to: Look| {
        look.set(to);
        dock::show(to);
    };
    let fold = move |_| {
        let now = look.get_untracked();
        let folded = !now.folded;
        change(Look { folded, ..now });
    };
    let expanded = move || (!look.get().folded).to_string();
    let tab = move |log: bool, name: &'static str| {
        let chosen = move || look.get().log == log;
        view! {
            <button
                type="button"
                role="tab"
                class="tab"
                aria-selected=dynamic(move || chosen().to_string())
                tabindex=dynamic(move || if chosen() { "0" } else { "-1" })
                on:click=handler(move |_| change(Look { log, ..look.get_untracked() }))
                on:keydown=handler(move |event| move_to_other(&event))
            >
                {name}
            </button>
        }
    };
    view! {
        <div class="dock">
            <Edge />
            <button
                type="button"
                class="dock-title"
                aria-expanded=dynamic(expanded)
                title=tr!("Hides or shows graph and packet log.")
                on:click=handler(fold)
            >
                <span>{tr!("Graph and packet log")}</span>
            </button>
            <div class="tabs dock-tabs" role="tablist" aria-label=tr!("Graph and packet log")>
                {tab(false, tr!("Graph"))}
                {tab(true, tr!("Packet log"))}
            </div>
        </div>
    }
}

/// An arrow key, Home or End chooses the other one of the two tabs, and takes the focus there.
fn move_to_other(event: &KeyboardEvent) {
    let from = event.target().and_then(|at| at.dyn_into::<Element>().ok());
    let Some(from) = from else { return };
    let (next, previous) = (from.next_element_sibling(), from.previous_element_sibling());
    let to = match event.key().as_str() {
        "ArrowLeft" | "ArrowRight" => next.or(previous),
        "Home" => previous,
        "End" => next,
        _ => return,
    };
    event.prevent_default();
    if let Some(to) = to.and_then(|to| to.dyn_into::<HtmlElement>().ok()) {
        to.click();
        // Without the focus it is chosen all the same.
        let _ = to.focus();
    }
}
