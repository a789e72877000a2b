//! Panel `Drive together`: several motors with one setpoint.

use leptos::prelude::*;

use super::drawer::panel_of_drawer;
use crate::drawer::Drawer;

/// Panel `Drive together`.
#[component]
pub(crate) fn TogetherPanel() -> impl IntoView {
    panel_of_drawer(
        Drawer::Together,
        "Drive together",
        view! { <div class="together-panel"></div> },
    )
}
