//! The tour among the notices, in the place of the next steps. As HTML, it is a tenth of the size of a view.

use leptos::prelude::*;
use motorlink_messages::protocol::{Mode, MotorId};
use wasm_bindgen::JsCast;
use web_sys::{Element, Event, HtmlElement, HtmlInputElement};

use crate::{
    features::help::{
        tour::{SPEED_RPM, Shown, Step, Tour, is_virtual},
        tour_texts,
    },
    model::{
        guards::{drive_blocked_by, port_blocked_by, serial_blocked_by, stop_blocked_by},
        local_storage::{remember, remembered},
        page::Page,
        snapshot::Session,
    },
    ui::{
        listener::on_window,
        reactive::{dynamic, effect},
    },
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

/// The tour at the start, which is offered unless this browser has stored that it was seen.
pub(crate) fn remembered_tour() -> Tour {
    let seen = remembered(NAME).is_some();
    Tour::new(if seen { Shown::No } else { Shown::Offered })
}

/// Whether the tour is shown now. It is not offered on the first screen, which has its own steps, to a group, of which
/// it would turn one motor, nor during a replay, which needs the place.
pub(crate) fn shown(page: Page, tour: RwSignal<Tour>) -> Shown {
    match tour.with(|tour| tour.shown) {
        Shown::Offered
            if page.has_no_port() || page.group.get() || page.shown.with(Session::is_recording) =>
        {
            Shown::No
        }
        shown => shown,
    }
}

/// The actions of the tour, which other features carry out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TourAction {
    PickPort,
    ConnectVirtual,
    /// At this speed in rpm.
    Spin(i32),
    Stop,
}

/// The function that carries them out.
pub(crate) type OnTourAction = &'static dyn Fn(TourAction);

fn end_tour(tour: RwSignal<Tour>) {
    remember(NAME, "seen");
    tour.set(Tour::new(Shown::No));
}

/// The tour, among the notices.
#[component]
pub(crate) fn TourNotice(
    page: Page,
    tour: RwSignal<Tour>,
    on_action: OnTourAction,
) -> impl IntoView {
    attach_handlers(page, tour, on_action);
    let shown = move || shown(page, tour);
    view! {
        <div
            class="tour"
            class:asked=dynamic(move || shown() == Shown::Opened)
            hidden=dynamic(move || shown() == Shown::No)
            inner_html=markup()
        ></div>
    }
}

