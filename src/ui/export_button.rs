//! A button that starts the export of a file, and then shows its progress and cancels it.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::ui::{button::PressButton, reactive::dynamic};

/// A button with this label. While the file is being written, it cancels that and has a progress bar.
#[component]
pub(crate) fn ExportButton(
    /// Its label.
    label: &'static str,
    /// The content of the file.
    hint: &'static str,
    /// Its label while the file is being written.
    #[prop(default = tr!("Cancel export"))]
    cancel_label: &'static str,
    /// The name of the progress bar.
    #[prop(default = tr!("Export"))]
    progress_label: &'static str,
    /// The written part, while the file is being written.
    per_mille: Signal<Option<u64>>,
    /// Why it cannot be pressed.
    disabled_reason: Signal<Option<String>>,
    /// Starts or cancels the export.
    #[prop(into)]
    on_press: Callback<()>,
) -> impl IntoView {
    let reads = move || {
        let reads = per_mille.get().map_or(label, |_| cancel_label);
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
                aria-label=progress_label
                max="1000"
                value=dynamic(move || per_mille.get().unwrap_or_default().to_string())
                hidden=dynamic(move || per_mille.get().is_none())
            ></progress>
        </span>
    }
}
