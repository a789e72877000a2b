//! What an operator asks of the motor: a tab for each loop.

mod current;
mod dial;
mod loop_head;
mod number_field;
mod position;
mod settings;
mod slider;
mod velocity;

use leptos::prelude::*;
use motorlink_messages::protocol::Mode;
use wasm_bindgen::JsCast;
use web_sys::{HtmlElement, KeyboardEvent};

use crate::components::live::{heard, live};

use self::{current::CurrentTab, position::PositionTab, settings::Settings, velocity::VelocityTab};
use crate::{
    desk::{Desk, use_desk},
    permission::why_not_drive,
    target::Target,
};

/// In the order of the tabs.
const TABS: [Mode; 3] = [Mode::Velocity, Mode::Current, Mode::Position];

/// Tablist `Control` with its panels.
#[component]
pub(crate) fn ControlPanel() -> impl IntoView {
    view! {
        <section class="panel control-panel" aria-label="Control">
            <div class="tabs" role="tablist" aria-label="Control">
                <Tab mode=Mode::Velocity />
                <Tab mode=Mode::Current />
                <Tab mode=Mode::Position />
            </div>
            <div class="tab-panels">
                <VelocityTab />
                <CurrentTab />
                <PositionTab />
            </div>
            <Settings />
        </section>
    }
}

const fn tab_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Velocity => "Velocity",
        Mode::Current => "Current",
        Mode::Position => "Position",
    }
}

fn tab_id(mode: Mode) -> String {
    format!("tab-{}", tab_name(mode))
}

fn panel_id(mode: Mode) -> String {
    format!("panel-{}", tab_name(mode))
}

/// Whether a tab's panel is out of sight and out of reach; it keeps its place, so that nothing moves
/// when the tab changes.
fn closed(desk: Desk, mode: Mode) -> Box<dyn FnMut() -> bool + Send> {
    live(move || desk.tab.get() != mode)
}

#[component]
fn Tab(mode: Mode) -> impl IntoView {
    let desk = use_desk();
    let selected = move || desk.tab.get() == mode;
    view! {
        <button
            type="button"
            role="tab"
            class="tab"
            id=tab_id(mode)
            aria-controls=panel_id(mode)
            aria-selected=live(move || if selected() { "true" } else { "false" })
            tabindex=live(move || if selected() { "0" } else { "-1" })
            on:click=heard(move |_| desk.tab.set(mode))
            on:keydown=heard(move |event| move_between_tabs(desk, mode, &event))
        >
            {tab_name(mode)}
        </button>
    }
}

/// Arrow keys, Home and End choose a tab and take the focus with them.
fn move_between_tabs(desk: Desk, from: Mode, event: &KeyboardEvent) {
    let last = TABS.len() - 1;
    let place = TABS.iter().position(|tab| *tab == from).unwrap_or(0);
    let place = match event.key().as_str() {
        "ArrowRight" if place == last => 0,
        "ArrowRight" => place + 1,
        "ArrowLeft" => place.checked_sub(1).unwrap_or(last),
        "Home" => 0,
        "End" => last,
        _ => return,
    };
    event.prevent_default();
    if let Some(mode) = TABS.get(place) {
        desk.tab.set(*mode);
        let tab = document().get_element_by_id(&tab_id(*mode));
        if let Some(tab) = tab.and_then(|tab| tab.dyn_into::<HtmlElement>().ok()) {
            // A tab that cannot be focused is chosen all the same.
            let _ = tab.focus();
        }
    }
}

/// Why the chosen motor cannot be driven in this loop now.
fn why_not_in(desk: Desk, mode: Mode) -> Signal<Option<String>> {
    desk.of_motor(move |session, id| why_not_drive(session, id, mode))
        .into()
}

/// The same, or what is wrong with what is entered.
fn why_not_with(
    desk: Desk,
    mode: Mode,
    targets: impl IntoIterator<Item = Target>,
) -> Signal<Option<String>> {
    let why_not = why_not_in(desk, mode);
    let targets: Vec<Target> = targets.into_iter().collect();
    Signal::derive(move || {
        let trouble = || targets.iter().find_map(|target| target.trouble());
        why_not.get().or_else(trouble)
    })
}

/// The last lines of a tab: the reason why it cannot drive, for those who cannot point at a button
/// to read its title, else what is good to know. One place for both, so that nothing moves.
#[component]
fn Foot(
    why_not: Signal<Option<String>>,
    /// What is good to know, as HTML.
    hint: &'static str,
) -> impl IntoView {
    let blocked = move || why_not.with(Option::is_some);
    view! {
        <div class="tab-foot">
            <p class="reason" class:absent=live(move || !blocked())>
                {live(move || why_not.get().unwrap_or_default())}
            </p>
            <p class="quiet" class:absent=live(blocked) inner_html=hint></p>
        </div>
    }
}
