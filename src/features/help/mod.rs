//! The help. Its text is a file for each language in `public/help/`; here is the dialog around it.

pub(crate) mod line_card;
pub(crate) mod page;
pub(crate) mod texts;
pub(crate) mod tour;
pub(crate) mod tour_texts;
pub(crate) mod tour_view;

use leptos::{html::Div, prelude::*, task::spawn_local};
use motorlink_i18n::tr;
use wasm_bindgen::JsCast;
use web_sys::{Element, Event, MouseEvent};

use crate::{
    features::help::{line_card::LineCard, texts as words},
    model::{
        desk::{Desk, Dialog, use_desk},
        help_topic::HelpTopic,
    },
    ui::{
        button::PressButton,
        focus::focus_when,
        listener::on_window,
        reactive::{follow, heard, live, memo},
    },
};

/// What there is of the help's page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Loaded {
    /// Nothing was asked for.
    Not,
    /// It is under way.
    Loading,
    /// It did not come.
    Failed,
    /// It stands in the dialog, in this language.
    In(&'static str),
}

/// Dialog `Help`. STOP stays above it.
#[component]
pub(crate) fn HelpDialog() -> impl IntoView {
    let desk = use_desk();
    let dialog = NodeRef::<Div>::new();
    let page = NodeRef::<Div>::new();
    let loaded = RwSignal::new(Loaded::Not);
    let open = memo(move || matches!(desk.dialog.get(), Some(Dialog::Help(_))));
    on_window("click", move |event| hear_link(desk, &event));
    focus_when(open, dialog);
    follow(move || {
        // Another place may be asked for while it is open.
        desk.dialog.track();
        if open.get() {
            load_or_show(desk, page, loaded);
        } else if loaded.get_untracked() == Loaded::Failed {
            loaded.set(Loaded::Not);
        }
    });
    show_frames(desk, open, loaded, page);
    let said = move || match loaded.get() {
        Loaded::Failed => words::not_loaded(),
        Loaded::Not | Loaded::Loading => words::loading(),
        Loaded::In(_) => "",
    };
    let take_tour = move || {
        desk.dialog.set(None);
        desk.start_tour();
    };
    let pressed = move |event: MouseEvent| {
        if let Some(page) = page.get_untracked() {
            page::press(&page, &event);
        }
    };
    view! {
        <div class="scrim" hidden=live(move || !open.get())>
            <div
                class="dialog help"
                role="dialog"
                aria-modal="true"
                aria-label=tr!("Help")
                tabindex="-1"
                node_ref=dialog
            >
                <div class="dialog-head">
                    <h2>{tr!("Help")}</h2>
                    <PressButton label=tr!("Tour") hint=tr!("First spin, step by step") on_press=take_tour />
                    <PressButton label=tr!("Close") on_press=move || desk.dialog.set(None) />
                </div>
                <div class="help-missing" hidden=live(move || matches!(loaded.get(), Loaded::In(_)))>
                    <p role="status">{live(said)}</p>
                    <button
                        type="button"
                        class="button"
                        hidden=live(move || loaded.get() != Loaded::Failed)
                        on:click=heard(move |_| loaded.set(Loaded::Not))
                    >
                        {tr!("Retry")}
                    </button>
                </div>
                <div class="help-page" node_ref=page on:click=heard(pressed)></div>
            </div>
        </div>
    }
}

/// Whatever carries a topic leads to it: notices, the link doctor, the tour.
fn hear_link(desk: Desk, event: &Event) {
    let target = event.target().and_then(|at| at.dyn_into::<Element>().ok());
    let link = target.and_then(|target| target.closest("[data-help]").ok().flatten());
    let topic = link.and_then(|link| HelpTopic::from_id(&link.get_attribute("data-help")?));
    if topic.is_some() {
        desk.dialog.set(Some(Dialog::Help(topic)));
    }
}

/// Once it is open: loads what is missing, or shows the place that was asked for.
fn load_or_show(desk: Desk, page: NodeRef<Div>, loaded: RwSignal<Loaded>) {
    let language = words::help_language();
    match loaded.get() {
        Loaded::In(there) if there == language => show_topic(desk, page),
        // The person says when it is tried again.
        Loaded::Loading | Loaded::Failed => {}
        Loaded::Not | Loaded::In(_) => {
            loaded.set(Loaded::Loading);
            spawn_local(async move {
                let html = page::load(language).await;
                let page = page.try_get_untracked().flatten();
                let now = match (html, page) {
                    (Some(html), Some(page)) => {
                        page.set_inner_html(&html);
                        let _ = page.set_attribute("lang", language);
                        Loaded::In(language)
                    }
                    _ => Loaded::Failed,
                };
                // The page may be gone by now.
                let _ = loaded.try_set(now);
            });
        }
    }
}

fn show_topic(desk: Desk, page: NodeRef<Div>) {
    // By then the dialog is shown and has taken the focus.
    request_animation_frame(move || {
        if let Some(Dialog::Help(Some(topic))) = desk.dialog.get_untracked()
            && let Some(page) = page.try_get_untracked().flatten()
        {
            page::show(&page, topic);
        }
    });
}

/// Has the protocol card show the motor's own frames. They are looked at while the dialog is closed too:
/// whoever opens it wants to see what passed just now.
fn show_frames(desk: Desk, open: Memo<bool>, loaded: RwSignal<Loaded>, page: NodeRef<Div>) {
    let mut card = LineCard::default();
    follow(move || {
        desk.shown.track();
        let id = desk.selected.get();
        desk.latest.with_value(|session| card.look(session, id));
        if open.get()
            && matches!(loaded.get(), Loaded::In(_))
            && let Some(page) = page.get_untracked()
        {
            page::fill(&page, &card.frames());
        }
    });
}
