//! Panel `Link`: how well the line works, and what is wrong with it.

use leptos::prelude::*;

use super::drawer::panel_of_drawer;
use crate::drawer::Drawer;

/// Panel `Link`.
#[component]
pub(crate) fn LinkPanel() -> impl IntoView {
    panel_of_drawer(
        Drawer::Link,
        "Link",
        view! { <div class="link-panel"></div> },
    )
}
