//! The note of a bookmark, in the controls of a replay.

use leptos::{html::Input, prelude::*};
use motorlink_i18n::tr;
use web_sys::KeyboardEvent;

use crate::{
    features::session::{
        bookmarks::{Draft, NOTE_MAX},
        player::Player,
        texts,
    },
    ui::{
        button::PressButton,
        reactive::{effect, handler},
    },
};

/// The form, while a note is written.
pub(super) fn bookmark_form(player: Player) -> impl IntoView {
    move || {
        let draft = player.bookmarks.with(|bookmarks| bookmarks.draft.clone());
        draft.map(|draft| form(player, draft))
    }
}

fn form(player: Player, Draft { key, bookmark }: Draft) -> impl IntoView {
    let field = NodeRef::<Input>::new();
    effect(move || {
        if let Some(field) = field.get() {
            // A field that cannot take the focus is pressed by the user.
            let _ = field.focus();
        }
    });
    let keep = move || {
        if let Some(field) = field.get_untracked() {
            let note = field.value();
            player.bookmarks.update(|bookmarks| bookmarks.keep(&note));
        }
    };
    let cancel = move || player.bookmarks.update(|bookmarks| bookmarks.draft = None);
    // Escape pauses the replay, or closes a panel, as everywhere.
    let pressed_key = move |event: KeyboardEvent| {
        if event.key() == "Enter" && !event.is_composing() {
            keep();
        }
    };
    let delete = key.map(|key| {
        view! {
            <PressButton
                label=tr!("Delete bookmark")
                class="button small"
                on_press=move || player.bookmarks.update(|bookmarks| bookmarks.delete(key))
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
                value=bookmark.text
                node_ref=field
                on:keydown=handler(pressed_key)
            />
            <PressButton label=tr!("Keep bookmark") class="button small primary" on_press=keep />
            {delete}
            <PressButton label=tr!("Cancel") class="button small" on_press=cancel />
        </div>
    }
}
