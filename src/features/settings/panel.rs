//! Panel `Settings`: limits, export and import of the setup, and deleting stored data.
//!
//! The checkboxes and buttons are HTML with two listeners on the window: a view would be many times as large.

use leptos::{prelude::*, task::spawn_local};
use motorlink_i18n::tr;
use wasm_bindgen::JsCast;
use web_sys::{Element, Event, HtmlInputElement};

use crate::{
    features::settings::actions::Settings,
    model::{
        place::{Panel, Place},
        tool_entry,
    },
    ui::{
        entry, format, listener::on_window, number_field::NumberField, panel::panel,
        reactive::effect,
    },
};

const KEEP_DRIVING: &str = "keep-driving";
const DETECT_MODEL: &str = "detect-model";
const EXPORT: &str = "export-setup";
const IMPORT: &str = "import-setup";
const LINK: &str = "setup-link";
const CHOOSER: &str = "setup-file";
const ERASE: &str = "erase-kept";
const INSTALL: &str = "install-page";
const SAID: &str = "setup-words";
const ERASED: &str = "erased-words";

fn limits_head() -> String {
    let head = tr!("Limits");
    let words = tr!(
        "MotorLink stops a motor above the speed or temperature limit, or after 0.5 s above the \
         current limit."
    );
    format!("<h3>{head}</h3><p>{words}</p>")
}

