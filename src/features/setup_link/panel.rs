//! Panel `Setup link`: the present setup as a link, and the question about the setup of a link that was opened.

use js_sys::{Function, Reflect};
use leptos::{prelude::*, task::spawn_local};
use motorlink_i18n::tr;
use motorlink_messages::experiments::vehicle::Geometry;
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;

use crate::{
    features::setup_link::{
        address::{IN_ADDRESS, part},
        changes::changes,
        encoding::{LinkError, from_link, to_link},
        view::View,
    },
    model::{
        graph_view::GraphView, guards::import_blocked_by, page::Page, setup::Setup, setup_texts,
        vehicle::geometry_of_page,
    },
    ui::{button::PressButton, listener::on_window, reactive::dynamic},
};

/// The graph, as far as a link has it.
pub(crate) struct LinkedGraph {
    /// What it shows.
    pub(crate) shown: Box<dyn Fn() -> GraphView>,
    /// Shows something else.
    pub(crate) show: Box<dyn Fn(&GraphView)>,
}

/// The state of the panel. It stays through a change of language.
#[derive(Clone, Copy)]
pub(crate) struct SetupLink {
    page: Page,
    geometry: RwSignal<Geometry>,
    graph: StoredValue<LinkedGraph, LocalStorage>,
    /// The setup of the link that was opened, as a file, until the user has answered; else nothing. It is text: a signal
    /// of another type is code of its own.
    linked: RwSignal<String>,
    said: RwSignal<String>,
}

impl SetupLink {
    /// Of this page: made at the first call, for the owner of the page.
    pub(crate) fn of_page(owner: &Owner, page: Page, graph: impl FnOnce() -> LinkedGraph) -> Self {
        owner.with(|| {
            use_context().unwrap_or_else(|| {
                let new = Self {
                    page,
                    geometry: geometry_of_page(owner, page),
                    graph: StoredValue::new_local(graph()),
                    linked: RwSignal::new(String::new()),
                    said: RwSignal::new(String::new()),
                };
                provide_context(new);
                new
            })
        })
    }

    /// Takes the setup out of the address, now and whenever the address changes.
    fn listen(self) {
        self.take();
        on_window("hashchange", move |_| self.take());
    }

    fn take(self) {
        let fragment = part("hash");
        if let Some(text) = fragment.strip_prefix(IN_ADDRESS) {
            // Another setup must not take the place of the one that is being read.
            if self.linked.with_untracked(|linked| !linked.is_empty()) {
                remove_fragment();
                let words = tr!(
                    "New link ignored. Apply or discard the current one first, then open it again."
                );
                return self.said.set(words.to_owned());
            }
            // A reload must not ask again, and no copy of the address may have a setup that is not the present one.
            remove_fragment();
            let (setup, view) = text.split_once('&').unwrap_or((text, ""));
            self.show(&View::from_link(view));
            let said = self.offer(setup);
            let said = said.unwrap_or_else(|error| setup_texts::of_refusal(&error.to_string()));
            self.said.set(said);
        }
    }

    /// Shows what the sender saw. It changes no setting. While anything is driven, motor and tab stay: the person at the
    /// wheel needs their controls where they are.
    fn show(self, view: &View) {
        if !self.page.is_anything_driven() {
            if let Some(id) = view.motor {
                self.page.select(id);
            }
            let model = self.page.model.get_untracked();
            if let Some(tab) = view.tab.filter(|mode| model.has(*mode)) {
                self.page.loops.tab.set(tab);
            }
        }
        if let Some(graph) = &view.graph {
            self.graph.with_value(|linked| (linked.show)(graph));
        }
    }

    /// What the page shows now.
    fn view(self) -> View {
        View {
            motor: Some(self.page.selected.get()),
            tab: Some(self.page.loops.tab.get()),
            graph: Some(self.graph.with_value(|linked| (linked.shown)())),
        }
    }

    /// Shows the question, unless there is nothing to ask. Returns what the page says.
    fn offer(self, text: &str) -> Result<String, LinkError> {
        self.linked.set(String::new());
        let setup = from_link(text)?;
        if changes(&self.page.setup(), &setup).is_empty() {
            return Ok(tr!("The link has the present setup. Nothing was changed.").to_owned());
        }
        self.linked.set(setup.to_json());
        Ok(String::new())
    }

