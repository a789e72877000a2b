//! A button that has a file made, and while it is being written shows how far it is and ends it.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::recorder::Export;

use crate::{
    features::recording::texts::no_recorder,
    model::desk::use_desk,
    ui::{button::PressButton, reactive::live},
};

/// A button of this name; while the file is being written `Cancel export`, and a progress bar in it.
#[component]
pub(crate) fn ExportButton(
    /// Which file.
    what: Export,
    /// What it reads.
    label: &'static str,
    /// What the file holds.
    hint: &'static str,
    /// Why there is nothing to export.
    #[prop(into)]
    why_empty: Signal<Option<String>>,
) -> impl IntoView {
    let desk = use_desk();
    let exporting = desk.recorder.exporting;
    let is_mine = move || exporting.with(|one| one.is_some_and(|one| one.what == what));
    let why_not = move || {
        if !desk.recorder.alive.get() {
            return Some(no_recorder().to_owned());
        }
        match exporting.get() {
            Some(one) if one.what == what => None,
            Some(_) => Some(tr!("The other file is being written.").to_owned()),
            None => why_empty.get(),
        }
    };
    let per_mille = move || exporting.with(|one| one.map_or(0, |one| one.per_mille));
    let reads = move || {
        if is_mine() {
            tr!("Cancel export")
        } else {
            label
        }
        .to_owned()
    };
    view! {
        <span class="export">
            <PressButton
                label=Signal::derive(reads)
                class="button small"
                hint
                why_not=Signal::derive(why_not)
                on_press=move || desk.export_or_cancel(what)
            />
            <progress
                aria-label=tr!("Export")
                max="1000"
                value=live(move || per_mille().to_string())
                hidden=live(move || !is_mine())
            ></progress>
        </span>
    }
}
