//! The tour among the notices, in the place where it is said what comes next. As HTML, it weighs a tenth
//! of a view.

use leptos::prelude::*;
use motorlink_messages::protocol::{Mode, MotorId};
use wasm_bindgen::JsCast;
use web_sys::{Element, Event, HtmlElement, HtmlInputElement};

use crate::{
    features::{
        connect::view::{why_not_at_all, why_not_serial},
        help::{
            tour::{SPEED_RPM, Step, Tour, Wanted},
            tour_texts as words,
        },
    },
    model::{
        desk::Desk,
        guards::{why_not_drive, why_not_stop},
        preferences::{remember, remembered},
    },
    ui::{listener::on_window, reactive::follow},
};

const NAME: &str = "tour";
const SKIP: &str = "tour-skip";
const SAID: &str = "tour-words";
const PICK: &str = "tour-pick";
const VIRTUAL: &str = "tour-virtual";
const FREE: &str = "tour-free";
const SPIN: &str = "tour-spin";
const STOP: &str = "tour-stop";
const HELP: &str = "tour-help";

/// Whether this browser has seen it.
pub(crate) fn remembered_tour() -> Tour {
    let seen = remembered(NAME).is_some();
    Tour::new(if seen { Wanted::No } else { Wanted::Offered })
}

impl Desk {
    /// From its beginning, because a person wants it.
    pub(crate) fn start_tour(self) {
        self.tour.set(Tour::new(Wanted::Asked));
    }

    fn end_tour(self) {
        remember(NAME, "seen");
        self.tour.set(Tour::new(Wanted::No));
    }
}

