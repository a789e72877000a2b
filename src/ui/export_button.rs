//! A button that has a file written, and meanwhile shows its progress and cancels it.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::ui::{button::PressButton, reactive::dynamic};

/// A button of this name; while the file is being written `Cancel export`, with a progress bar.
#[component]
pub(crate) fn ExportButton(
    /// What it reads.
    label: &'static str,
    /// What the file holds.
    hint: &'static str,
    /// How much is written, while the file is being written.
    per_mille: Signal<Option<u64>>,
    /// Why it cannot be pressed.
    disabled_reason: Signal<Option<String>>,
    /// Starts to write the file, or cancels it.
    #[prop(into)]
    on_press: Callback<()>,
) -> impl IntoView {
    let reads = move || {
        let reads = per_mille.get().map_or(label, |_| tr!("Cancel export"));
        reads.to_owned()
    };
    view! {
        <span class="export">
            <PressButton
                label=Signal::derive(reads)
                class="button small"
                hint
                disabled_reason=disabled_reason
                on_press=move || on_press.run(())
            />
            <progress
                aria-label=tr!("Export")
                max="1000"
                value=dynamic(move || per_mille.get().unwrap_or_default().to_string())
                hidden=dynamic(move || per_mille.get().is_none())
            ></progress>
        </span>
    }
}
