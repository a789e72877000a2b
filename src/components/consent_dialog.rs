//! Above 6.1 A the operator is asked whether it is meant.

use leptos::{html::Div, prelude::*};

use super::{button::PressButton, focus::focus_when, live::live};
use crate::{
    desk::{Dialog, use_desk},
    format,
};

#[component]
pub(crate) fn ConsentDialog() -> impl IntoView {
    let desk = use_desk();
    let dialog = NodeRef::<Div>::new();
    let asked = move || match desk.dialog.get() {
        Some(Dialog::HighCurrent(target)) => Some(target),
        _ => None,
    };
    let open = Memo::new(move |_| asked().is_some());
    focus_when(open, dialog);
    let drive = move || {
        let amps = asked().map(format::amps_of).unwrap_or_default();
        format!("Drive at {amps}")
    };
    view! {
        <div class="scrim" hidden=live(move || !open.get())>
            <div
                class="dialog consent"
                role="alertdialog"
                aria-modal="true"
                aria-label="High current"
                aria-describedby="consent-words"
                tabindex="-1"
                node_ref=dialog
            >
                <h2>{live(drive)} "?"</h2>
                <p id="consent-words">
                    "This is above 6.1 A. The motor stalls at 2.7 A, and its protection trips at 4.6 A in \
                    a phase. Fasten the motor and keep fingers clear."
                </p>
                <div class="dialog-foot">
                    <PressButton label="Cancel" on_press=move || desk.dialog.set(None) />
                    <PressButton
                        label=Signal::derive(drive)
                        class="button primary"
                        on_press=move || {
                            if let Some(target) = asked() {
                                desk.drive_high(target);
                            }
                        }
                    />
                </div>
            </div>
        </div>
    }
}