/// The steps, what there is to do in the present one, and its controls.
pub(crate) fn markup() -> String {
    let steps: String = Step::ALL
        .map(|step| format!("<li><span>{}</span></li>", words::name(step)))
        .concat();
    let button = |id, label| {
        format!(r#"<button type="button" class="button small" id="{id}">{label}</button>"#)
    };
    let title = words::title();
    [
        format!(r#"<div class="tour-head"><h2>{title}</h2>"#),
        button(SKIP, words::skip()),
        format!(r#"</div><ol class="tour-steps">{steps}</ol>"#),
        format!(r#"<p class="tour-words" role="status" aria-label="{title}" id="{SAID}"></p>"#),
        format!(
            r#"<label class="check"><input type="checkbox" id="{FREE}">{}</label>"#,
            words::free()
        ),
        r#"<div class="tour-buttons">"#.to_owned(),
        button(PICK, words::pick()),
        button(VIRTUAL, words::go_virtual()),
        button(SPIN, words::spin()),
        button(STOP, words::stop()),
        format!(r#"<button type="button" class="help-link" id="{HELP}"></button></div>"#),
    ]
    .concat()
}

/// Has it show where a person is, and its controls work, from now on.
pub(crate) fn keep_working(desk: Desk) {
    on_window("click", move |event| hear(desk, &event));
    let mut shown = None;
    follow(move || {
        let id = desk.selected.get();
        let mut tour = desk.tour.get();
        let was = tour;
        desk.shown.with(|session| tour.look(session, id));
        if tour != was {
            desk.tour.set(tour);
        }
        if tour.wanted == Wanted::No {
            return;
        }
        let controls = Controls::now(desk, id, tour);
        if shown.as_ref() != Some(&controls) {
            if controls.now == Step::Done {
                // Who has done it need not skip it.
                remember(NAME, "seen");
            }
            show(&controls);
            shown = Some(controls);
        }
    });
}

/// What is shown of the tour.
#[derive(PartialEq)]
struct Controls {
    now: Step,
    id: MotorId,
    free: bool,
    why_not_pick: Option<String>,
    why_not_virtual: Option<String>,
    why_not_spin: Option<String>,
    why_not_stop: Option<String>,
}

impl Controls {
    fn now(desk: Desk, id: MotorId, tour: Tour) -> Self {
        desk.shown.with(|session| Self {
            now: tour.step(session, id),
            id,
            free: tour.free,
            why_not_pick: why_not_serial(desk),
            why_not_virtual: why_not_at_all(desk),
            why_not_spin: why_not_drive(session, id, Mode::Velocity),
            why_not_stop: why_not_stop(session),
        })
    }
}

fn show(controls: &Controls) {
    let now = controls.now;
    let (name, advice) = (words::name(now), words::advice(now, controls.id));
    write(SAID, &format!("{name}\n{advice}"));
    write(
        SKIP,
        if now == Step::Done {
            words::end()
        } else {
            words::skip()
        },
    );
    mark_steps(now);
    let picks = matches!(now, Step::PlugIn | Step::PickPort);
    set_control(PICK, picks, controls.why_not_pick.as_deref());
    set_control(VIRTUAL, picks, controls.why_not_virtual.as_deref());
    set_control(SPIN, now == Step::Spin, controls.why_not_spin.as_deref());
    set_control(STOP, now == Step::Stop, controls.why_not_stop.as_deref());
    if let Some(tick) = element(FREE) {
        if let Some(label) = tick.parent_element() {
            let _ = label.toggle_attribute_with_force("hidden", now != Step::Free);
        }
        if let Some(tick) = tick.dyn_ref::<HtmlInputElement>() {
            tick.set_checked(controls.free);
        }
    }
    let topic = words::topic(now);
    write(HELP, &topic.link());
    set(HELP, "data-help", topic.id());
}

/// Those before are done; of what is plugged in no page knows until its port is picked.
fn mark_steps(now: Step) {
    let Some(list) = element(SAID).and_then(|said| said.previous_element_sibling()) else {
        return;
    };
    let items = list.children();
    for (place, step) in (0..).zip(Step::ALL) {
        let Some(item) = items.item(place) else {
            return;
        };
        let open = step == now || (now == Step::PickPort && step == Step::PlugIn);
        let class = match (open, step < now) {
            (true, _) => "now",
            (false, true) => "done",
            (false, false) => "",
        };
        if item.class_name() != class {
            item.set_class_name(class);
            let current = if step == now { "step" } else { "false" };
            let _ = item.set_attribute("aria-current", current);
        }
    }
}

fn set_control(id: &str, shown: bool, why_not: Option<&str>) {
    if let Some(button) = element(id) {
        let _ = button.toggle_attribute_with_force("hidden", !shown);
        let _ = button.toggle_attribute_with_force("disabled", why_not.is_some());
        set(id, "title", why_not.unwrap_or_default());
    }
}

fn hear(desk: Desk, event: &Event) {
    let target = event.target().and_then(|at| at.dyn_into::<Element>().ok());
    let Some(target) = target else { return };
    let act: fn(Desk) = match target.id().as_str() {
        SKIP => Desk::end_tour,
        PICK => |desk| desk.choose_port(true),
        VIRTUAL => Desk::connect_virtual,
        SPIN => {
            // The next press of Space is to stop the wheel, and not this button again.
            if let Some(button) = target.dyn_ref::<HtmlElement>() {
                let _ = button.blur();
            }
            |desk| {
                let id = desk.selected.get_untracked();
                let tour = desk.tour.get_untracked();
                if tour.step(&desk.present(), id) == Step::Spin {
                    desk.drive_at(SPEED_RPM);
                }
            }
        }
        STOP => |desk| desk.stop_motor(desk.tab.get_untracked()),
        FREE => {
            let ticked = target.dyn_ref::<HtmlInputElement>();
            let free = ticked.is_some_and(HtmlInputElement::checked);
            desk.tour.update(|tour| tour.free = free);
            return;
        }
        _ => return,
    };
    // At once: what is done counts from the moment of the press, which is known only while it is handled.
    act(desk);
}

fn element(id: &str) -> Option<Element> {
    document().get_element_by_id(id)
}

fn write(id: &str, text: &str) {
    if let Some(element) = element(id)
        && element.text_content().as_deref() != Some(text)
    {
        element.set_text_content(Some(text));
    }
}

fn set(id: &str, name: &str, value: &str) {
    if let Some(element) = element(id)
        && element.get_attribute(name).as_deref() != Some(value)
    {
        let _ = element.set_attribute(name, value);
    }
}
