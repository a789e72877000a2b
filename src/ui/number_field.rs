//! A spinbutton that keeps the typed text, valid or not, and shows what is wrong with it.

use leptos::prelude::*;
use web_sys::KeyboardEvent;

use crate::ui::{
    entry::Entry,
    reactive::{dynamic, handler, memo},
    target::Target,
};

/// A labelled spinbutton. It is a text field, because a number field of the browser changes with the mouse wheel,
/// loses invalid text and shows no plus.
#[component]
pub(crate) fn NumberField(
    /// The id of the element. It also tells the text typed here from that of other fields of the same value. The
    /// default is its name.
    #[prop(optional)]
    id: Option<&'static str>,
    /// Its accessible name.
    name: &'static str,
    /// Shown after the number.
    #[prop(optional)]
    unit: &'static str,
    /// Shown below its name while the value is valid.
    #[prop(optional, into)]
    hint: Signal<String>,
    /// The value.
    target: Target,
    /// How it is parsed and displayed.
    entry: Entry,
    /// Where it ends on both sides of zero, if not at the ends of the range.
    #[prop(optional)]
    limit: Option<&'static (dyn Fn() -> i32 + Sync)>,
    /// What is wrong with a value in range.
    #[prop(optional, into)]
    objection: Signal<Option<String>>,
    /// Called when the user has entered a value here: by Enter, by leaving the field, or in steps. It is not called
    /// while typing, because a wheel would follow 1 and 15 on the way to 150.
    #[prop(into)]
    on_edit: Callback<()>,
) -> impl IntoView {
    let field = id.unwrap_or(name);
    let slug = field.to_ascii_lowercase().replace(' ', "-");
    let words_id = format!("{slug}-words");
    let trouble = memo(move || target.trouble_in(field).or_else(|| objection.get()));
    let wrong = move || trouble.with(Option::is_some);
    let limited = move || limit.map_or(entry, |limit| entry.limited(limit()));
    let entry_now = move || untrack(limited);
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
                    aria-valuemin=dynamic(move || entry.plain(limited().min))
                    aria-valuemax=dynamic(move || entry.plain(limited().max))
                    aria-valuenow=dynamic(move || entry.plain(target.get()))
                    aria-valuetext=dynamic(move || format!("{} {unit}", (entry.show)(target.get())))
                    aria-invalid=dynamic(move || if wrong() { "true" } else { "false" })
                    aria-describedby=words_id.clone()
                    prop:value=dynamic(move || target.text(field, entry))
                    on:input=handler(move |event| {
                        target.type_in(field, event_target_value(&event), entry_now());
                    })
                    on:blur=handler(move |_| {
                        if target.finish(field, entry_now()) {
                            on_edit.run(());
                        }
                    })
                    on:keydown=handler(move |event| {
                        if step(target, field, entry_now(), &event) {
                            on_edit.run(());
                        }
                    })
                />
                <span class="number-unit" aria-hidden="true">
                    {unit}
                </span>
            </span>
            // The hint and the error share one place, so that nothing moves.
            <p class="field-words" id=words_id aria-live="polite">
                {dynamic(move || trouble.get().unwrap_or_else(|| hint.get()))}
            </p>
        </div>
    }
}

/// Handles arrow and page keys, which step, and Enter, which finishes. Returns whether the value was changed.
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
