//! Panel `ID Manager`.

use leptos::{html::Ul, prelude::*};
use motorlink_i18n::tr;
use motorlink_messages::bus::JobStatus;

use crate::{
    features::ids::{
        actions::Ids,
        found_motors::{found_motors, list_html, objection},
        state::IdManager,
    },
    model::{
        guards::{cancel_blocked_by, id_change_blocked_by, scan_blocked_by, stop_blocked_by},
        notice_board::{NoticeText, Tone},
        page::use_page,
        place::{Panel, Place},
        scan_texts::of_progress,
        tool_entry::{self, assignable},
    },
    ui::{
        button::PressButton,
        list::replace_keeping_focus,
        number_field::NumberField,
        panel::panel,
        reactive::{dynamic, effect, handler, memo},
    },
};

#[component]
pub(crate) fn IdManagerPanel(ids: Ids) -> impl IntoView {
    let page = ids.page;
    let new_id = ids.new_id;
    let blocked = page.of_motor(|session, _| scan_blocked_by(session));
    let cancel_blocked_by = page.of_motor(|session, _| cancel_blocked_by(session));
    let change_blocked_by = page.of_motor(|session, _| id_change_blocked_by(session));
    let objection = memo(move || {
        let to = assignable(new_id.get())?;
        page.shown.with(|session| objection(session, to))
    });
    let set_blocked_by = Signal::derive(move || {
        let missing = || {
            let nothing = assignable(new_id.get()).is_none();
            nothing.then(|| tr!("Enter the new ID.").to_owned())
        };
        let entered = || new_id.trouble().or_else(|| objection.get());
        change_blocked_by.get().or_else(entered).or_else(missing)
    });
    let offers_full_scan = memo(move || ids.manager.with(IdManager::offers_full_scan));
    let more = memo(move || ids.manager.with(IdManager::offers_more));
    let send_more = move || {
        let count = more.get().unwrap_or_default().count();
        tr!("Send {count} frames", count)
    };
    let hint = Signal::derive(move || {
        // What blocks a scan too is said elsewhere.
        let only_change = change_blocked_by
            .get()
            .filter(|_| blocked.with(Option::is_none));
        only_change.unwrap_or_else(|| match assignable(new_id.get()) {
            Some(to) => tr!("{decimal} = {hex}", decimal = to.id().get(), hex = to.id()),
            None => tr!("1 to 254, decimal or 0x hex").to_owned(),
        })
    });
    panel(
        "panel place first id-manager",
        tr!("ID Manager"),
        move || page.place() == Place::Setup,
        None,
        view! {
            <div class="button-row four" class:offers-full-scan=offers_full_scan>
                <PressButton
                    label=tr!("Scan")
                    hint=tr!("One query to all motors: enough for a single motor")
                    disabled_reason=blocked
                    on_press=move || ids.scan()
                />
                <PressButton
                    label=tr!("Full scan")
                    class="button full-scan"
                    hint=tr!("Queries all 254 addresses")
                    disabled_reason=blocked
                    on_press=move || ids.full_scan()
                />
                <PressButton
                    label=tr!("Cancel")
                    disabled_reason=cancel_blocked_by
                    on_press=move || ids.cancel_scan()
                />
                <PressButton
                    label=tr!("ID wizard")
                    hint=tr!("IDs, names and sides of a rover's wheels, one motor after the other")
                    on_press=move || page.open_in_setup(Panel::WheelSetup)
                />
            </div>
            <Progress />
            <ScanResult ids />
            <FoundList ids />
            <div class="new-id">
                <NumberField
                    id="new-id"
                    name=tr!("New ID")
                    hint=hint
                    target=new_id
                    entry=tool_entry::NEW_ID
                    objection=objection
                    on_edit=|| ()
                />
                <div class="new-id-acts">
                    <PressButton
                        label=tr!("Set ID")
                        class="button primary"
                        hint=tr!("Scans, then asks to confirm")
                        disabled_reason=set_blocked_by
                        on_press=move || ids.set_id()
                    />
                    <div hidden=dynamic(move || more.get().is_none())>
                        <PressButton
                            label=Signal::derive(send_more)
                            hint=tr!("Scans, then asks to confirm")
                            disabled_reason=change_blocked_by
                            on_press=move || {
                            ids.set_id_with_more();
                        }
                        />
                    </div>
                </div>
            </div>
        },
    )
}

/// Progressbar `Scan`; it keeps its place when no scan is running.
#[component]
fn Progress() -> impl IntoView {
    let page = use_page();
    let asked = page.of_motor(|session, _| match session.job {
        Some(JobStatus::Scanning { asked, .. }) => asked,
        _ => 0,
    });
    let words = page.of_motor(|session, _| of_progress(session.job.as_ref()));
    view! {
        <div
            class="scan-progress"
            role="progressbar"
            aria-label=tr!("Scan")
            aria-valuemin="0"
            aria-valuemax="254"
            aria-valuenow=dynamic(move || asked.get().to_string())
            aria-valuetext=words
        >
            <span
                class="scan-bar"
                style=("--asked", dynamic(move || asked.get().to_string()))
            ></span>
            <span class="quiet">{words}</span>
        </div>
    }
}

/// The result of the last scan or change, or what to do here.
#[component]
fn ScanResult(ids: Ids) -> impl IntoView {
    let page = ids.page;
    let unconnected = page.of_motor(|session, _| stop_blocked_by(session));
    let message = memo(move || ids.manager.with(IdManager::message));
    let of_message = move |read: fn(&NoticeText) -> String| dynamic(move || message.with(read));
    let title = move || {
        let message = || message.with(|message| message.title.clone());
        unconnected.get().unwrap_or_else(message)
    };
    view! {
        <div
            class=of_message(|message| {
                let tone = match message.tone {
                    Tone::Calm => "tool-words",
                    Tone::Warning => "tool-words warning",
                    Tone::Error => "tool-words error",
                };
                tone.to_owned()
            })
            role="status"
            aria-label=tr!("Scan result")
        >
            <p class="notice-title">{dynamic(title)}</p>
            <p class="notice-advice">{of_message(|message| message.advice.join(" "))}</p>
        </div>
    }
}

/// List `Motors found`.
#[component]
fn FoundList(ids: Ids) -> impl IntoView {
    let page = ids.page;
    let list = NodeRef::<Ul>::new();
    let html = memo(move || {
        let selected = page.selected.get();
        let motors = ids.manager.with(|ids| {
            page.shown
                .with(|session| found_motors(session, ids.found(), selected))
        });
        page.motors.names.with(|names| list_html(&motors, names))
    });
    effect(move || {
        if let Some(list) = list.get() {
            html.with(|html| replace_keeping_focus(&list, html, "value"));
        }
    });
    view! {
        <ul
            class="found-list"
            role="list"
            aria-label=tr!("Motors found")
            node_ref=list
            on:click=handler(move |event| page.click_in_list(&event))
        ></ul>
    }
}
