//! A spinbutton that keeps what was typed, good or not, and says what is wrong with it.

use leptos::prelude::*;
use web_sys::KeyboardEvent;

use crate::ui::{
    entry::Entry,
    reactive::{dynamic, handler, memo},
    target::Target,
};

/// A labelled spinbutton. A text field by nature: a number field of the browser turns with the
/// mouse wheel, loses what it cannot read, and shows no plus.
#[component]
pub(crate) fn NumberField(
    /// Of the element, and by which what is being typed here is told from what is being typed in
    /// another field of the same value; its name, where it has none of its own.
    #[prop(optional)]
    id: Option<&'static str>,
    /// Its accessible name.
    name: &'static str,
    /// Shown after the number.
    #[prop(optional)]
    unit: &'static str,
    /// Shown below its name while nothing is wrong.
    #[prop(optional, into)]
    hint: Signal<String>,
    /// The value.
    target: Target,
    /// How it is read and shown.
    entry: Entry,
    /// What is wrong with the value though it is in its range.
    #[prop(optional, into)]
    objection: Signal<Option<String>>,
    /// Called when a person has entered a value here: by Enter, by leaving the field, or in steps.
    /// Not while it is typed, since a wheel that follows would pass 1 and 15 on its way to 150.
    #[prop(into)]
    on_edit: Callback<()>,
) -> impl IntoView {
    let field = id.unwrap_or(name);
    let slug = field.to_ascii_lowercase().replace(' ', "-");
    let words_id = format!("{slug}-words");
    let trouble = memo(move || target.trouble_in(field).or_else(|| objection.get()));
    let wrong = move || trouble.with(Option::is_some);
    view! {
        <div class="field" class:wrong=dynamic(wrong)>
            <label class="field-name" for=slug.clone() aria-hidden="true">
                {name}
            </label>
            <span class="number">
                <input
                    id=slug
                    type="text"
                    role="spinbutton"
                    inputmode="text"
                    autocomplete="off"
                    spellcheck="false"
                    aria-label=name
                    aria-valuemin=entry.plain(entry.min)
                    aria-valuemax=entry.plain(entry.max)
                    aria-valuenow=dynamic(move || entry.plain(target.get()))
                    aria-valuetext=dynamic(move || format!("{} {unit}", (entry.show)(target.get())))
                    aria-invalid=dynamic(move || if wrong() { "true" } else { "false" })
                    aria-describedby=words_id.clone()
                    prop:value=dynamic(move || target.text(field, entry))
                    on:input=handler(move |event| {
                        target.type_in(field, event_target_value(&event), entry);
                    })
                    on:blur=handler(move |_| {
                        if target.finish(field, entry) {
                            on_edit.run(());
                        }
                    })
                    on:keydown=handler(move |event| {
                        if step(target, field, entry, &event) {
                            on_edit.run(());
                        }
                    })
                />
                <span class="number-unit" aria-hidden="true">
                    {unit}
                </span>
            </span>
            // One place for both, so that nothing moves when something is wrong.
            <p class="field-words" id=words_id aria-live="polite">
                {dynamic(move || trouble.get().unwrap_or_else(|| hint.get()))}
            </p>
        </div>
    }
}

/// Arrow and page keys step, Enter finishes. Whether the value was changed.
fn step(target: Target, field: &'static str, entry: Entry, event: &KeyboardEvent) -> bool {
    let by = match event.key().as_str() {
        "ArrowUp" => entry.step,
        "ArrowDown" => -entry.step,
        "PageUp" => entry.page,
        "PageDown" => -entry.page,
        "Enter" => return target.finish(field, entry),
        _ => return false,
    };
    event.prevent_default();
    target.set(entry.moved(target.get_untracked(), by));
    true
}
