//! The lists of the panel as HTML: the fields of the wheels, the replies of their motors, and the spins.

use std::fmt::Write;

use motorlink_i18n::tr;

use crate::{
    features::wheel_setup::{
        state::{Activity, Setup},
        texts::must_answer,
        wheel::Wheel,
    },
    model::{
        names_and_sides::{NAME_MAX, Side},
        tool_entry::NEW_ID,
    },
    ui::escape::escaped,
};

/// The wheels with their fields. The fields have the IDs `wheel-name-0`, `wheel-side-0`, `wheel-id-0` and so on.
pub(crate) fn entry_rows(wheels: &[Wheel]) -> String {
    let mut html = String::new();
    for (place, wheel) in wheels.iter().enumerate() {
        let number = place + 1;
        let _ = write!(
            html,
            "<li class=\"wheel-row\"><input type=\"text\" class=\"group-name\" \
             id=\"wheel-name-{place}\" aria-label=\"{}\" placeholder=\"{}\" \
             maxlength=\"{NAME_MAX}\" autocomplete=\"off\" spellcheck=\"false\" value=\"{}\">\
             <select class=\"select group-side\" id=\"wheel-side-{place}\" aria-label=\"{}\">",
            tr!("Name of wheel {number}", number),
            tr!("Name"),
            escaped(&wheel.name),
            tr!("Side of wheel {number}", number),
        );
        for side in Side::ALL {
            let selected = if side == wheel.side { " selected" } else { "" };
            let (key, words) = (side.key(), side.words());
            let _ = write!(html, "<option value=\"{key}\"{selected}>{words}</option>");
        }
        let _ = write!(
            html,
            "</select><label class=\"wheel-id\"><span aria-hidden=\"true\">ID</span>\
             <input type=\"text\" class=\"group-name\" id=\"wheel-id-{place}\" \
             aria-label=\"{}\" maxlength=\"4\" autocomplete=\"off\" spellcheck=\"false\" \
             value=\"{}\"></label><button type=\"button\" class=\"button small wheel-remove\" \
             value=\"remove-{place}\" aria-label=\"{}\">×</button></li>",
            tr!("ID of wheel {number}", number),
            (NEW_ID.show)(wheel.id),
            tr!("Remove wheel {number}", number),
        );
    }
    html
}

/// The wheels, and which of them replied to the check.
pub(crate) fn check_rows(setup: &Setup) -> String {
    let mut html = String::new();
    for (place, wheel) in setup.wheels.iter().enumerate() {
        let (class, words) = match setup.has_answered(wheel) {
            None => ("", tr!("not checked")),
            Some(true) => ("good", tr!("replies")),
            Some(false) => ("bad", tr!("no reply")),
        };
        let name = escaped(&wheel.name);
        let id = id_of(wheel);
        let _ = write!(
            html,
            "<li class=\"wheel-line\"><span class=\"wheel-named\"><b>{name}</b> {id}</span>\
             <span class=\"chip {class}\">{words}</span>"
        );
        if setup.has_answered(wheel) == Some(false) {
            let _ = write!(
                html,
                "<button type=\"button\" class=\"button small\" value=\"set-id-{place}\" \
                 aria-label=\"{}\">{}</button>",
                tr!("Set ID of {name}", name),
                tr!("Set ID")
            );
        }
        html.push_str("</li>");
    }
    html
}

