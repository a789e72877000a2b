//! The panel of a loop.

use leptos::prelude::*;
use motorlink_messages::protocol::Mode;

use crate::{
    features::drive::{actions::Drive, loop_head::LoopHead},
    model::{guards::why_not_drive, page::Page, tab::Tab},
    ui::{reactive::dynamic, tab_panel::tab_panel, target::Target},
};

/// The panel of a loop: what the motor reports and the switch, what the loop has of its own, and
/// why it cannot drive now or else a hint, as HTML.
pub(crate) fn loop_panel(
    drive: Drive,
    mode: Mode,
    why_not: Signal<Option<String>>,
    hint: String,
    body: impl IntoView,
) -> impl IntoView {
    tab_panel(
        Tab::Loop(mode).key(),
        move || drive.page.loops.tab.get() != Tab::Loop(mode),
        view! {
            <LoopHead drive mode />
            {body}
            <Foot why_not hint />
        },
    )
}

/// Why the chosen motor cannot be driven in this loop now.
pub(crate) fn why_not_in(page: Page, mode: Mode) -> Signal<Option<String>> {
    page.of_motor(move |session, id| why_not_drive(session, id, mode))
        .into()
}

/// The same, or what is wrong with what is entered.
pub(crate) fn why_not_with(
    page: Page,
    mode: Mode,
    targets: impl IntoIterator<Item = Target>,
) -> Signal<Option<String>> {
    let why_not = why_not_in(page, mode);
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
    hint: String,
) -> impl IntoView {
    let blocked = move || why_not.with(Option::is_some);
    view! {
        <div class="tab-foot">
            <p class="reason" class:absent=dynamic(move || !blocked())>
                {dynamic(move || why_not.get().unwrap_or_default())}
            </p>
            <p class="quiet" class:absent=dynamic(blocked) inner_html=hint></p>
        </div>
    }
}