/// Checkbox `Detect the model`, buttons `Export setup`, `Import setup`, `Setup link`,
/// `Delete all data` and `Install`, the browser's own chooser of files that the second one opens, and below them the
/// statuses `Setup` and `Stored in this browser`.
fn model_and_files() -> String {
    [
        heading(tr!("Model")),
        checkbox(DETECT_MODEL, tr!("Detect the model")),
        paragraph(tr!(
            "While a port opens: takes the model that the motors answer as. A DDSM115 and a DDSM315 \
             answer alike: choose between them under Model."
        )),
        heading(tr!("Setup")),
        paragraph(tr!(
            "Saves motors, vehicle, model, limits and drive settings to a file for another browser. \
             Import replaces the settings of this browser."
        )),
        r#"<div class="button-row two">"#.to_owned(),
        button(EXPORT, tr!("Export setup")),
        button(IMPORT, tr!("Import setup")),
        button(LINK, tr!("Setup link")),
        format!(r#"</div><input type="file" accept=".json" id="{CHOOSER}" hidden>"#),
        status(SAID, tr!("Setup")),
        heading(tr!("Stored in this browser")),
        paragraph(tr!(
            "Sessions and settings stay in this browser. They leave it only in files and links that you share."
        )),
        button(ERASE, tr!("Delete all data")),
        status(ERASED, tr!("Stored in this browser")),
        heading(tr!("Installation")),
        paragraph(tr!(
            "The browser never discards the installed app while it is hidden. Offline use works \
             without installing."
        )),
        button(INSTALL, tr!("Install")),
    ]
    .concat()
}

fn heading(words: &str) -> String {
    format!("<h3>{words}</h3>")
}

fn paragraph(words: &str) -> String {
    format!("<p>{words}</p>")
}

fn checkbox(id: &str, label: &str) -> String {
    format!(r#"<label class="check"><input type="checkbox" id="{id}">{label}</label>"#)
}

fn button(id: &str, label: &str) -> String {
    format!(r#"<button type="button" class="button" id="{id}">{label}</button>"#)
}

/// The result of the action above it.
fn status(id: &str, name: &str) -> String {
    format!(r#"<p class="setup-words" role="status" aria-label="{name}" id="{id}"></p>"#)
}

/// The button `Install`, which another feature implements.
pub(crate) struct InstallButton {
    /// Why it cannot be pressed.
    pub(crate) disabled_reason: Box<dyn Fn() -> Option<&'static str>>,
    pub(crate) hint: &'static str,
    pub(crate) on_press: Box<dyn Fn()>,
}

/// Panel `Settings`.
#[component]
pub(crate) fn SettingsPanel(settings: Settings, install: &'static InstallButton) -> impl IntoView {
    let page = settings.page;
    let targets = page.settings;
    let limits = [
        (
            tr!("Speed limit"),
            "speed-limit",
            format::rpm(),
            targets.speed_limit,
            entry::SPEED_LIMIT,
            leaked(move || page.speed_max()),
        ),
        (
            tr!("Current limit"),
            "current-limit",
            "A",
            targets.current_limit,
            entry::CURRENT_LIMIT,
            leaked(move || page.current_max_ma()),
        ),
        (
            tr!("Temperature limit"),
            "temperature-limit",
            "°C",
            targets.temperature_limit,
            entry::TEMPERATURE_LIMIT,
            leaked(|| i32::MAX),
        ),
    ];
    attach_handlers(settings, install);
    panel(
        "panel place second",
        tr!("Settings"),
        move || page.place() == Place::Setup,
        None,
        view! {
            <div class="settings-panel">
                <div inner_html=limits_head()></div>
                {limits
                    .map(|(name, id, unit, target, entry, limit)| {
                        view! {
                            <NumberField name unit target entry limit id on_edit=move || page.set_limits() />
                        }
                    })}
                <h3>{tr!("Drive" as "place")}</h3>
                <NumberField
                    id="setup-ramp"
                    name=tr!("Ramp")
                    unit=tr!("rpm/s")
                    hint=tr!("0 = off. Never applied to stops.")
                    target=targets.ramp
                    entry=tool_entry::RAMP
                    on_edit=move || page.set_ramp()
                />
                <div inner_html=checkbox(KEEP_DRIVING, tr!("Keep driving while hidden"))></div>
                <div inner_html=model_and_files()></div>
            </div>
        },
    )
}

/// A range that follows the model. The panel is there as long as the page.
fn leaked(limit: impl Fn() -> i32 + Sync + 'static) -> &'static (dyn Fn() -> i32 + Sync) {
    Box::leak(Box::new(limit))
}

/// Attaches the handlers of the checkboxes and buttons.
fn attach_handlers(settings: Settings, install: &'static InstallButton) {
    let page = settings.page;
    for name in ["click", "change"] {
        on_window(name, move |event| on_event(settings, install, &event));
    }
    let disabled_reason = page.of_motor(move |session, _| settings.import_blocked_by(session));
    effect(move || {
        let reason = disabled_reason.get();
        show_reason(
            IMPORT,
            reason.as_deref(),
            tr!("From an exported setup file"),
        );
        let erases = tr!("Deletes all MotorLink sessions and settings stored in this browser");
        show_reason(ERASE, settings.erase_blocked_by(reason).as_deref(), erases);
    });
    effect(move || show_reason(INSTALL, (install.disabled_reason)(), install.hint));
    effect(move || say(ERASED, settings.erased.get()));
    effect(move || {
        page.preferences.with(|chosen| {
            show_checked(KEEP_DRIVING, chosen.keep_driving);
            show_checked(DETECT_MODEL, chosen.detect_model);
        });
    });
}

/// Disables a button for this reason, or enables it with this hint.
fn show_reason(id: &str, reason: Option<&str>, hint: &str) {
    let Some(button) = document().get_element_by_id(id) else {
        return;
    };
    let title = reason.unwrap_or(hint);
    if button.has_attribute("disabled") == reason.is_some()
        && button.get_attribute("title").as_deref() == Some(title)
    {
        // Even the same value again would make the browser check the style of the page.
        return;
    }
    // These fail only for invalid names.
    let _ = button.toggle_attribute_with_force("disabled", reason.is_some());
    let _ = button.set_attribute("title", title);
}

fn show_checked(id: &str, checked: bool) {
    if let Some(input) = input(id) {
        input.set_checked(checked);
    }
}

fn input(id: &str) -> Option<HtmlInputElement> {
    document().get_element_by_id(id)?.dyn_into().ok()
}

fn say(id: &str, words: &str) {
    if let Some(said) = document().get_element_by_id(id) {
        said.set_text_content(Some(words));
    }
}

fn on_event(settings: Settings, install: &InstallButton, event: &Event) {
    let page = settings.page;
    let target = event.target().and_then(|at| at.dyn_into::<Element>().ok());
    let id = target.map(|target| target.id()).unwrap_or_default();
    let asked = match (event.type_().as_str(), id.as_str()) {
        ("click", EXPORT) => Asked::ForFile,
        ("click", IMPORT) => Asked::ToChoose,
        ("click", ERASE) => Asked::ToErase,
        // At once: the browser opens its question only during the press.
        ("click", LINK) => return page.open_in_setup(Panel::SetupLink),
        ("click", INSTALL) => return (install.on_press)(),
        ("change", CHOOSER) => Asked::ToTakeIn,
        ("change", KEEP_DRIVING) => {
            return page.prefer(|chosen| chosen.keep_driving = event_target_checked(event));
        }
        ("change", DETECT_MODEL) => {
            return page.prefer(|chosen| chosen.detect_model = event_target_checked(event));
        }
        _ => return,
    };
    // In the next turn: the action clicks another element, and this listener must not be re-entered.
    spawn_local(answer(settings, asked));
}

enum Asked {
    ForFile,
    ToChoose,
    ToTakeIn,
    ToErase,
}

async fn answer(settings: Settings, asked: Asked) {
    match asked {
        Asked::ForFile => return settings.export_setup(),
        Asked::ToErase => return settings.ask_to_erase(),
        Asked::ToChoose | Asked::ToTakeIn => {}
    }
    let Some(chooser) = input(CHOOSER) else {
        return;
    };
    if matches!(asked, Asked::ToChoose) {
        chooser.click();
        return;
    }
    let file = chooser.files().and_then(|files| files.get(0));
    // Allows choosing the same file again after it was edited.
    chooser.set_value("");
    let Some(file) = file else { return };
    say(SAID, &settings.import_setup(&file).await);
}