    /// The lines of the question.
    fn changes(self) -> Vec<String> {
        self.track_setup();
        let setup = self.linked.with(|file| Setup::from_json(file.as_bytes()));
        let lines = setup.map(|setup| changes(&self.page.setup(), &setup));
        lines.unwrap_or_default()
    }

    /// Applies the setup, as an import does.
    fn apply(self) {
        // A setup that is refused now can be applied later.
        let refused = self.page.import_refusal();
        let setup = self
            .linked
            .with_untracked(|file| Setup::from_json(file.as_bytes()));
        if refused.is_none() {
            self.linked.set(String::new());
        }
        self.said.set(self.page.import_setup(setup));
    }

    fn discard(self) {
        self.linked.set(String::new());
        self.said.set(tr!("Nothing was changed.").to_owned());
    }

    /// A link to this page with the present setup and view.
    fn link(self) -> String {
        self.track_setup();
        let setup = to_link(&self.page.setup());
        part("origin") + &part("pathname") + IN_ADDRESS + &setup + &self.view().to_link()
    }

    /// The setup itself is read without signals.
    fn track_setup(self) {
        self.page.preferences.track();
        self.page.motors.names.track();
        self.geometry.track();
        let targets = self.page.settings;
        for target in [
            targets.rate,
            targets.ramp,
            targets.speed_limit,
            targets.current_limit,
            targets.temperature_limit,
        ] {
            target.get();
        }
    }

    fn copy(self) {
        let link = untrack(|| self.link());
        spawn_local(async move {
            // Over plain HTTP there is no clipboard.
            let is_copied = window().is_secure_context()
                && JsFuture::from(window().navigator().clipboard().write_text(&link))
                    .await
                    .is_ok();
            let said = if is_copied {
                tr!("Link copied. The page that opens it asks before it changes anything.")
            } else {
                tr!("The browser does not allow this. Select the link and copy it.")
            };
            let _ = self.said.try_set(said.to_owned());
        });
    }
}

/// The panel without its frame.
#[component]
pub(crate) fn SetupLinkPanel(of: SetupLink) -> impl IntoView {
    of.listen();
    let page = of.page;
    let blocked_by = move || {
        let pad_is_held = page.motors.steered.get();
        page.shown
            .with(|session| import_blocked_by(session, pad_is_held))
    };
    view! {
        <div class="settings-panel">
            <div
                role="group"
                aria-label=tr!("Setup from a link")
                hidden=dynamic(move || of.linked.with(String::is_empty))
            >
                <h3>{tr!("Setup from a link")}</h3>
                <p>{tr!("Applying it changes the following. No motor starts.")}</p>
                <ul class="setup-changes">
                    {move || {
                        let lines = of.changes().into_iter();
                        lines.map(|line| view! { <li>{line}</li> }).collect_view()
                    }}
                </ul>
                <div class="button-row two">
                    <PressButton
                        label=tr!("Apply setup")
                        disabled_reason=Signal::derive(blocked_by)
                        on_press=move || of.apply()
                    />
                    <PressButton label=tr!("Discard") on_press=move || of.discard() />
                </div>
            </div>
            <p class="setup-words" role="status" aria-label=tr!("Setup link")>
                {dynamic(move || of.said.get())}
            </p>
            <h3>{tr!("Link with this setup")}</h3>
            <p>
                {tr!(
                    "It has names, sides, groups, measures, model, ramp, rate and limits, and what the page shows now: motor, tab and graph. They are in a part of the address that is sent to no server."
                )}
            </p>
            <input
                type="text"
                class="setup-address"
                readonly=true
                aria-label=tr!("Link")
                prop:value=dynamic(move || of.link())
            />
            <PressButton label=tr!("Copy link") on_press=move || of.copy() />
        </div>
    }
}

/// Removes the fragment from the address, without another entry in the history.
fn remove_fragment() {
    let address = part("pathname") + &part("search");
    let replace = || {
        let history = Reflect::get(&window(), &"history".into())?;
        let replace: Function = Reflect::get(&history, &"replaceState".into())?.dyn_into()?;
        replace.call3(&history, &JsValue::NULL, &"".into(), &address.into())
    };
    // It fails for addresses of other pages only.
    let _ = replace();
}
