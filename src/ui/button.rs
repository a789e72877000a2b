//! A button that shows why it cannot be pressed.

use leptos::prelude::*;

use crate::ui::reactive::{dynamic, handler};

/// A button. While there is a reason, it is disabled and the reason is its description.
#[component]
pub(crate) fn PressButton(
    /// Its text.
    #[prop(into)]
    label: Signal<String>,
    /// Its accessible name, if that differs from its text.
    #[prop(optional)]
    name: Option<&'static str>,
    /// Its class.
    #[prop(default = "button")]
    class: &'static str,
    /// An explanation of its action, if it needs one.
    #[prop(optional)]
    hint: Option<&'static str>,
    /// Why it cannot be pressed now.
    #[prop(optional, into)]
    disabled_reason: Signal<Option<String>>,
    /// Its action.
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
