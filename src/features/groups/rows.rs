//! The rows of the panel `Drive together`.

use std::fmt::Write;

use motorlink_i18n::tr;
use motorlink_messages::protocol::MotorId;

use crate::{
    model::names_and_sides::{NAME_MAX, NamesAndSides, Side},
    ui::escape::escaped,
};

/// The rows as HTML: the motors that have answered, and the selected ones that
/// have not.
pub(crate) fn rows_html(found: &[MotorId], names: &NamesAndSides) -> String {
    let mut html = String::new();
    for id in listed(found, names) {
        let member = names.member(id).cloned().unwrap_or_default();
        let number = id.get();
        let checked = if member.drives { " checked" } else { "" };
        let _ = write!(
            html,
            "<li class=\"group-row\"><label class=\"check\"><input type=\"checkbox\" \
             id=\"drive-{number}\" aria-label=\"{}\"{checked}><b>{id}</b></label>\
             <input type=\"text\" class=\"group-name\" id=\"name-{number}\" \
             aria-label=\"{}\" placeholder=\"{}\" maxlength=\"{NAME_MAX}\" \
             autocomplete=\"off\" spellcheck=\"false\" value=\"{}\">\
             <select class=\"select group-side\" id=\"side-{number}\" aria-label=\"{}\">",
            tr!("Drive {id}", id),
            tr!("Name of {id}", id),
            tr!("Name"),
            escaped(member.name()),
            tr!("Side of {id}", id)
        );
        for side in Side::ALL {
            let selected = if side == member.side { " selected" } else { "" };
            let (key, words) = (side.key(), side.words());
            let _ = write!(html, "<option value=\"{key}\"{selected}>{words}</option>");
        }
        html.push_str("</select></li>");
    }
    if html.is_empty() {
        let words = tr!("No motors found yet.");
        let _ = write!(html, "<li class=\"quiet\">{words}</li>");
    }
    html
}

/// The motors with a row.
pub(crate) fn listed(found: &[MotorId], names: &NamesAndSides) -> Vec<MotorId> {
    let mut ids = found.to_vec();
    ids.extend(names.group_members().into_iter().map(|(id, _)| id));
    ids.sort_unstable();
    ids.dedup();
    ids
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{names_and_sides::tests::rover, scan_texts::tests::id};

    #[test]
    fn a_motor_that_is_to_drive_has_a_row_though_it_does_not_answer() {
        assert_eq!(listed(&[id(3)], &rover()), [id(1), id(2), id(3)]);
        assert!(rows_html(&[], &NamesAndSides::default()).contains("No motors found yet."));
    }

    #[test]
    fn a_row_shows_what_is_remembered_and_no_tag_of_a_person() {
        let mut names = rover();
        names.change(id(2), |member| member.set_name("\"><script>"));
        let html = rows_html(&[id(3)], &names);
        assert!(
            html.contains("value=\"&quot;&gt;&lt;script&gt;\""),
            "{html}"
        );
        assert!(!html.contains("<script"), "{html}");
        assert_eq!(html.matches(" checked").count(), 2);
        assert_eq!(html.matches(" selected").count(), 3);
        assert!(html.contains("<option value=\"right\" selected>"), "{html}");
    }
}
