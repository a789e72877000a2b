//! Dialog `Name and side of motor 0x03`, which every list of motors opens.

use std::fmt::Write;

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::protocol::MotorId;
use wasm_bindgen::JsCast;
use web_sys::{Element, HtmlElement, HtmlInputElement, KeyboardEvent};

use crate::{
    model::{
        guards::side_change_blocked_by,
        motor_list::name_and_side_of,
        names_and_sides::{NAME_MAX, NameAndSide, Side},
        page::{Dialog, Page, use_page},
    },
    ui::{
        escape::escaped,
        list::clicked_value,
        reactive::{dynamic, effect, handler, memo},
    },
};

const DIALOG: &str = ".name-dialog";
const NAME: &str = "#edited-name";
const SIDES: &str = ".sides";
const SIDE_WORDS: &str = ".sides + p";
const CHOSEN_SIDE: &str = ".sides :checked";

/// The dialog. It is made when it opens, and what is typed stays while data comes.
#[component]
pub(crate) fn NameDialog() -> impl IntoView {
    let page = use_page();
    let html = memo(move || {
        edited(page.dialog.get()).map_or_else(String::new, |id| {
            let names = page.motors.names;
            let member = names.with_untracked(|names| names.member(id).cloned());
            dialog_html(id, &member.unwrap_or_default())
        })
    });
    effect(move || {
        if html.with(|html| !html.is_empty()) {
            // In the next frame it is shown; hidden elements take no focus.
            request_animation_frame(move || enter(page));
        }
    });
    effect(move || {
        page.shown.track();
        hold_sides(page);
    });
    view! {
        <div
            class="scrim name-scrim"
            hidden=dynamic(move || html.with(String::is_empty))
            inner_html=html
            on:click=handler(move |event| match clicked_value(&event).as_deref() {
                Some("save") => save(page),
                Some(_) => page.dialog.set(None),
                None => {}
            })
            on:keydown=handler(move |event: KeyboardEvent| {
                let at = event.target();
                let is_field = at.is_some_and(|at| at.is_instance_of::<HtmlInputElement>());
                // With Enter an input method accepts the characters that it proposes.
                if event.key() == "Enter" && is_field && !event.is_composing() {
                    event.prevent_default();
                    save(page);
                }
            })
        ></div>
    }
}

fn edited(dialog: Option<Dialog>) -> Option<MotorId> {
    match dialog {
        Some(Dialog::NameAndSide(id)) => Some(id),
        _ => None,
    }
}

fn dialog_html(id: MotorId, member: &NameAndSide) -> String {
    let title = name_and_side_of(id);
    let mut html = format!(
        "<div class=\"dialog name-dialog\" role=\"dialog\" aria-modal=\"true\" aria-label=\"{title}\" \
         tabindex=\"-1\"><h2>{title}</h2><label class=\"labelled\"><span class=\"label\">{}</span>\
         <input type=\"text\" class=\"group-name\" id=\"edited-name\" maxlength=\"{NAME_MAX}\" \
         autocomplete=\"off\" spellcheck=\"false\" value=\"{}\"></label>\
         <fieldset class=\"sides\" role=\"radiogroup\" aria-label=\"{}\">",
        tr!("Name"),
        escaped(member.name()),
        tr!("Side")
    );
    for side in Side::ALL {
        let words = match side {
            Side::Right => tr!("right, mirrored"),
            side => side.words(),
        };
        let (key, mark) = (
            side.key(),
            if side == member.side { " checked" } else { "" },
        );
        // Writing to a string cannot fail.
        let _ = write!(
            html,
            "<label class=\"check\"><input type=\"radio\" name=\"edited-side\" \
             value=\"{key}\"{mark}>{words}</label>"
        );
    }
    let (cancel, save) = (tr!("Cancel"), tr!("Save"));
    let _ = write!(
        html,
        "</fieldset><p class=\"side-words\"></p><div class=\"dialog-foot\">\
         <button type=\"button\" class=\"button\" value=\"cancel\">{cancel}</button>\
         <button type=\"button\" class=\"button primary\" value=\"save\">{save}</button></div></div>"
    );
    html
}

/// Moves the focus to the name; while a motor is driven to the dialog, because Space stops everywhere but in a text field.
fn enter(page: Page) {
    hold_sides(page);
    // Without the focus the dialog works all the same.
    if page.is_anything_driven() {
        if let Some(dialog) = part::<HtmlElement>(DIALOG) {
            let _ = dialog.focus();
        }
    } else if let Some(name) = part::<HtmlInputElement>(NAME) {
        let _ = name.focus();
        name.select();
    }
}

/// Enables or disables the sides, with the reason.
fn hold_sides(page: Page) {
    let Some(id) = edited(page.dialog.get_untracked()) else {
        return;
    };
    let blocked = |session: &_| side_change_blocked_by(session, id);
    let reason = page.shown.with_untracked(blocked);
    if let Some(sides) = part::<Element>(SIDES) {
        // It fails for invalid names only.
        let _ = sides.toggle_attribute_with_force("disabled", reason.is_some());
    }
    if let Some(words) = part::<Element>(SIDE_WORDS) {
        let mirrored = tr!("Mirrored: speed and current have the opposite sign on the bus");
        words.set_text_content(Some(reason.as_deref().unwrap_or(mirrored)));
    }
}

fn save(page: Page) {
    let name = part::<HtmlInputElement>(NAME).map(|name| name.value());
    let side = part::<HtmlInputElement>(CHOSEN_SIDE);
    let side = side.and_then(|side| Side::from_key(&side.value()));
    if let (Some(id), Some(name), Some(side)) = (edited(page.dialog.get_untracked()), name, side) {
        // First, because no side changes while a question is open.
        page.dialog.set(None);
        page.set_name_and_side(id, name.trim(), side);
    }
}

fn part<E: JsCast>(selector: &str) -> Option<E> {
    let found = document().query_selector(selector).ok().flatten();
    found.and_then(|found| found.dyn_into().ok())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scan_texts::tests::id;

    #[test]
    fn the_fields_show_what_is_stored_and_no_tag_of_a_person() {
        let mut member = NameAndSide::default();
        member.side = Side::Right;
        member.set_name("\"><script>");
        let html = dialog_html(id(2), &member);
        assert!(
            html.contains("value=\"&quot;&gt;&lt;script&gt;\""),
            "{html}"
        );
        assert!(!html.contains("<script"), "{html}");
        assert!(html.contains("value=\"right\" checked>right, mirrored"));
        let new = dialog_html(id(9), &NameAndSide::default());
        assert!(new.contains("value=\"\"></label>"), "{new}");
        assert!(new.contains("value=\"none\" checked>no side"), "{new}");
    }
}
