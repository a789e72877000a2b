//! The page as an installed program: offline use, installation, and the advice to install.
//!
//! `boot/installed.js` handles the browser's promises and events. It reports by one event on the window, and has
//! global functions.

pub(crate) mod long_drive;
pub(crate) mod new_version;
pub(crate) mod new_version_texts;
pub(crate) mod texts;

use js_sys::{Function, Reflect};
use leptos::prelude::*;
use wasm_bindgen::{JsCast, JsValue};
use web_sys::{CustomEvent, VisibilityState};

use crate::{
    features::install::{long_drive::LongDrive, texts as words},
    link::worker_link::WorkerState,
    model::{
        local_storage::{remember, remembered},
        page::Page,
    },
    ui::{
        clock::page_now_ms,
        listener::on_window,
        reactive::{effect, memo},
    },
};

/// Whether the page can be installed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Installation {
    /// The browser does not offer it.
    #[default]
    NotOffered,
    /// The browser asks the user on request.
    Offered,
    /// It was installed while the page was open.
    Done,
}

/// The storage key for "the advice was shown".
const ADVISED: &str = "install-advised";

/// The state of the installation.
#[derive(Clone, Copy)]
pub(crate) struct Install {
    page: Page,
    pub(crate) state: RwSignal<Installation>,
    /// Whether a new version of the page is available.
    pub(crate) new_version: RwSignal<bool>,
    /// Whether it was activated: the page is still the old one, and its files are gone.
    pub(crate) taken: RwSignal<bool>,
    driven: StoredValue<LongDrive>,
}

impl Install {
    pub(crate) fn new(page: Page) -> Self {
        Self {
            page,
            state: RwSignal::new(Installation::default()),
            new_version: RwSignal::new(false),
            taken: RwSignal::new(false),
            driven: StoredValue::new(LongDrive::default()),
        }
    }
}

/// Registers the service worker, and listens to its reports.
pub(crate) fn watch(install: Install) {
    on_window("installation", move |event| {
        let detail = event
            .dyn_ref::<CustomEvent>()
            .and_then(|event| event.detail().as_string());
        on_event(install, detail.as_deref().unwrap_or_default());
    });
    // A page whose worker failed needs the new version most.
    let works = memo(move || install.page.worker.state.get() != WorkerState::Starting);
    effect(move || {
        // Only now: fetching files for offline use must not delay the start.
        if works.get() {
            call("keepOffline");
        }
    });
    install.watch_versions();
    install.reload_when_taken();
}

fn on_event(install: Install, detail: &str) {
    match detail {
        "new-version" => install.new_version.set(true),
        "taken" => install.taken.set(true),
        "others" => install.refuse_new_version_beside_others(),
        "installable" => install.state.set(Installation::Offered),
        "installed" => install.state.set(Installation::Done),
        "not-installable" => install.state.set(Installation::NotOffered),
        _ => {}
    }
}

/// Calls a function of the script, if it exists.
pub(crate) fn call(name: &str) {
    let function = Reflect::get(&js_sys::global(), &name.into()).ok();
    let function = function.and_then(|function| function.dyn_into::<Function>().ok());
    if let Some(function) = function {
        let _ = function.call0(&JsValue::UNDEFINED);
    }
}

impl Install {
    /// Opens the browser's question to install the page.
    pub(crate) fn install(self) {
        self.page
            .notices
            .update(|board| board.withdraw(crate::model::notice_board::Topic::Installing));
        call("installPage");
    }

    /// Why it cannot be installed now.
    pub(crate) fn install_blocked_by(self) -> Option<&'static str> {
        match self.state.get() {
            Installation::Offered => None,
            Installation::Done => Some(words::installed()),
            Installation::NotOffered if is_own_window() => Some(words::installed()),
            Installation::NotOffered => Some(words::not_offered()),
        }
    }

    /// Shows the advice once after long driving in a tab: a browser may discard a hidden tab, but not the window of an
    /// installed page. Called every second, or as often as a hidden page's timers run.
    pub(crate) fn advise_if_long(self) {
        let drives = self
            .page
            .latest
            .with_value(|session| session.active_motors().next().is_some());
        let hidden = document().visibility_state() == VisibilityState::Hidden;
        let long = self
            .driven
            .try_update_value(|driven| driven.update(page_now_ms(), drives, hidden));
        if long == Some(true)
            && self.state.get_untracked() == Installation::Offered
            && remembered(ADVISED).is_none()
        {
            remember(ADVISED, "yes");
            self.page
                .notices
                .update(|board| board.post(words::advice()));
        }
    }
}

/// Whether this is the window of an installed page.
fn is_own_window() -> bool {
    let query = web_sys::window().and_then(|window| {
        let query = window.match_media("(display-mode: standalone)");
        query.ok().flatten()
    });
    query.is_some_and(|query| query.matches())
}
