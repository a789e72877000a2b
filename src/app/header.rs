//! The header, which is always visible: connection and STOP.

use leptos::prelude::*;
use motorlink_i18n::{Language, tr};
use motorlink_messages::bus::StopReason;
use wasm_bindgen::JsCast;
use web_sys::HtmlElement;

use crate::{
    app::features::Features,
    features::{
        connect::view::{ConnectButtons, ConnectionState},
        link_doctor::quality::LinkQuality,
        motors::choice::{ModelChoice, MotorChoice},
        stop::button::StopButton,
    },
    model::{
        page::{Dialog, use_page},
        preferences::Theme,
    },
    ui::{
        media::prefers_dark,
        reactive::{dynamic, handler},
    },
};

/// The combobox of the language.
const LANGUAGE: &str = "language";

/// The desk.
const CONTROLS: &str = "control";

#[component]
pub(crate) fn Header(
    features: Features,
    /// Whether a dialog is open: then only STOP can be reached.
    behind_dialog: Signal<bool>,
) -> impl IntoView {
    let on_stop = Box::leak(Box::new(move || features.stop_all(StopReason::Operator)));
    view! {
        <header class="header">
            <div class="header-rest" inert=behind_dialog>
                <a class="skip" href="#control">{tr!("Skip to the controls")}</a>
                <div class="brand" inner_html=BRAND></div>
                <ConnectionState />
                <ConnectButtons connect=features.connect />
                <div class="header-facts">
                    <MotorChoice />
                    <ModelChoice />
                    <LinkQuality />
                </div>
                <div class="header-end">
                    <LanguageChoice features />
                    <ThemeButton />
                    <HelpButton />
                </div>
            </div>
            <StopButton on_stop />
        </header>
    }
}

/// A hub wheel with three bolts, and the name.
const BRAND: &str = r#"<svg class="logo" viewBox="0 0 24 24" width="26" height="26" aria-hidden="true"><circle cx="12" cy="12" r="10" fill="none" stroke="currentColor" stroke-width="2.6"/><circle cx="12" cy="12" r="2.4" fill="currentColor"/><circle cx="12" cy="6.6" r="1.5" fill="currentColor"/><circle cx="16.7" cy="14.7" r="1.5" fill="currentColor"/><circle cx="7.3" cy="14.7" r="1.5" fill="currentColor"/></svg><h1>MotorLink</h1>"#;

const GLOBE: &str = "M12 3a9 9 0 1 0 0 18 9 9 0 0 0 0-18zM3.5 9h17M3.5 15h17M12 3c5 5 5 13 0 18M12 3c-5 5-5 13 0 18";

/// An icon of a button, drawn by this path.
fn glyph(path: &str) -> String {
    format!(
        r#"<svg viewBox="0 0 24 24" width="18" height="18" aria-hidden="true"><path d="{path}" fill="none" stroke="currentColor" stroke-width="1.8" stroke-linecap="round" stroke-linejoin="round"/></svg>"#
    )
}

/// Combobox `Language`: it is invisible and covers a globe icon.
#[component]
fn LanguageChoice(features: Features) -> impl IntoView {
    let page = features.page;
    let spoken = page.language.get_untracked();
    let options: String = Language::ALL
        .map(|language| option(language, spoken))
        .concat();
    view! {
        <span class="button icon-button language">
            <span class="glyph" inner_html=glyph(GLOBE)></span>
            <select
                aria-label=tr!("Language")
                title=tr!("Language")
                id=LANGUAGE
                on:change=handler(move |event| {
                    if let Some(language) = Language::from_tag(&event_target_value(&event)) {
                        features.choose_language(language);
                        // The page is drawn again, and the focus returns to the list; but not while a wheel
                        // turns, because S and K would select from the list instead of stopping it.
                        let turns = page.latest.with_value(|session| session.active_motors().next().is_some());
                        let to = if turns { CONTROLS } else { LANGUAGE };
                        request_animation_frame(|| focus(to));
                    }
                })
                inner_html=options
            ></select>
        </span>
    }
}

fn option(language: Language, spoken: Language) -> String {
    let selected = if language == spoken { " selected" } else { "" };
    format!(
        r#"<option value="{}" lang="{}"{selected}>{}</option>"#,
        language.key(),
        language.tag(),
        language.name()
    )
}

fn focus(id: &str) {
    let element = document().get_element_by_id(id);
    if let Some(element) = element.and_then(|found| found.dyn_into::<HtmlElement>().ok()) {
        let _ = element.focus();
    }
}

#[component]
fn ThemeButton() -> impl IntoView {
    let page = use_page();
    let theme = move || page.preferences.with(|chosen| chosen.theme);
    let title = move || match theme() {
        Theme::Light => tr!("Light theme"),
        Theme::Dark => tr!("Dark theme"),
        Theme::Contrast => tr!("High contrast theme"),
        Theme::System => tr!("Theme of the system"),
    };
    // A sun, a moon, a half of each.
    let shape = move || match theme() {
        Theme::Light => {
            "M12 7a5 5 0 1 0 0 10 5 5 0 0 0 0-10zM12 1v3M12 20v3M1 12h3M20 12h3M4.2 4.2l2.1 2.1M17.7 17.7l2.1 2.1M4.2 19.8l2.1-2.1M17.7 6.3l2.1-2.1"
        }
        Theme::Dark => "M20 14.5A8.5 8.5 0 1 1 9.5 4a7 7 0 0 0 10.5 10.5z",
        Theme::Contrast => "M12 3a9 9 0 1 0 0 18 9 9 0 0 0 0-18zM12 3v18a9 9 0 0 0 0-18z",
        Theme::System => {
            "M12 3a9 9 0 1 0 0 18 9 9 0 0 0 0-18zM12 3v18M12 6.5h4.8M12 10h6.8M12 14h6.8M12 17.5h4.8"
        }
    };
    view! {
        <button
            type="button"
            class="button icon-button"
            aria-label=tr!("Theme")
            title=dynamic(title)
            on:click=handler(move |_| {
                page.prefer(|preferences| preferences.theme = preferences.theme.next(prefers_dark()));
            })
            inner_html=dynamic(move || glyph(shape()))
        ></button>
    }
}

#[component]
fn HelpButton() -> impl IntoView {
    let page = use_page();
    view! {
        <button
            type="button"
            class="button icon-button"
            aria-label=tr!("Help")
            aria-haspopup="dialog"
            title=tr!("Wiring, first spin, protocol, troubleshooting (?)")
            on:click=handler(move |_| page.dialog.set(Some(Dialog::Help(None))))
        >
            <span aria-hidden="true">"?"</span>
        </button>
    }
}
