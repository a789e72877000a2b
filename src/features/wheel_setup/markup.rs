//! The HTML of each step. The value of a button names its action: see [`crate::features::wheel_setup::panel`].
//!
//! Views of the same buttons would make the program many times as large.

use motorlink_i18n::tr;
use motorlink_messages::protocol::family::Model;

use crate::{
    features::wheel_setup::{
        rows::{check_rows, entry_rows, other_rows, spin_rows},
        state::{Activity, Outcome, Setup, Step},
        texts::{id_of, must_answer, of_label},
        wheel::WHEELS_MAX,
    },
    model::notice_board::{NoticeText, Tone},
    ui::escape::escaped,
};

/// Why a scan or a spin cannot start now.
#[derive(Default)]
pub(crate) struct Blocked {
    pub(crate) scan: Option<String>,
    /// Why no ID can be changed.
    pub(crate) change: Option<String>,
    /// For each wheel; `None` if it can be spun.
    pub(crate) spins: Vec<Option<String>>,
}

/// The list of steps, with the current step marked, and the heading of this step.
pub(crate) fn head(setup: &Setup) -> String {
    let current = match setup.step {
        Step::Wheels => 0,
        Step::Id(_) | Step::Label(_) => 1,
        Step::Check => 2,
        Step::Spin | Step::Done => 3,
    };
    let names = [tr!("Wheels"), tr!("IDs"), tr!("Bus"), tr!("Direction")];
    let mut html = "<ol class=\"wheel-steps\">".to_owned();
    for (place, name) in names.into_iter().enumerate() {
        html += if place == current {
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
        Step::Done => step_buttons(&[
            button("again", "", tr!("Start again"), None),
            button("drive", " primary", tr!("Drive the wheels together"), None),
        ]),
    }
}

/// A button. If there is a reason, the button is disabled and shows it.
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
fn step_buttons(buttons: &[String]) -> String {
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
        .then(|| tr!("Wait until the scan or the spin ends."))
}

/// A button that starts a scan. The reason why it is disabled is also a line below it, because a tooltip appears neither
/// for touch nor for the keyboard. While this panel scans, a button cancels the scan.
fn scan(value: &str, label: &str, setup: &Setup, reason: Option<&str>) -> String {
    let scan = button(value, " primary", label, reason);
    let below = match (setup.activity, reason) {
        (Activity::Finding | Activity::Checking, _) => {
            button("cancel", "", tr!("Cancel the scan"), None)
        }
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
        step_buttons(&[
            button("have-ids", "", tr!("IDs are set already"), None),
            button("set-ids", " primary", tr!("Set the IDs"), None),
        ]),
    ]
    .concat()
}

fn id(setup: &Setup, blocked: &Blocked) -> String {
    let more = match &setup.outcome {
        Outcome::Kept(Some(more)) => {
            let label = tr!("Send {count} frames", count = more.count());
            button("more", "", &label, blocked.change.as_deref())
        }
        _ => String::new(),
    };
    [
        scan(
            "find",
            tr!("Find and set ID"),
            setup,
            blocked.change.as_deref(),
        ),
        more,
        step_buttons(&[
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
        &step_buttons(&[back(setup), button("next", " primary", next, None)]),
    ]
    .concat()
}

fn check(setup: &Setup, blocked: &Blocked) -> String {
    let may = setup.may_spin() && !setup.is_busy();
    let reason = (!may).then(|| tr!("Press Check all first. At least one motor must reply."));
    [
        scan("check", tr!("Check all"), setup, blocked.scan.as_deref()),
        list(tr!("Wheels on the bus"), &check_rows(setup)),
        step_buttons(&[
            back(setup),
            button("continue", " primary", tr!("Continue"), reason),
        ]),
    ]
    .concat()
}

fn spin(setup: &Setup, blocked: &Blocked) -> String {
    let asked = match setup.activity {
        Activity::Answering { other: false, .. } => group(
            tr!("What did you see?"),
            "wheel-answers",
            &[
                button(
                    "correct",
                    " primary",
                    tr!("Correct wheel, correct direction"),
                    None,
                ),
                button("backwards", "", tr!("Turns backwards"), None),
                button("other", "", tr!("Another wheel turned"), None),
                button("nothing", "", tr!("Nothing turned"), None),
            ]
            .concat(),
        ),
        Activity::Answering { other: true, .. } => {
            let name = tr!("Which wheel turned?");
            let none = button("none-of-them", "", tr!("None of them"), None);
            let wheels = other_rows(setup);
            let content = ["<p>", name, "</p>", &wheels, &none].concat();
            group(name, "wheel-answers", &content)
        }
        _ => String::new(),
    };
    let reason = busy(setup)
        .or_else(|| matches!(setup.activity, Activity::Answering { .. }).then(must_answer));
    [
        list(tr!("Wheels to check"), &spin_rows(setup, &blocked.spins)),
        asked,
        step_buttons(&[
            back(setup),
            button("finish", " primary", tr!("Finish"), reason),
        ]),
    ]
    .concat()
}

#[cfg(test)]
#[path = "markup_tests.rs"]
mod tests;
