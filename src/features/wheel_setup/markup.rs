//! What each step shows, as HTML. The value of a button says what it does: see [`crate::features::wheel_setup::panel`].
//!
//! As views, the buttons would be many times as large.

use motorlink_i18n::tr;
use motorlink_messages::protocol::family::Model;

use crate::{
    features::wheel_setup::{
        rows::{check_rows, entry_rows, other_rows, spin_rows},
        state::{Act, Said, Setup, Step},
        texts::{id_of, of_label},
        wheel::WHEELS_MAX,
    },
    model::notice_board::{NoticeText, Tone},
    ui::escape::escaped,
};

/// Why something cannot be done now.
#[derive(Default)]
pub(crate) struct Blocked {
    pub(crate) scan: Option<String>,
    /// Each wheel's spin.
    pub(crate) spins: Vec<Option<String>>,
}

/// The four steps with the present one marked, and its heading.
pub(crate) fn head(setup: &Setup) -> String {
    let present = match setup.step {
        Step::Wheels => 0,
        Step::Id(_) | Step::Label(_) => 1,
        Step::Check => 2,
        Step::Spin | Step::Done => 3,
    };
    let names = [tr!("Wheels"), tr!("IDs"), tr!("Bus"), tr!("Direction")];
    let mut html = "<ol class=\"wheel-steps\">".to_owned();
    for (place, name) in names.into_iter().enumerate() {
        html += if place == present {
            "<li aria-current=\"step\">"
        } else {
            "<li>"
        };
        html += name;
        html += "</li>";
    }
    [&html, "</ol><h3>", &escaped(&title(setup)), "</h3>"].concat()
}

fn title(setup: &Setup) -> String {
    let of = setup.wheels.len();
    match setup.step {
        Step::Wheels => tr!("Wheels of the rover").to_owned(),
        Step::Id(place) | Step::Label(place) => tr!(
            "Wheel {number} of {of}: {name}, ID {id}",
            number = place + 1,
            of,
            name = setup.wheels.get(place).map_or("", |wheel| &wheel.name),
            id = id_of(setup, place)
        ),
        Step::Check => tr!("All motors on one bus").to_owned(),
        Step::Spin => tr!("Place and direction of each wheel").to_owned(),
        Step::Done => tr!("Ready").to_owned(),
    }
}

/// The message of the panel.
pub(crate) fn message(text: &NoticeText) -> String {
    let tone = match text.tone {
        Tone::Calm => "",
        Tone::Warning => " warning",
        Tone::Error => " error",
    };
    [
        "<div class=\"tool-words",
        tone,
        "\"><p class=\"notice-title\">",
        &escaped(&text.title),
        "</p> <p class=\"notice-advice\">",
        &escaped(&text.advice.join(" ")),
        "</p></div>",
    ]
    .concat()
}

/// The controls of a step.
pub(crate) fn controls(setup: &Setup, blocked: &Blocked, model: Model) -> String {
    match setup.step {
        Step::Wheels => wheels(setup),
        Step::Id(_) => id(setup, blocked),
        Step::Label(place) => label(setup, place, model),
        Step::Check => check(setup, blocked),
        Step::Spin => spin(setup, blocked),
        Step::Done => acts(&[
            button("again", "", tr!("Begin again"), None),
            button("drive", " primary", tr!("Drive the wheels together"), None),
        ]),
    }
}

/// A button. While there is a reason, it is disabled.
fn button(value: &str, class: &str, label: &str, reason: Option<&str>) -> String {
    let disabled = match reason {
        Some(reason) => [" disabled title=\"", &escaped(reason), "\""].concat(),
        None => String::new(),
    };
    [
        "<button type=\"button\" class=\"button",
        class,
        "\" value=\"",
        value,
        "\"",
        &disabled,
        ">",
        &escaped(label),
        "</button>",
    ]
    .concat()
}

/// The buttons at the end of a step.
fn acts(buttons: &[String]) -> String {
    ["<div class=\"wheel-acts\">", &buttons.concat(), "</div>"].concat()
}

fn list(name: &str, rows: &str) -> String {
    [
        "<ul class=\"wheel-list\" role=\"list\" aria-label=\"",
        name,
        "\">",
        rows,
        "</ul>",
    ]
    .concat()
}

fn group(name: &str, class: &str, content: &str) -> String {
    [
        "<div role=\"group\" class=\"",
        class,
        "\" aria-label=\"",
        name,
        "\">",
        content,
        "</div>",
    ]
    .concat()
}

fn back(setup: &Setup) -> String {
    button("back", "", tr!("Back"), busy(setup))
}