/// The wheels with their `Spin` buttons. Says why a button is disabled.
pub(crate) fn spin_rows(setup: &Setup, blocked_by: &[Option<String>]) -> String {
    let mut html = String::new();
    for (place, wheel) in setup.wheels.iter().enumerate() {
        let (class, words) = if wheel.is_checked {
            ("good", tr!("checked"))
        } else {
            ("", tr!("not checked"))
        };
        let reason = match setup.activity {
            Activity::None => blocked_by.get(place).cloned().flatten(),
            Activity::Answering { wheel, .. } if wheel == place => {
                blocked_by.get(place).cloned().flatten()
            }
            Activity::Answering { .. } => Some(must_answer().to_owned()),
            _ => Some(tr!("A wheel is being checked.").to_owned()),
        };
        let disabled = match &reason {
            Some(reason) => format!(" disabled title=\"{}\"", escaped(reason)),
            None => String::new(),
        };
        let name = escaped(&wheel.name);
        let _ = write!(
            html,
            "<li class=\"wheel-line\"><span class=\"wheel-named\"><b>{name}</b> {id}</span>\
             <span class=\"chip {class}\">{words}</span>\
             <button type=\"button\" class=\"button small\" value=\"spin-{place}\" \
             aria-label=\"{label}\"{disabled}>{spin}</button></li>",
            id = id_of(wheel),
            label = tr!("Spin {name}", name),
            spin = tr!("Spin"),
        );
        // A tooltip appears neither for touch nor for the keyboard, so the reason is also a line. Neighbours with the same
        // reason share one line below them.
        let is_last = blocked_by.get(place) != blocked_by.get(place + 1);
        if let Some(reason) = reason.filter(|_| setup.activity == Activity::None && is_last) {
            let _ = write!(
                html,
                "<li class=\"quiet wheel-reason\">{}</li>",
                escaped(&reason)
            );
        }
    }
    html
}

/// Buttons for all wheels except the one that was spun.
pub(crate) fn other_rows(setup: &Setup) -> String {
    let Activity::Answering { wheel: asked, .. } = setup.activity else {
        return String::new();
    };
    let others = setup.wheels.iter().enumerate();
    let others = others.filter(|(place, _)| *place != asked);
    let button = |(place, wheel): (usize, &Wheel)| {
        let name = escaped(&wheel.name);
        format!("<button type=\"button\" class=\"button\" value=\"was-{place}\">{name}</button>")
    };
    others.map(button).collect()
}

fn id_of(wheel: &Wheel) -> String {
    wheel.motor().map(|id| id.to_string()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        features::wheel_setup::{state::Step, wheel::Layout},
        model::scan_texts::tests::id,
    };

    #[test]
    fn a_typed_name_is_escaped() {
        let mut wheels = Layout::Two.wheels();
        wheels[0].name = "\"><b>x".to_owned();
        let mut setup = Setup::at(Step::Check, wheels);
        setup.answered = Some(vec![]);
        for html in [
            entry_rows(&setup.wheels),
            check_rows(&setup),
            spin_rows(&setup, &[]),
        ] {
            assert!(html.contains("&quot;&gt;&lt;b&gt;x"), "{html}");
            assert!(!html.contains("<b>x"), "{html}");
        }
    }

    #[test]
    fn a_wheel_without_a_reply_has_the_button_set_id() {
        let mut setup = Setup::at(Step::Check, Layout::Two.wheels());
        assert_eq!(check_rows(&setup).matches("not checked").count(), 2);
        setup.answered = Some(vec![id(2)]);
        let html = check_rows(&setup);
        assert_eq!(html.matches("no reply").count(), 1);
        assert!(
            html.contains("aria-label=\"Set ID of Left wheel\""),
            "{html}"
        );
        assert!(!html.contains("Set ID of Right wheel"), "{html}");
    }

    #[test]
    fn only_the_asked_wheel_can_be_spun_again_before_the_answer() {
        let mut setup = Setup::at(Step::Spin, Layout::Two.wheels());
        assert_eq!(spin_rows(&setup, &[]).matches("disabled").count(), 0);
        let reason = Some("Motor 0x01 is stopping.".to_owned());
        let count =
            |reasons: &[Option<String>]| spin_rows(&setup, reasons).matches("stopping").count();
        assert_eq!(
            count(&[reason.clone(), None]),
            2,
            "as a tooltip and as a line"
        );
        assert_eq!(
            count(&[reason.clone(), reason.clone()]),
            3,
            "one line for both"
        );
        setup.activity = Activity::Answering {
            wheel: 1,
            other: true,
        };
        assert_eq!(spin_rows(&setup, &[]).matches("disabled").count(), 1);
        assert!(other_rows(&setup).contains("Left wheel"));
        assert!(!other_rows(&setup).contains("Right wheel"));
        setup.activity = Activity::Spinning(0);
        assert_eq!(spin_rows(&setup, &[]).matches("disabled").count(), 2);
    }
}
