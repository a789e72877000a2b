//! The whole page.

use std::time::Duration;

use leptos::prelude::*;
use motorlink_messages::ToWorker;

use crate::{
    components::{
        ControlPanel, Graph, Header, HelpDialog, LinkPanel, MotorStrip, Notices, PacketLog,
        QuestionDialog, Recording, SettingsPanel, StoppedDialog, Telemetry, TogetherPanel,
        WheelPanel, live::follow,
    },
    desk::{Desk, WorkerState},
    installation, keyboard, lifecycle,
    preferences::{Preferences, Theme},
    ticking, words,
    worker_link::WorkerLink,
};

/// How often it is looked whether the worker lives; a hidden page's timers may come less often.
const LOOK_AFTER_WORKER: Duration = Duration::from_secs(1);

/// The page: starts the worker and shows the desk.
#[component]
#[must_use]
pub fn App() -> impl IntoView {
    if let Some(frame) = document().get_element_by_id("starting") {
        frame.remove();
    }
    let desk = Desk::new(Preferences::load());
    provide_context(desk);
    follow(move || show_theme(desk.preferences.with(|chosen| chosen.theme)));

    // First of all, so that the keys and the end of the page reach the worker from its first moment.
    keyboard::listen(desk);
    lifecycle::watch(desk);
    start_worker(desk);
    ticking::keep_showing(desk);
    installation::watch(desk);

    let behind_dialog = move || desk.dialog.with(Option::is_some);
    view! {
        <Header behind_dialog=Signal::derive(behind_dialog) />
        <div class="above-desk" inert=behind_dialog>
            <MotorStrip />
            <LinkPanel />
            <TogetherPanel />
            <SettingsPanel />
        </div>
        <main class="desk" inert=behind_dialog>
            <ControlPanel />
            <WheelPanel />
            <Telemetry />
            <Notices />
            <PacketLog />
            <Graph />
            <Recording />
            <StoppedDialog />
        </main>
        <HelpDialog />
        <QuestionDialog />
    }
}

fn start_worker(desk: Desk) {
    let started = WorkerLink::spawn(
        move |message| desk.hear(message),
        move || desk.worker_lost(),
    );
    if let Ok(link) = started {
        desk.link.set_value(Some(link));
        let look = move || {
            desk.look_after_worker();
            desk.look_whether_to_advise();
        };
        let looking = set_interval_with_handle(look, LOOK_AFTER_WORKER);
        if let Ok(looking) = looking {
            on_cleanup(move || looking.clear());
        }
        desk.start_journal();
        if wants_virtual_motor() {
            desk.post(&ToWorker::ConnectVirtual);
        }
    } else {
        desk.worker.set(WorkerState::Dead);
        desk.start_journal();
        desk.say(words::of_dead_worker(false));
    }
}

/// `?port=virtual` in the address.
fn wants_virtual_motor() -> bool {
    let query = web_sys::window().and_then(|window| window.location().search().ok());
    let parameters = query.and_then(|query| web_sys::UrlSearchParams::new_with_str(&query).ok());
    parameters
        .and_then(|parameters| parameters.get("port"))
        .as_deref()
        == Some("virtual")
}

fn show_theme(theme: Theme) {
    if let Some(root) = document().document_element() {
        // The style sheet follows the system where no theme is named.
        let _ = match theme {
            Theme::System => root.remove_attribute("data-theme"),
            Theme::Light | Theme::Dark => root.set_attribute("data-theme", theme.key()),
        };
    }
}
