//! The page as a program of the browser's: kept for use without a network, installed, and advised to be.
//!
//! What only a browser's own promises and events know is in `boot/installed.js`; it tells of it
//! by one event on the window, and is called by its global functions.

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
        page::Page,
        preferences::{remember, remembered},
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
    /// It asks the person when it is told to.
    Offered,
    /// It has been done while the page was open.
    Done,
}

/// Under which name the browser remembers that the advice was given.
const ADVISED: &str = "install-advised";

/// What the page knows of it.
#[derive(Clone, Copy)]
pub(crate) struct Install {
    page: Page,
    pub(crate) state: RwSignal<Installation>,
    /// Whether a new version of the page waits to be taken.
    pub(crate) new_version: RwSignal<bool>,
    /// Whether it was taken: the page is still the old one, and its files are gone.
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

/// Has the page kept, and hears what the browser says of it, from now on.
pub(crate) fn watch(install: Install) {
    on_window("installation", move |event| {
        let detail = event
            .dyn_ref::<CustomEvent>()
            .and_then(|event| event.detail().as_string());
        on_event(install, detail.as_deref().unwrap_or_default());
    });
    // A page whose worker died needs its next version more than any other.
    let works = memo(move || install.page.worker.state.get() != WorkerState::Starting);
    effect(move || {
        // Only now: what is fetched to be kept must not hold up what is fetched to start.
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

/// Calls a function of the script, where there is one.
pub(crate) fn call(name: &str) {
    let function = Reflect::get(&js_sys::global(), &name.into()).ok();
    let function = function.and_then(|function| function.dyn_into::<Function>().ok());
    if let Some(function) = function {
        let _ = function.call0(&JsValue::UNDEFINED);
    }
}

impl Install {
    /// Has the browser ask the person whether the page is to be installed.
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

    /// Advises those who drive for long in a tab, once: a browser may discard a hidden tab, and never the
    /// window of an installed page. Called every second, or as often as a hidden page's timers come.
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
