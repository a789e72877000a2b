//! The left side of the tab Sequence: template, name, limits and files.

use leptos::{html::Input, prelude::*};
use motorlink_i18n::tr;
use motorlink_messages::experiments::sequence::Template;
use wasm_bindgen::JsCast;
use web_sys::{Event, HtmlInputElement};

use crate::{
    features::experiments::{state::Experiments, table, texts},
    model::snapshot::Session,
    ui::{
        button::PressButton,
        format,
        reactive::{dynamic, handler},
    },
};

/// Name, template, limits and files.
#[component]
pub(super) fn SequenceFields(of: Experiments) -> impl IntoView {
    let limits = [
        (tr!("Speed limit of the run"), format::rpm()),
        (tr!("Current limit of the run"), "A"),
        (tr!("Temperature limit of the run"), "°C"),
    ];
    let limits = limits.into_iter().enumerate();
    view! {
        {template_choice(of)}
        <label class="ask-field">
            <span class="field-name">{tr!("Name of the sequence")}</span>
            <input
                type="text"
                maxlength="64"
                autocomplete="off"
                prop:value=dynamic(move || of.draft.with(|draft| draft.name.clone()))
                on:input=handler(move |event| {
                    let name = event_target_value(&event);
                    of.draft.update(|draft| draft.name = name);
                })
            />
        </label>
        <div class="ask-pairs">
            {limits.map(|limit| limit_field(of, limit)).collect_view()}
        </div>
        {file_buttons(of)}
    }
}

/// The choice of a template, which replaces the table.
fn template_choice(of: Experiments) -> impl IntoView {
    let templates = Template::ALL.iter().enumerate().map(|(place, template)| {
        view! { <option value=place.to_string()>{texts::template(*template)}</option> }
    });
    let choose = move |event: Event| {
        let place = event_target_value(&event).parse::<usize>().ok();
        if let Some(template) = place.and_then(|place| Template::ALL.get(place)) {
            let sequence = texts::of_template(*template);
            of.load(&sequence);
        }
    };
    view! {
        <label class="ask-field">
            <span class="field-name">{tr!("Template")}</span>
            <select on:change=handler(choose)>
                <option value="">{tr!("Choose a template")}</option>
                {templates.collect_view()}
            </select>
        </label>
    }
}

/// The field of a limit.
fn limit_field(
    of: Experiments,
    (place, (label, unit)): (usize, (&'static str, &'static str)),
) -> impl IntoView {
    let text = move || {
        of.draft
            .with(|draft| draft.limits.get(place).cloned().unwrap_or_default())
    };
    let typed = move |event| {
        let text = event_target_value(&event);
        of.draft.update(|draft| {
            if let Some(limit) = draft.limits.get_mut(place) {
                *limit = text;
            }
        });
    };
    let field = ["limits.rpm", "limits.amps", "limits.celsius"];
    let objection = move || {
        of.checked.with(|checked| match checked {
            Some(Err(error)) if field.get(place) == Some(&error.place.as_str()) => {
                texts::problem(&error.problem)
            }
            _ => String::new(),
        })
    };
    view! {
        <label class="ask-field" class:wrong=dynamic(move || !objection().is_empty())>
            <span class="field-name">{label}</span>
            <span class="number">
                <input
                    type="text"
                    autocomplete="off"
                    placeholder=tr!("none")
                    prop:value=dynamic(text)
                    on:input=handler(typed)
                />
                <span class="number-unit" aria-hidden="true">{unit}</span>
            </span>
            <span class="ask-words" aria-live="polite">{dynamic(objection)}</span>
        </label>
    }
}

/// The buttons `Open sequence` and `Save sequence`.
fn file_buttons(of: Experiments) -> impl IntoView {
    let chooser = NodeRef::<Input>::new();
    let chosen = move |event: Event| {
        let input = event
            .target()
            .and_then(|at| at.dyn_into::<HtmlInputElement>().ok());
        let Some(input) = input else { return };
        if let Some(file) = input.files().and_then(|files| files.get(0)) {
            of.open_file(file);
        }
        // Choosing the same file again is a change too.
        input.set_value("");
    };
    let open_blocked_by = move || {
        let drives = of.page.shown.with(Session::is_anything_driven);
        drives.then(|| {
            tr!("Stop the motors first: the browser's dialog would cover STOP.").to_owned()
        })
    };
    let save_blocked_by = move || {
        of.draft.with(|draft| {
            let error = draft.sequence().err()?;
            let row = table::find(&draft.rows, &error.place);
            Some(texts::refused(&error, row.map(|(row, _)| row)))
        })
    };
    let undo_blocked_by = move || {
        let none = of.before.with(Vec::is_empty);
        none.then(|| tr!("Nothing has been changed.").to_owned())
    };
    view! {
        <div class="run-buttons">
            <PressButton
                label=tr!("Open sequence")
                class="button small"
                hint=tr!("A sequence (.json), or setpoints by time (.csv)")
                disabled_reason=Signal::derive(open_blocked_by)
                on_press=move || {
                    if let Some(chooser) = chooser.get_untracked() {
                        chooser.click();
                    }
                }
            />
            <PressButton
                label=tr!("Save sequence")
                class="button small"
                disabled_reason=Signal::derive(save_blocked_by)
                on_press=move || of.save()
            />
            <PressButton
                label=tr!("Undo" as "table")
                class="button small"
                hint=tr!("Brings back the table before the last template, file or removal.")
                disabled_reason=Signal::derive(undo_blocked_by)
                on_press=move || of.undo()
            />
            <input
                type="file"
                accept=".json,.csv,.tsv,.txt"
                hidden=true
                node_ref=chooser
                on:change=handler(chosen)
            />
        </div>
    }
}
