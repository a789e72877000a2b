//! The recording of telemetry, and its export.

pub(crate) mod texts;

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::recorder::{Export, RecordingStatus, ToRecorder};

use crate::{
    features::recording::texts as words,
    model::{
        page::use_page, place::Place, recorder_texts::no_recorder, replay::blocked,
        snapshot::Session,
    },
    ui::{
        export_button::ExportButton,
        panel::panel,
        reactive::{dynamic, handler, memo},
    },
};

/// Panel `Recording`.
#[component]
pub(crate) fn Recording() -> impl IntoView {
    let page = use_page();
    let recorder = page.recorder();
    let alive = recorder.alive;
    let status = recorder.recording;
    let records = memo(move || status.with(|status| status.recording));
    let says = memo(move || {
        if alive.get() {
            status.with(words::of_recording)
        } else {
            ("", no_recorder().to_owned())
        }
    });
    let replays = memo(move || page.shown.with(Session::is_recording));
    let record_blocked_by = move || {
        if replays.get() {
            Some(blocked())
        } else if alive.get() {
            status.with(full_recording_reason)
        } else {
            Some(no_recorder())
        }
    };
    let hint = move || {
        record_blocked_by().unwrap_or(if records.get() {
            tr!("The samples are kept until the next recording.")
        } else {
            tr!("Records every sample from now on. Otherwise only the last 10 minutes are stored.")
        })
    };
    let export = move |what, label, hint| {
        let blocked_by = move || {
            if replays.get() {
                return Some(blocked().to_owned());
            }
            let disabled_reason = recorder.export_blocked_by(what);
            let writes = recorder.per_mille(what).is_some();
            disabled_reason.or_else(|| status.with(nothing_to_export_reason).filter(|_| !writes))
        };
        view! {
            <ExportButton
                label
                hint
                per_mille=Signal::derive(move || page.recorder.per_mille(what))
                disabled_reason=Signal::derive(blocked_by)
                on_press=move || page.recorder.export_or_cancel(what)
            />
        }
    };
    panel(
        "panel place first recording",
        tr!("Recording"),
        move || page.place() == Place::Record,
        None,
        view! {
            <button
                type="button"
                class="button small record"
                class:records=dynamic(move || records.get())
                aria-label=dynamic(move || {
                    if records.get() { tr!("Stop recording") } else { tr!("Record telemetry") }
                })
                title=dynamic(hint)
                disabled=dynamic(move || record_blocked_by().is_some())
                on:click=handler(move |_| page.recorder.post(&ToRecorder::Record(!records.get_untracked())))
            >
                <span class="record-labels">
                    <span>{tr!("Record telemetry")}</span>
                    <span>{tr!("Stop recording")}</span>
                </span>
            </button>
            <output
                class="recording-words"
                aria-label=tr!("Recorded")
                aria-live="off"
                title=dynamic(move || says.with(|(what, much)| format!("{what}{much}")))
            >
                <span>{dynamic(move || says.with(|(what, _)| *what))}</span>
                <span>{dynamic(move || says.with(|(_, much)| much.clone()))}</span>
            </output>
            {export(
                Export::Telemetry,
                tr!("Export telemetry CSV"),
                tr!("One row per sample: the recording or, without one, the last 10 minutes"),
            )}
            {export(
                Export::Plot,
                tr!("Plot CSV"),
                tr!(
                    "For plotting: the same samples with elapsed seconds, and commanded beside measured values"
                ),
            )}
        },
    )
}

/// A full recording has to be exported before another one can start.
fn full_recording_reason(status: &RecordingStatus) -> Option<&'static str> {
    (status.full && !status.exported).then(|| tr!("The recording is full. Export it first."))
}

fn nothing_to_export_reason(status: &RecordingStatus) -> Option<String> {
    (status.recorded == 0 && status.rolling == 0)
        .then(|| tr!("No samples yet. Connect a motor.").to_owned())
}
