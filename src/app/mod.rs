//! The start of the page.

pub(crate) mod absent;
pub(crate) mod actions;
pub(crate) mod features;
pub(crate) mod focus;
pub(crate) mod frame;
pub(crate) mod header;
pub(crate) mod keyboard;
pub(crate) mod language;
pub(crate) mod later_panel;
mod lifecycle;
pub(crate) mod mount;
pub(crate) mod mounting;
pub(crate) mod parts;
pub(crate) mod question_dialog;
pub(crate) mod questions;
pub(crate) mod rail;
pub(crate) mod recorder_routing;
pub(crate) mod refresh;
pub(crate) mod replay;
mod rescue;
pub(crate) mod routing;
pub(crate) mod sections;

use std::time::Duration;

use leptos::{mount::mount_to_body, prelude::*};
use motorlink_i18n::has;

use crate::{
    app::{
        features::Features,
        language::use_language,
        mounting::{assembled, in_the_next_turn},
    },
    features::install,
    link::worker_link::{WorkerLink, WorkerState},
    model::{
        dock,
        notice_texts::of_dead_worker,
        preferences::{Preferences, Theme},
    },
    ui::reactive::effect,
};

/// How often the page checks that the worker runs; browsers slow down the timers of a hidden page.
const CHECK_WORKER_EVERY: Duration = Duration::from_millis(333);

/// Shows the page in the preferred language.
pub fn start() {
    let wanted = language::preferred();
    if has(wanted) {
        in_the_next_turn(|| mount_to_body(App));
    } else {
        // Leptos itself starts with the page.
        wasm_bindgen_futures::spawn_local(async move {
            // If its file is missing, the page is in English.
            let _ = language::fetch(wanted).await;
            mount_to_body(App);
        });
    }
}

/// The page: starts the worker and mounts the sections.
#[component]
#[must_use]
pub fn App() -> impl IntoView {
    use_language(
        Some(language::preferred())
            .filter(|it| has(*it))
            .unwrap_or_default(),
    );
    let features = Features::new(Preferences::load());
    let page = features.page;
    provide_context(page);
    features.connect.connect_as_addressed();
    effect(move || show_theme(page.preferences.with(|chosen| chosen.theme)));
    dock::show_remembered();

    // First of all: a stop that is pressed before the worker runs takes effect once it runs.
    keyboard::listen(features);
    lifecycle::watch(features);
    // The workers start last: on two cores they would take half of the loading time.
    let complete = RwSignal::new(false);
    effect(move || {
        if complete.get() {
            untrack(move || start_worker(features));
        }
    });
    refresh::refresh_while_visible(page);
    install::watch(features.install);

    assembled(features, complete)
}

fn start_worker(features: Features) {
    let page = features.page;
    let started = WorkerLink::spawn(
        move |message| features.on_message(message),
        move || features.worker_lost(),
    );
    if let Ok(link) = started {
        page.worker.link.set_value(Some(link));
        let check = move || {
            features.check_worker();
            features.install.advise_if_long();
        };
        let checking = set_interval_with_handle(check, CHECK_WORKER_EVERY);
        if let Ok(checking) = checking {
            on_cleanup(move || checking.clear());
        }
        features.start_recorder();
        features.stop_if_asked_early();
        features.connect.connect_if_asked_early();
    } else {
        page.worker.state.set(WorkerState::Dead);
        features.start_recorder();
        page.notify(&|| of_dead_worker(false));
    }
}

fn show_theme(theme: Theme) {
    if let Some(root) = document().document_element() {
        // Without a theme, the style sheet follows the system.
        let _ = match theme {
            Theme::System => root.remove_attribute("data-theme"),
            Theme::Light | Theme::Dark | Theme::Contrast => {
                root.set_attribute("data-theme", theme.key())
            }
        };
    }
}
