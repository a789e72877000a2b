//! The help dialog. Its text is one file per language in `public/help/`.

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
    features::help::{
        line_card::LineCard,
        texts as words,
        tour::{Shown, Tour},
    },
    model::{
        help_topic::HelpTopic,
        page::{Dialog, Page, use_page},
    },
    ui::{
        button::PressButton,
        focus::focus_when,
        listener::on_window,
        reactive::{dynamic, effect, handler, memo},
    },
};

/// The state of the help's content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Loaded {
    /// Not requested.
    Not,
    /// Loading.
    Loading,
    /// Loading failed.
    Failed,
    /// Shown, in this language.
    In(&'static str),
}

/// Dialog `Help`. STOP stays above it.
#[component]
pub(crate) fn HelpDialog(tour: RwSignal<Tour>) -> impl IntoView {
    let page = use_page();
    let dialog = NodeRef::<Div>::new();
    let article = NodeRef::<Div>::new();
    let loaded = RwSignal::new(Loaded::Not);
    let open = memo(move || matches!(page.dialog.get(), Some(Dialog::Help(_))));
    on_window("click", move |event| on_link_click(page, &event));
    focus_when(open, dialog);
    effect(move || {
        // Another place may be requested while it is open.
        page.dialog.track();
        if open.get() {
            load_or_show(page, article, loaded);
        } else if loaded.get_untracked() == Loaded::Failed {
            loaded.set(Loaded::Not);
        }
    });
    show_frames(page, open, loaded, article);
    let said = move || match loaded.get() {
        Loaded::Failed => words::not_loaded(),
        Loaded::Not | Loaded::Loading => words::loading(),
        Loaded::In(_) => "",
    };
    let of_model = move || {
        let model = page.model.get();
        tr!("For the {model}. Choose another under Model.", model)
    };
    let take_tour = move || {
        page.dialog.set(None);
        tour.set(Tour::new(Shown::Opened));
    };
    let pressed = move |event: MouseEvent| {
        if let Some(article) = article.get_untracked() {
            page::press(&article, &event);
        }
    };
    view! {
        <div class="scrim" hidden=dynamic(move || !open.get())>
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
                    <span class="quiet">{dynamic(of_model)}</span>
                    <PressButton label=tr!("Tour") hint=tr!("First spin, step by step") on_press=take_tour />
                    <PressButton label=tr!("Close") on_press=move || page.dialog.set(None) />
                </div>
                <div class="help-missing" hidden=dynamic(move || matches!(loaded.get(), Loaded::In(_)))>
                    <p role="status">{dynamic(said)}</p>
                    <button
                        type="button"
                        class="button"
                        hidden=dynamic(move || loaded.get() != Loaded::Failed)
                        on:click=handler(move |_| loaded.set(Loaded::Not))
                    >
                        {tr!("Retry")}
                    </button>
                </div>
                // The style sheet shows what is for this model.
                <div
                    class="help-page"
                    data-model=dynamic(move || page.model.get().spec().key)
                    node_ref=article
                    on:click=handler(pressed)
                ></div>
            </div>
        </div>
    }
}

/// Opens the help at the topic of a clicked element, in notices, the link doctor or the tour.
fn on_link_click(page: Page, event: &Event) {
    let target = event.target().and_then(|at| at.dyn_into::<Element>().ok());
    let link = target.and_then(|target| target.closest("[data-help]").ok().flatten());
    let topic = link.and_then(|link| HelpTopic::from_id(&link.get_attribute("data-help")?));
    if topic.is_some() {
        page.dialog.set(Some(Dialog::Help(topic)));
    }
}

/// Loads the content if it is missing, or shows the requested place.
fn load_or_show(page: Page, article: NodeRef<Div>, loaded: RwSignal<Loaded>) {
    let language = words::help_language();
    match loaded.get() {
        Loaded::In(there) if there == language => show_topic(page, article),
        // The user decides when to try again.
        Loaded::Loading | Loaded::Failed => {}
        Loaded::Not | Loaded::In(_) => {
            loaded.set(Loaded::Loading);
            spawn_local(async move {
                let html = page::load(language).await;
                let article = article.try_get_untracked().flatten();
                let now = match (html, article) {
                    (Some(html), Some(article)) => {
                        article.set_inner_html(&html);
                        let _ = article.set_attribute("lang", language);
                        Loaded::In(language)
                    }
                    _ => Loaded::Failed,
                };
                // The article may have been removed meanwhile.
                let _ = loaded.try_set(now);
            });
        }
    }
}

fn show_topic(page: Page, article: NodeRef<Div>) {
    // By then the dialog is open and has the focus.
    request_animation_frame(move || {
        if let Some(Dialog::Help(Some(topic))) = page.dialog.get_untracked()
            && let Some(article) = article.try_get_untracked().flatten()
        {
            page::show(&article, topic);
        }
    });
}

/// Shows the motor's real frames in the protocol card. They are recorded while the dialog is closed too, so that it
/// shows the latest frames when it opens.
fn show_frames(page: Page, open: Memo<bool>, loaded: RwSignal<Loaded>, article: NodeRef<Div>) {
    let mut card = LineCard::default();
    effect(move || {
        page.shown.track();
        let id = page.selected.get();
        page.latest.with_value(|session| card.update(session, id));
        if open.get()
            && matches!(loaded.get(), Loaded::In(_))
            && let Some(article) = article.get_untracked()
        {
            page::fill(&article, &card.frames());
        }
    });
}

#[cfg(test)]
mod files_tests;