/// The steps, the task of the current one, and its controls.
fn markup() -> String {
    let steps: String = Step::ALL
        .map(|step| format!("<li><span>{}</span></li>", tour_texts::name(step)))
        .concat();
    let button = |id, label| {
        format!(r#"<button type="button" class="button small" id="{id}">{label}</button>"#)
    };
    let title = tour_texts::title();
    [
        format!(r#"<div class="tour-head"><h2>{title}</h2>"#),
        button(SKIP, tour_texts::skip()),
        format!(r#"</div><ol class="tour-steps">{steps}</ol>"#),
        format!(r#"<p class="tour-words" role="status" aria-label="{title}" id="{SAID}"></p>"#),
        format!(
            r#"<label class="check"><input type="checkbox" id="{FREE}">{}</label>"#,
            tour_texts::free()
        ),
        r#"<div class="tour-buttons">"#.to_owned(),
        button(PICK, tour_texts::pick()),
        button(VIRTUAL, tour_texts::go_virtual()),
        button(SPIN, tour_texts::spin()),
        button(STOP, tour_texts::stop()),
        format!(r#"<button type="button" class="help-link" id="{HELP}"></button></div>"#),
    ]
    .concat()
}

/// Attaches the updates and the handlers of the controls.
fn attach_handlers(page: Page, tour_state: RwSignal<Tour>, on_action: OnTourAction) {
    on_window("click", move |event| {
        on_event(page, tour_state, on_action, &event);
    });
    let mut shown = None;
    effect(move || {
        let id = page.selected.get();
        let mut tour = tour_state.get();
        let was = tour;
        page.shown.with(|session| tour.update(session, id));
        if tour != was {
            tour_state.set(tour);
        }
        if tour.shown == Shown::No {
            return;
        }
        let controls = Controls::now(page, id, tour);
        if shown.as_ref() != Some(&controls) {
            if controls.now == Step::Done {
                // A completed tour counts as seen.
                remember(NAME, "seen");
            }
            show(&controls);
            shown = Some(controls);
        }
    });
}

/// The shown state of the tour.
#[derive(PartialEq)]
struct Controls {
    now: Step,
    id: MotorId,
    free: bool,
    is_virtual: bool,
    pick_blocked_by: Option<String>,
    virtual_blocked_by: Option<String>,
    spin_blocked_by: Option<String>,
    stop_blocked_by: Option<String>,
}

impl Controls {
    fn now(page: Page, id: MotorId, tour: Tour) -> Self {
        page.shown.with(|session| Self {
            now: tour.step(session, id),
            id,
            free: tour.free,
            is_virtual: is_virtual(session),
            pick_blocked_by: serial_blocked_by(page.worker.state.get()),
            virtual_blocked_by: port_blocked_by(page.worker.state.get()),
            spin_blocked_by: drive_blocked_by(session, id, Mode::Velocity),
            stop_blocked_by: stop_blocked_by(session),
        })
    }
}

fn show(controls: &Controls) {
    let now = controls.now;
    let (name, advice) = (tour_texts::name(now), tour_texts::advice(now, controls.id));
    write(SAID, &format!("{name}\n{advice}"));
    write(
        SKIP,
        if now == Step::Done {
            tour_texts::end()
        } else {
            tour_texts::skip()
        },
    );
    mark_steps(now, controls.is_virtual);
    let picks = matches!(now, Step::PlugIn | Step::PickPort);
    set_control(PICK, picks, controls.pick_blocked_by.as_deref());
    set_control(VIRTUAL, picks, controls.virtual_blocked_by.as_deref());
    set_control(SPIN, now == Step::Spin, controls.spin_blocked_by.as_deref());
    set_control(STOP, now == Step::Stop, controls.stop_blocked_by.as_deref());
    if let Some(tick) = element(FREE) {
        if let Some(label) = tick.parent_element() {
            let _ = label.toggle_attribute_with_force("hidden", now != Step::Free);
        }
        if let Some(tick) = tick.dyn_ref::<HtmlInputElement>() {
            tick.set_checked(controls.free);
        }
    }
    let topic = tour_texts::topic(now);
    write(HELP, &topic.link());
    set(HELP, "data-help", topic.id());
}

/// The state of each step. The page cannot see a plugged-in adapter until its port is picked.
fn mark_steps(now: Step, is_virtual: bool) {
    let Some(list) = element(SAID).and_then(|said| said.previous_element_sibling()) else {
        return;
    };
    let items = list.children();
    for (place, step) in (0..).zip(Step::ALL) {
        let Some(item) = items.item(place) else {
            return;
        };
        let _ = item.toggle_attribute_with_force("hidden", is_virtual && step.is_of_hardware());
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

fn set_control(id: &str, shown: bool, disabled_reason: Option<&str>) {
    if let Some(button) = element(id) {
        let _ = button.toggle_attribute_with_force("hidden", !shown);
        let _ = button.toggle_attribute_with_force("disabled", disabled_reason.is_some());
        set(id, "title", disabled_reason.unwrap_or_default());
    }
}

fn on_event(page: Page, tour: RwSignal<Tour>, on_action: OnTourAction, event: &Event) {
    let target = event.target().and_then(|at| at.dyn_into::<Element>().ok());
    let Some(target) = target else { return };
    // At once: a command has the time of the press, which is known only while the event is handled.
    match target.id().as_str() {
        SKIP => end_tour(tour),
        PICK => on_action(TourAction::PickPort),
        VIRTUAL => on_action(TourAction::ConnectVirtual),
        SPIN => {
            // The next Space must stop the wheel, and not press this button again.
            if let Some(button) = target.dyn_ref::<HtmlElement>() {
                let _ = button.blur();
            }
            let id = page.selected.get_untracked();
            if tour.get_untracked().step(&page.present(), id) == Step::Spin {
                // It turns one motor, so its controls are shown.
                page.group.set(false);
                on_action(TourAction::Spin(SPEED_RPM));
            }
        }
        STOP => on_action(TourAction::Stop),
        FREE => {
            let ticked = target.dyn_ref::<HtmlInputElement>();
            let free = ticked.is_some_and(HtmlInputElement::checked);
            tour.update(|tour| tour.free = free);
        }
        _ => {}
    }
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
