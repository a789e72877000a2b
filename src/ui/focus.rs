//! The focus of dialogs.

use leptos::{html::Div, prelude::*};

use crate::ui::reactive::effect;

/// Gives a dialog the focus as a whole when it opens: it is on nothing that Space or Enter could
/// press, so somebody who hammers on Space stops again and confirms nothing.
pub(crate) fn focus_when(open: Memo<bool>, dialog: NodeRef<Div>) {
    effect(move || {
        if open.get() {
            // By then it is shown; what is hidden takes no focus.
            request_animation_frame(move || {
                if let Some(dialog) = dialog.try_get_untracked().flatten() {
                    // Without the focus the dialog is read all the same.
                    let _ = dialog.focus();
                }
            });
        }
    });
}
