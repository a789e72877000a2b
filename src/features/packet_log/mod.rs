//! The packet log: what was said on the line, to the millisecond.

pub(crate) mod feed;
pub(crate) mod filters;
pub(crate) mod list;
pub(crate) mod painter;
pub(crate) mod slot;
pub(crate) mod view;

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::recorder::Export;

use self::{filters::Filters, list::PacketList};
use crate::{
    features::recording::texts::{self as words, no_recorder},
    model::desk::use_desk,
    ui::{
        button::PressButton,
        export_button::ExportButton,
        reactive::{live, memo},
    },
};

/// Region `Packet log`.
#[component]
pub(crate) fn PacketLog() -> impl IntoView {
    let desk = use_desk();
    let log = desk.recorder.log;
    let lines = memo(move || log.with(words::of_entries));
    let title = memo(move || log.with(words::of_entries_at_length));
    let empty = memo(move || log.with(|log| log.kept == 0));
    let comma = move || lines.with(|(_, others)| if others.is_empty() { "" } else { ", " });
    let why_empty = move || {
        empty
            .get()
            .then(|| tr!("There are no entries yet.").to_owned())
    };
    let why_not_clear = move || {
        if desk.recorder.alive.get() {
            why_empty()
        } else {
            Some(no_recorder().to_owned())
        }
    };
    view! {
        <section class="panel packet-log" aria-label=tr!("Packet log")>
            <div class="packet-head">
                <h2>{tr!("Packet log")}</h2>
                <output
                    class="entries"
                    aria-label=tr!("Entries")
                    aria-live="off"
                    title=live(move || title.get())
                >
                    <span>{live(move || lines.with(|(entries, _)| entries.clone()))}</span>
                    <span class="comma">{live(comma)}</span>
                    <span>{live(move || lines.with(|(_, others)| others.clone()))}</span>
                </output>
                <PressButton
                    label=tr!("Clear")
                    class="button small"
                    hint=tr!("Forget every entry of the log")
                    why_not=Signal::derive(why_not_clear)
                    on_press=move || desk.ask_to_clear_log()
                />
                <ExportButton
                    what=Export::Log
                    label=tr!("Export CSV")
                    hint=tr!("Every entry that is kept, shown or not")
                    why_empty=Signal::derive(why_empty)
                />
            </div>
            <Filters />
            <PacketList />
        </section>
    }
}
