//! What is shown in the place of a part of the program that is not loaded.

use leptos::prelude::*;
use motorlink_i18n::tr;

use crate::ui::reactive::{dynamic, handler};

/// The state of a part that is not loaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Absent {
    /// It is being loaded.
    Loading,
    /// Loading failed.
    Missing,
}

/// What is shown until the part is loaded, or if that fails.
pub(crate) fn notice(state: RwSignal<Absent>, retry: impl Fn() + 'static) -> impl IntoView {
    let is_missing = move || state.get() == Absent::Missing;
    let text = move || {
        if is_missing() {
            tr!("This part of the page could not be loaded. Check the network connection.")
        } else {
            ""
        }
    };
    view! {
        <div class="part-missing">
            <p role="status">{dynamic(text)}</p>
            <button
                type="button"
                class="button"
                hidden=dynamic(move || !is_missing())
                on:click=handler(move |_| retry())
            >
                {tr!("Retry")}
            </button>
        </div>
    }
}
