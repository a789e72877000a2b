//! The panel of a loop.

use leptos::prelude::*;
use motorlink_messages::protocol::Mode;

use crate::{
    features::drive::{actions::Drive, loop_head::LoopHead},
    model::{guards::drive_blocked_by, page::Page, tab},
    ui::{reactive::dynamic, tab_panel::tab_panel, target::Target},
};

/// The panel of a loop: the reported values, the mode switch, the controls of the loop, and the reason why it
/// cannot drive now or a hint, as HTML.
pub(crate) fn loop_panel(
    drive: Drive,
    mode: Mode,
    disabled_reason: Signal<Option<String>>,
    hint: Signal<String>,
    body: impl IntoView,
) -> impl IntoView {
    tab_panel(
        tab::key(mode),
        move || drive.page.loops.tab.get() != mode,
        view! {
            <LoopHead drive mode />
            {body}
            <Foot disabled_reason hint />
        },
    )
}

/// Why the selected motor cannot be driven in this loop now.
pub(crate) fn loop_blocked_by(page: Page, mode: Mode) -> Signal<Option<String>> {
    page.of_motor(move |session, id| drive_blocked_by(session, id, mode))
        .into()
}

/// The same, or the error of the entered value.
pub(crate) fn loop_start_blocked_by(
    page: Page,
    mode: Mode,
    targets: impl IntoIterator<Item = Target>,
) -> Signal<Option<String>> {
    let disabled_reason = loop_blocked_by(page, mode);
    let targets: Vec<Target> = targets.into_iter().collect();
    Signal::derive(move || {
        let trouble = || targets.iter().find_map(|target| target.trouble());
        disabled_reason.get().or_else(trouble)
    })
}

/// The last lines of a tab: the reason why it cannot drive, for users who cannot hover over a button, or else a
/// hint. Both use one place, so that nothing moves.
#[component]
fn Foot(
    disabled_reason: Signal<Option<String>>,
    /// The hint, as HTML.
    hint: Signal<String>,
) -> impl IntoView {
    let blocked = move || disabled_reason.with(Option::is_some);
    view! {
        <div class="tab-foot">
            <p class="reason" class:absent=dynamic(move || !blocked())>
                {dynamic(move || disabled_reason.get().unwrap_or_default())}
            </p>
            <p class="quiet" class:absent=dynamic(blocked) inner_html=dynamic(move || hint.get())></p>
        </div>
    }
}
