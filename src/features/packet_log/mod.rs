//! The packet log: the events of the line, to the millisecond.

pub(crate) mod actions;
pub(crate) mod feed;
pub(crate) mod filters;
pub(crate) mod list;
pub(crate) mod painter;
pub(crate) mod slot;
pub(crate) mod texts;
pub(crate) mod view;

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::recorder::Export;

use self::{filters::Filters, list::PacketList};
use crate::{
    features::packet_log::actions::Log,
    model::{recorder_texts::no_recorder, replay::blocked, snapshot::Session},
    ui::{
        button::PressButton,
        export_button::ExportButton,
        reactive::{dynamic, memo},
    },
};

/// Region `Packet log`.
#[component]
pub(crate) fn PacketLog(log: Log) -> impl IntoView {
    let recorder = log.page.recorder();
    let state = log.state;
    let lines = memo(move || state.with(texts::of_entries));
    let title = memo(move || state.with(texts::of_entries_at_length));
    let empty = memo(move || state.with(|state| state.kept == 0));
    let comma = move || lines.with(|(_, others)| if others.is_empty() { "" } else { ", " });
    let empty_reason = move || empty.get().then(|| tr!("No entries yet.").to_owned());
    let replays = memo(move || log.page.shown.with(Session::is_recording));
    let export_blocked_by = move || {
        if replays.get() {
            return Some(blocked().to_owned());
        }
        let disabled_reason = recorder.export_blocked_by(Export::Log);
        let writes = recorder.per_mille(Export::Log).is_some();
        disabled_reason.or_else(|| empty_reason().filter(|_| !writes))
    };
    let undoable = move || log.cleared_ms.get().is_some();
    let clear = Signal::derive(move || {
        if undoable() {
            tr!("Undo")
        } else {
            tr!("Clear")
        }
        .to_owned()
    });
    let clear_blocked_by = move || {
        if replays.get() {
            Some(blocked().to_owned())
        } else if recorder.alive.get() {
            empty_reason().filter(|_| !undoable())
        } else {
            Some(no_recorder().to_owned())
        }
    };
    view! {
        <section
            class="panel packet-log"
            // It stays when the port is closed.
            class:has-entries=dynamic(move || !empty.get() || log.cleared_ms.get().is_some())
            aria-label=tr!("Packet log")
        >
            <div class="packet-head">
                <h2>{tr!("Packet log")}</h2>
                <output
                    class="entries"
                    aria-label=tr!("Entries")
                    aria-live="off"
                    title=dynamic(move || title.get())
                >
                    <span>{dynamic(move || lines.with(|(entries, _)| entries.clone()))}</span>
                    <span class="comma">{dynamic(comma)}</span>
                    <span>{dynamic(move || lines.with(|(_, others)| others.clone()))}</span>
                </output>
                <PressButton
                    label=clear
                    class="button small packet-clear"
                    hint=tr!("Deletes all log entries. Undo restores them within 10 s.")
                    disabled_reason=Signal::derive(clear_blocked_by)
                    on_press=move || {
                        if log.cleared_ms.get_untracked().is_some() {
                            log.undo_clear();
                        } else {
                            log.clear();
                        }
                    }
                />
                <ExportButton
                    label=tr!("Export CSV")
                    hint=tr!("Exports all entries, including hidden ones")
                    per_mille=Signal::derive(move || log.page.recorder.per_mille(Export::Log))
                    disabled_reason=Signal::derive(export_blocked_by)
                    on_press=move || log.page.recorder.export_or_cancel(Export::Log)
                />
            </div>
            <Filters log />
            <PacketList log />
        </section>
    }
}
