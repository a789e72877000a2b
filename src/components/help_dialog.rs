//! The help: wiring, the first spin, what STOP does, keys.

use leptos::{html::Div, prelude::*};

use super::{button::PressButton, focus::focus_when, live::live};
use crate::{
    components::live::memo,
    desk::{Dialog, use_desk},
};

/// Dialog `Help`. STOP stays above it.
#[component]
pub(crate) fn HelpDialog() -> impl IntoView {
    let desk = use_desk();
    let dialog = NodeRef::<Div>::new();
    let open = memo(move || desk.dialog.get() == Some(Dialog::Help));
    focus_when(open, dialog);
    view! {
        <div class="scrim" hidden=live(move || !open.get())>
            <div
                class="dialog help"
                role="dialog"
                aria-modal="true"
                aria-label="Help"
                tabindex="-1"
                node_ref=dialog
            >
                <div class="dialog-head">
                    <h2>"Help"</h2>
                    <PressButton label="Close" on_press=move || desk.dialog.set(None) />
                </div>
                <div class="help-columns" inner_html=include_str!("help.html")></div>
            </div>
        </div>
    }
}
