//! The help's content: fetched on request, because few visits need it.

use leptos::task::spawn_local;
use wasm_bindgen::JsCast;
use wasm_bindgen_futures::JsFuture;
use web_sys::{Element, HtmlElement};

use crate::{features::help::line_card, link::files::text_of, model::help_topic::HelpTopic};

/// The placeholder of the drawing that all languages share.
const DRAWING: &str = "<!-- wiring.svg -->";

/// The class of a real frame.
const LIVE: &str = "frame live";

/// The help in this language; `None` if a file or the network is missing.
pub(crate) async fn load(language: &str) -> Option<String> {
    // Relative to the page.
    let page = text_of(&format!("help/{language}.html")).await?;
    // Some hosts send their own page for a missing file.
    if !page.contains(DRAWING) {
        return None;
    }
    let drawing = text_of("help/wiring.svg").await?;
    Some(page.replace(DRAWING, &drawing))
}

/// Shows this place and moves the focus there, for screen readers.
pub(crate) fn show(page: &Element, topic: HelpTopic) {
    let place = page.query_selector(&format!("#{}", topic.id()));
    if let Some(place) = place.ok().flatten()
        && let Some(place) = place.dyn_ref::<HtmlElement>()
    {
        place.scroll_into_view();
        let _ = place.focus();
    }
}

/// Handles a click: goes to a place, or copies a command.
pub(crate) fn press(page: &Element, event: &web_sys::Event) {
    let target = event.target().and_then(|at| at.dyn_into::<Element>().ok());
    let Some(target) = target else { return };
    let closest = |selector| target.closest(selector).ok().flatten();
    if let Some(link) = closest("a") {
        // The address of the page does not change.
        event.prevent_default();
        let id = link.get_attribute("href").unwrap_or_default();
        if let Some(topic) = HelpTopic::from_id(id.trim_start_matches('#')) {
            show(page, topic);
        }
    } else if let Some(button) = closest("[data-copy]") {
        copy(button);
    }
}

/// Copies the command before this button, and shows the button's text for "copied".
fn copy(button: Element) {
    let Some(window) = web_sys::window() else {
        return;
    };
    let Some(command) = button.previous_element_sibling() else {
        return;
    };
    if window.is_secure_context() {
        let text = command.text_content().unwrap_or_default();
        let copied = JsFuture::from(window.navigator().clipboard().write_text(&text));
        spawn_local(async move {
            // If the browser refuses, the user can still copy the text by hand.
            if copied.await.is_ok() {
                let said = button.get_attribute("data-copy");
                button.set_text_content(said.as_deref());
            }
        });
    } else if let Ok(Some(selection)) = window.get_selection() {
        let _ = selection.select_all_children(&command);
    }
}

/// Replaces the examples by real frames.
pub(crate) fn fill(page: &Element, frames: &[Option<(String, String)>]) {
    for (kind, seen) in line_card::KINDS.iter().zip(frames) {
        let find = |what: &str| page.query_selector(&format!("[data-{what}={kind}]"));
        let (Some((frame, words)), Ok(Some(code)), Ok(Some(says))) =
            (seen, find("live"), find("says"))
        else {
            continue;
        };
        let Some(example) = code.parent_element() else {
            continue;
        };
        // A real frame may equal the example.
        if code.text_content().as_ref() != Some(frame) || example.class_name() != LIVE {
            code.set_text_content(Some(frame));
            says.set_text_content(Some(words));
            example.set_class_name(LIVE);
        }
    }
}
