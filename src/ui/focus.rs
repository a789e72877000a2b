//! The focus of dialogs.

use leptos::{html::Div, prelude::*};

use crate::ui::reactive::effect;

/// Moves the focus to the dialog itself when it opens, not to a button in it. So Space or Enter press nothing, and a
/// user who presses Space repeatedly stops again and confirms nothing.
pub(crate) fn focus_when(open: Memo<bool>, dialog: NodeRef<Div>) {
    effect(move || {
        if open.get() {
            // In the next frame it is shown; hidden elements take no focus.
            request_animation_frame(move || {
                if let Some(dialog) = dialog.try_get_untracked().flatten() {
                    // Without the focus the dialog works all the same.
                    let _ = dialog.focus();
                }
            });
        }
    });
}
