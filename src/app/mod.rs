//! The start of the page.

pub(crate) mod header;
pub(crate) mod keyboard;
pub(crate) mod keys;
pub(crate) mod language;
pub(crate) mod lifecycle;
pub(crate) mod mounting;
pub(crate) mod question_dialog;
pub(crate) mod questions;
pub(crate) mod refresh;
pub(crate) mod routing;

use std::time::Duration;

use leptos::{mount::mount_to_body, prelude::*};

use crate::{
    app::{
        language::{first_known, speak_from_now_on},
        mounting::{assembled, in_the_next_turn},
        refresh as ticking,
    },
    features::{graph::provide_graph, install as installation},
    link::worker_link::WorkerLink,
    model::{
        desk::{Desk, WorkerState},
        notice_texts as words,
        preferences::{Preferences, Theme, remembered},
    },
    ui::reactive::follow,
};

/// How often it is looked whether the worker lives; a hidden page's timers may come less often.
const LOOK_AFTER_WORKER: Duration = Duration::from_secs(1);

/// Shows the page.
pub fn start() {
    in_the_next_turn(|| mount_to_body(App));
}

/// The page: starts the worker and shows the desk.
#[component]
#[must_use]
pub fn App() -> impl IntoView {
    speak_from_now_on(first_known(wanted_languages().iter().map(String::as_str)));
    let desk = Desk::new(Preferences::load());
    provide_context(desk);
    provide_graph(desk);
    if wants_virtual_motor() {
        desk.connect_virtual();
    }
    follow(move || show_theme(desk.preferences.with(|chosen| chosen.theme)));

    // First of all: a stop that is asked for before there is a worker stands once there is one.
    keyboard::listen(desk);
    lifecycle::watch(desk);
    // The workers start last: on two cores they would take half of the time in which the page comes.
    let complete = RwSignal::new(false);
    follow(move || {
        if complete.get() {
            untrack(move || start_worker(desk));
        }
    });
    ticking::keep_showing(desk);
    installation::watch(desk);

    assembled(desk, complete)
}

/// What the address, the memory and the browser name, in this order.
fn wanted_languages() -> Vec<String> {
    let mut wanted: Vec<String> = parameter("lang").into_iter().collect();
    wanted.extend(remembered(language::STORED_AS));
    if let Some(window) = web_sys::window() {
        let browsers = window.navigator().languages();
        wanted.extend(browsers.iter().filter_map(|tag| tag.as_string()));
    }
    wanted
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
        desk.start_recorder();
        desk.stop_if_asked_early();
        desk.connect_if_asked_early();
    } else {
        desk.worker.set(WorkerState::Dead);
        desk.start_recorder();
        desk.say(words::of_dead_worker(false));
    }
}

/// `?port=virtual` in the address.
fn wants_virtual_motor() -> bool {
    parameter("port").as_deref() == Some("virtual")
}

fn parameter(name: &str) -> Option<String> {
    let query = web_sys::window()?.location().search().ok()?;
    web_sys::UrlSearchParams::new_with_str(&query)
        .ok()?
        .get(name)
}

fn show_theme(theme: Theme) {
    if let Some(root) = document().document_element() {
        // The style sheet follows the system where no theme is named.
        let _ = match theme {
            Theme::System => root.remove_attribute("data-theme"),
            Theme::Light | Theme::Dark | Theme::Contrast => {
                root.set_attribute("data-theme", theme.key())
            }
        };
    }
}
