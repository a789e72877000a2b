//! The dock with graph and packet log: its edge resizes it, its title folds it. Where there is no room for both, tabs
//! choose one.

mod edge;

use leptos::prelude::*;
use motorlink_i18n::tr;

use self::edge::Edge;
use crate::{
    model::dock::{self, Look},
    ui::{
        choice_keys::move_choice,
        reactive::{dynamic, handler},
    },
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
                on:keydown=handler(|event| move_choice(&event))
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
