//! A button that says why it cannot be pressed.

use leptos::prelude::*;

use crate::ui::reactive::{dynamic, handler};

/// A button; disabled while there is a reason why not, which is then its description.
#[component]
pub(crate) fn PressButton(
    /// What it reads.
    #[prop(into)]
    label: Signal<String>,
    /// Its accessible name, where that is not what it reads.
    #[prop(optional)]
    name: Option<&'static str>,
    /// How it looks.
    #[prop(default = "button")]
    class: &'static str,
    /// What it does, where that needs words of its own.
    #[prop(optional)]
    hint: Option<&'static str>,
    /// Why it cannot be pressed now.
    #[prop(optional, into)]
    disabled_reason: Signal<Option<String>>,
    /// What it does.
    #[prop(into)]
    on_press: Callback<()>,
) -> impl IntoView {
    let title = move || disabled_reason.get().or_else(|| hint.map(str::to_owned));
    view! {
        <button
            type="button"
            class=class
            aria-label=name
            title=dynamic(title)
            disabled=dynamic(move || disabled_reason.with(Option::is_some))
            on:click=handler(move |_| on_press.run(()))
        >
            {label}
        </button>
    }
}
