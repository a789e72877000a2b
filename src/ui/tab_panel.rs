//! The frame of a tab's panel.

use leptos::prelude::*;

use crate::ui::reactive::dynamic;

/// The id of a tab, by the tab's key.
pub(crate) fn tab_id(key: &str) -> String {
    ["tab-", key].concat()
}

/// The id of a tab's panel, by the tab's key.
pub(crate) fn panel_id(key: &str) -> String {
    ["panel-", key].concat()
}

/// A tab's panel. While it is closed, it is invisible and cannot be focused, but it keeps its space, so that nothing
/// moves when the tab changes.
pub(crate) fn tab_panel(
    key: &str,
    is_closed: impl FnMut() -> bool + Send + 'static,
    body: impl IntoView,
) -> impl IntoView {
    view! {
        <div
            class="tab-panel"
            role="tabpanel"
            id=panel_id(key)
            aria-labelledby=tab_id(key)
            class:closed=dynamic(is_closed)
        >
            {body}
        </div>
    }
}