/// Why no other step can be opened now.
fn busy(setup: &Setup) -> Option<&'static str> {
    setup
        .is_busy()
        .then(|| tr!("Wait until this has ended, or cancel it."))
}

/// A button that begins a scan. A tooltip reaches neither touch nor keyboard, so the reason is a line too; while the
/// scan is one of this panel, a button ends it.
fn scan(value: &str, label: &str, setup: &Setup, blocked: &Blocked) -> String {
    let reason = blocked.scan.as_deref();
    let scan = button(value, " primary", label, reason);
    let below = match (setup.act, reason) {
        (Act::Finding | Act::Checking, _) => button("cancel", "", tr!("Cancel the scan"), None),
        (_, Some(reason)) => ["<p class=\"quiet\">", &escaped(reason), "</p>"].concat(),
        (_, None) => String::new(),
    };
    scan + &below
}

fn wheels(setup: &Setup) -> String {
    let layouts = [
        button("two", "", tr!("2 wheels"), None),
        button("four", "", tr!("4 wheels"), None),
        button("six", "", tr!("6 wheels"), None),
    ];
    let is_full = setup.wheels.len() >= WHEELS_MAX;
    let is_full =
        is_full.then(|| tr!("At most {count} wheels drive together.", count = WHEELS_MAX));
    [
        group(tr!("Layout"), "button-row three", &layouts.concat()),
        list(tr!("Wheels"), &entry_rows(&setup.wheels)),
        button("add", " small", tr!("Add wheel"), is_full.as_deref()),
        acts(&[
            button("have-ids", "", tr!("IDs are set already"), None),
            button("set-ids", " primary", tr!("Set the IDs"), None),
        ]),
    ]
    .concat()
}

fn id(setup: &Setup, blocked: &Blocked) -> String {
    let more = match &setup.said {
        Said::Kept(Some(more)) => {
            let label = tr!("Send {count} frames", count = more.count());
            button("more", "", &label, blocked.scan.as_deref())
        }
        _ => String::new(),
    };
    [
        scan("find", tr!("Find and set ID"), setup, blocked),
        more,
        acts(&[
            back(setup),
            button("next", "", tr!("Skip this wheel"), busy(setup)),
        ]),
    ]
    .concat()
}

fn label(setup: &Setup, place: usize, model: Model) -> String {
    let next = if place + 1 == setup.wheels.len() {
        tr!("Labelled: check all")
    } else {
        tr!("Labelled: next wheel")
    };
    [
        "<p class=\"wheel-label\">",
        &tr!("Label it {id}", id = id_of(setup, place)),
        "</p><p class=\"quiet\">",
        &of_label(model),
        "</p>",
        &acts(&[back(setup), button("next", " primary", next, None)]),
    ]
    .concat()
}

fn check(setup: &Setup, blocked: &Blocked) -> String {
    let may = setup.may_spin() && !setup.is_busy();
    let reason = (!may).then(|| tr!("Press Check all first: a motor has to answer."));
    [
        scan("check", tr!("Check all"), setup, blocked),
        list(tr!("Wheels on the bus"), &check_rows(setup)),
        acts(&[
            back(setup),
            button("continue", " primary", tr!("Continue"), reason),
        ]),
    ]
    .concat()
}

fn spin(setup: &Setup, blocked: &Blocked) -> String {
    let asked = match setup.act {
        Act::Answering { other: false, .. } => group(
            tr!("What did you see?"),
            "wheel-answers",
            &[
                button(
                    "right",
                    " primary",
                    tr!("Right wheel, right direction"),
                    None,
                ),
                button("backwards", "", tr!("Turns backwards"), None),
                button("other", "", tr!("Another wheel turned"), None),
                button("nothing", "", tr!("Nothing turned"), None),
            ]
            .concat(),
        ),
        Act::Answering { other: true, .. } => {
            let name = tr!("Which wheel turned?");
            let none = button("none-of-them", "", tr!("None of them"), None);
            let wheels = other_rows(setup);
            let content = ["<p>", name, "</p>", &wheels, &none].concat();
            group(name, "wheel-answers", &content)
        }
        _ => String::new(),
    };
    let reason = (setup.act != Act::None).then(|| tr!("Say first what you saw."));
    [
        list(tr!("Wheels to check"), &spin_rows(setup, &blocked.spins)),
        asked,
        acts(&[
            back(setup),
            button("finish", " primary", tr!("Finish"), reason),
        ]),
    ]
    .concat()
}

#[cfg(test)]
#[path = "markup_tests.rs"]
mod tests;
