//! Panel `Session file`: saves a session, opens one, and shows what is in it.

use leptos::{html::Input, prelude::*};
use motorlink_i18n::tr;
use motorlink_messages::sessions::SaveRange;
use wasm_bindgen::JsCast;
use web_sys::HtmlInputElement;

use crate::{
    features::session_file::{
        actions::{Said, SessionFiles},
        content::content,
        incoming::Incoming,
        save_range::RANGES,
        texts,
    },
    model::{recorder_texts::no_recorder, snapshot::Session},
    ui::{
        button::PressButton,
        export_button::ExportButton,
        reactive::{dynamic, handler},
    },
};

/// What the chooser of files offers: sessions, our exports and the original page's log.
const ENDINGS: &str = ".mcap,.csv,.txt";

/// The panel without its frame.
#[component]
pub(crate) fn SessionPanel(files: SessionFiles, incoming: Incoming) -> impl IntoView {
    files.follow(incoming);
    let chooser = NodeRef::<Input>::new();
    let alive = files.page.recorder().alive;
    let recording = files.page.recorder().recording;
    let save_blocked_by = move || {
        let has_nothing = files.save_range.get() == SaveRange::Recording
            && recording.with(|recording| recording.recorded == 0);
        if alive.get() {
            has_nothing
                .then(|| tr!("Nothing is recorded: press Record telemetry first.").to_owned())
        } else {
            Some(no_recorder().to_owned())
        }
    };
    let open_blocked_by = move || {
        let drives = files.page.shown.with(Session::is_anything_driven);
        let reads = files.reading.get().is_some();
        let reason = if drives {
            tr!(
                "Stop the motors first: the browser's dialog would cover STOP. Or drop the file here."
            )
        } else {
            tr!("Another file is being read.")
        };
        (drives || reads).then(|| reason.to_owned())
    };
    let choose = move || {
        if let Some(chooser) = chooser.get_untracked() {
            chooser.click();
        }
    };
    let chosen = move |event: web_sys::Event| {
        let input = event
            .target()
            .and_then(|at| at.dyn_into::<HtmlInputElement>().ok());
        let Some(input) = input else { return };
        if let Some(file) = input.files().and_then(|files| files.get(0)) {
            files.open_file(&file.into());
        }
        // Choosing the same file again is a change too.
        input.set_value("");
    };
    view! {
        <div class="session-panel">
            <p>
                {tr!(
                    "A session file contains the packet log, the recording, the runs of experiments and the present settings. Foxglove and PlotJuggler open it too."
                )}
            </p>
            <div class="button-row">
                {range_choice(files)}
                <ExportButton
                    label=tr!("Save session")
                    cancel_label=tr!("Cancel saving")
                    progress_label=tr!("Saving")
                    hint=tr!("Saves the packet log, the recording and the runs of experiments as one file. Motors keep running.")
                    per_mille=Signal::derive(move || files.saving.get())
                    disabled_reason=Signal::derive(save_blocked_by)
                    on_press=move || files.save_or_cancel()
                />
                <PressButton
                    label=tr!("Open recording")
                    class="button small"
                    hint=tr!("A session (.mcap) or an exported CSV file. You can also drop it onto the page.")
                    disabled_reason=Signal::derive(open_blocked_by)
                    on_press=choose
                />
                <input
                    type="file"
                    accept=ENDINGS
                    hidden=true
                    node_ref=chooser
                    on:change=handler(chosen)
                />
            </div>
            <div class="session-reading" hidden=dynamic(move || files.reading.get().is_none())>
                <progress
                    aria-label=tr!("Reading")
                    max="1000"
                    value=dynamic(move || files.reading.get().unwrap_or_default().to_string())
                ></progress>
                <PressButton
                    label=tr!("Cancel")
                    class="button small"
                    on_press=move || files.cancel_reading()
                />
            </div>
            <div role="status" aria-label=tr!("Session file")>
                {said(files.saved)}
                {said(files.said)}
            </div>
            {move || files.open.get().map(|info| content(files, &info))}
        </div>
    }
}

/// How much is saved.
fn range_choice(files: SessionFiles) -> impl IntoView {
    let options = RANGES.map(|(range, key)| {
        let selected = files.save_range.get_untracked() == range;
        view! { <option value=key selected=selected>{texts::of_save_range(range)}</option> }
    });
    let choose = move |event| {
        let chosen = event_target_value(&event);
        if let Some((range, _)) = RANGES.into_iter().find(|(_, key)| *key == chosen) {
            files.save_range.set(range);
        }
    };
    view! {
        <select
            class="select"
            aria-label=tr!("What to save")
            on:change=handler(choose)
        >
            {options.collect_view()}
        </select>
    }
}

fn said(said: RwSignal<Said>) -> impl IntoView {
    let class = move || {
        if said.with(|said| said.error) {
            "session-said bad"
        } else {
            "session-said"
        }
    };
    view! {
        <p class=dynamic(class)>{dynamic(move || said.with(|said| said.text.clone()))}</p>
    }
}
