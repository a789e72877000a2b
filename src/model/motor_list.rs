//! What every list of motors offers: a motor is selected, and its name and side are edited.

use leptos::prelude::*;
use motorlink_i18n::tr;
use motorlink_messages::protocol::MotorId;
use web_sys::MouseEvent;

use crate::{
    model::page::{Dialog, Page},
    ui::list::clicked_value,
};

/// Before the ID in the value of the button that opens the name and side. The other button has the ID alone.
const EDIT: &str = "name-";

/// The name of the button and of the dialog that it opens.
pub(crate) fn name_and_side_of(id: MotorId) -> String {
    tr!("Name and side of motor {id}", id)
}

/// Button `Name and side of motor 0x03` as HTML.
pub(crate) fn edit_button(id: MotorId) -> String {
    let (number, label, name) = (id.get(), name_and_side_of(id), tr!("Name"));
    format!(
        "<button type=\"button\" class=\"edit-name\" value=\"{EDIT}{number}\" \
         aria-label=\"{label}\" title=\"{label}\"><span>{name}</span>…</button>"
    )
}

impl Page {
    /// Handles a click in a list of motors.
    pub(crate) fn click_in_list(self, event: &MouseEvent) {
        let Some(value) = clicked_value(event) else {
            return;
        };
        let edited = value.strip_prefix(EDIT);
        let Ok(id) = edited.unwrap_or(&value).parse() else {
            return;
        };
        if edited.is_some() {
            self.dialog.set(Some(Dialog::NameAndSide(id)));
        } else {
            self.choose(id);
        }
    }
}
