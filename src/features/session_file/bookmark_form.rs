//! The note of a bookmark, in the controls of a replay.

use leptos::{html::Input, prelude::*};
use motorlink_i18n::tr;
use web_sys::KeyboardEvent;

use crate::{
    features::session_file::{
        bookmarks::{Bookmarks, Draft, NOTE_MAX},
        player::Player,
        texts,
    },
    ui::{
        button::PressButton,
        reactive::{effect, handler, memo},
    },
};

/// The form, while a note is written.
pub(super) fn bookmark_form(player: Player) -> impl IntoView {
    // Only the number: a form that is made again for other changes of the bookmarks would take the focus.
    let number = memo(move || {
        let bookmarks = player.bookmarks;
        bookmarks.with(|bookmarks| bookmarks.draft().map(|draft| draft.number))
    });
    move || {
        number.get()?;
        let draft = player
            .bookmarks
            .with_untracked(|bookmarks| bookmarks.draft().cloned());
        draft.map(|draft| form(player, draft))
    }
}

fn form(player: Player, draft: Draft) -> impl IntoView {
    let Draft { key, bookmark, .. } = draft;
    let field = NodeRef::<Input>::new();
    effect(move || {
        if let Some(field) = field.get() {
            // The element may be that of the form before, with its text.
            field.set_value(&bookmark.text);
            // A field that cannot take the focus is pressed by the user.
            let _ = field.focus();
        }
    });
    // No one else shows the text while it is written.
    let written = move |event| {
        let note = event_target_value(&event);
        let bookmarks = player.bookmarks;
        bookmarks.update_untracked(|bookmarks| bookmarks.write(note));
    };
    let keep = move || player.end_note(Bookmarks::keep);
    // Escape comes through the gate of the replay.
    let pressed_key = move |event: KeyboardEvent| {
        if event.key() == "Enter" && !event.is_composing() {
            // It would press the button that gets the focus.
            event.prevent_default();
            keep();
        }
    };
    let delete = key.map(|key| {
        view! {
            <PressButton
                label=tr!("Delete bookmark")
                class="button small"
                on_press=move || player.end_note(|bookmarks| bookmarks.delete(key))
            />
        }
    });
    view! {
        <div class="replay-bookmark" role="group" aria-label=tr!("Bookmark")>
            <span class="session-time">{texts::elapsed(bookmark.after_us)}</span>
            <input
                type="text"
                aria-label=tr!("Note")
                placeholder=tr!("Note")
                maxlength=NOTE_MAX.to_string()
                node_ref=field
                on:input=handler(written)
                on:keydown=handler(pressed_key)
            />
            <PressButton label=tr!("Keep bookmark") class="button small primary" on_press=keep />
            {delete}
            <PressButton
                label=tr!("Cancel")
                class="button small"
                on_press=move || player.end_note(Bookmarks::cancel)
            />
        </div>
    }
}
