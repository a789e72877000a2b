//! Panel `Set up the wheels of a rover`, and the actions of its controls.

use leptos::{html::Div, prelude::*};
use motorlink_i18n::tr;
use wasm_bindgen::JsCast;
use web_sys::{Element, Event, HtmlInputElement, HtmlSelectElement};

use crate::{
    features::wheel_setup::{
        actions::{WheelSetup, spin_blocked_by},
        markup::{Blocked, controls, head, message as message_html},
        state::{Activity, Setup, Step},
        texts::message,
        wheel::{Layout, Wheel, free_id},
    },
    model::{
        guards::{id_change_blocked_by, scan_blocked_by},
        names_and_sides::{NAME_MAX, Side},
        scan_texts::of_progress,
        tool_entry::{NEW_ID, NO_NEW_ID},
    },
    ui::{
        entry::Typed,
        list::{clicked_value, replace_keeping_focus},
        reactive::{dynamic, effect, handler, memo},
    },
};

/// The panel without its frame.
#[component]
pub(crate) fn WheelSetupSteps(setup: WheelSetup) -> impl IntoView {
    setup.follow();
    let head = memo(move || setup.setup.with(head));
    let text = memo(move || {
        let ids = (setup.ids.progress)();
        setup
            .setup
            .with(|setup| message_html(&message(setup, &ids)))
    });
    // Not in the message: a screen reader reads the message at every change.
    let progress = memo(move || {
        let activity = setup.setup.with(|setup| setup.activity);
        let scans = matches!(activity, Activity::Finding | Activity::Checking);
        let progress = || {
            let shown = setup.page.shown;
            shown.with(|session| of_progress(session.job.as_ref()))
        };
        if scans { progress() } else { String::new() }
    });
    let place = NodeRef::<Div>::new();
    show_controls(setup, place);
    view! {
        <div
            class="wheel-setup"
            on:click=handler(move |event| {
                if let Some(value) = clicked_value(&event) {
                    press(setup, &value);
                }
            })
            on:input=handler(move |event| enter(setup, &event))
        >
            <div inner_html=dynamic(move || head.get())></div>
            <div
                role="status"
                aria-label=tr!("Wheel setup")
                inner_html=dynamic(move || text.get())
            ></div>
            <p class="quiet">{dynamic(move || progress.get())}</p>
            <div class="wheel-controls" node_ref=place></div>
        </div>
    }
}

/// Shows the controls of the step, and replaces them when they change. Text fields are not replaced while the user types.
fn show_controls(setup: WheelSetup, place: NodeRef<Div>) {
    let page = setup.page;
    let html = memo(move || {
        setup.setup.with(|setup| {
            let wheels = setup.wheels.iter();
            let blocked = page.shown.with(|session| Blocked {
                scan: scan_blocked_by(session),
                change: id_change_blocked_by(session),
                spins: wheels
                    .map(|wheel| spin_blocked_by(session, wheel.motor()?))
                    .collect(),
            });
            controls(setup, &blocked, page.model.get())
        })
    });
    let mut shown = None;
    effect(move || {
        let now = (
            setup.setup.with(|setup| setup.step == Step::Wheels),
            setup.replaced.get(),
        );
        let html = html.get();
        let Some(place) = place.get() else { return };
        if !now.0 || shown != Some(now) {
            replace_keeping_focus(&place, &html, "value");
        }
        shown = Some(now);
    });
}

/// Runs the action of the button with this value, such as `find` or `spin-2`.
fn press(setup: WheelSetup, value: &str) {
    let (what, place) = match value.rsplit_once('-') {
        Some((what, number)) => match number.parse::<usize>() {
            Ok(place) => (what, place),
            Err(_) => (value, 0),
        },
        None => (value, 0),
    };
    let use_layout = |layout: Layout| {
        setup.replace_wheels(|setup| setup.edit(|wheels| *wheels = layout.wheels()));
    };
    match what {
        "two" => use_layout(Layout::Two),
        "four" => use_layout(Layout::Four),
        "six" => use_layout(Layout::Six),
        "add" => setup.replace_wheels(|setup| {
            setup.edit(|wheels| wheels.push(Wheel::new("", Side::Left, free_id(wheels))));
        }),
        "remove" => setup.replace_wheels(|setup| {
            setup.edit(|wheels| {
                if place < wheels.len() {
                    wheels.remove(place);
                }
            });
        }),
        "have-ids" => setup.change(|setup| setup.leave_wheels(true)),
        "set-ids" => setup.change(|setup| setup.leave_wheels(false)),
        "find" => setup.find(),
        "more" => setup.find_with_more(),
        "cancel" => setup.cancel(),
        "back" => setup.change(Setup::back),
        "next" => setup.change(Setup::next_wheel),
        "check" => setup.check(),
        "set-id" => setup.change(|setup| setup.set_id_of(place)),
        "continue" => setup.begin_spins(),
        "spin" => setup.spin(place),
        "correct" => setup.answer(Setup::answer_correct),
        "backwards" => setup.answer(Setup::answer_backwards),
        "other" => setup.change(|setup| setup.answer_other(true)),
        "none-of-them" => setup.change(|setup| setup.answer_other(false)),
        "was" => setup.answer(|setup| setup.exchange_with(place)),
        "nothing" => setup.change(Setup::answer_nothing),
        "finish" => setup.finish(),
        "again" => setup.replace_wheels(Setup::start_again),
        "drive" => setup.page.open_group(),
        _ => {}
    }
}

/// Handles a change of a field: `wheel-name-0`, `wheel-side-0` or `wheel-id-0`.
fn enter(setup: WheelSetup, event: &Event) {
    let Some(control) = event.target().and_then(|at| at.dyn_into::<Element>().ok()) else {
        return;
    };
    let id = control.id();
    let Some((field, place)) = id.rsplit_once('-') else {
        return;
    };
    let Ok(place) = place.parse::<usize>() else {
        return;
    };
    let text = match control.dyn_ref::<HtmlSelectElement>() {
        Some(list) => list.value(),
        None => control
            .dyn_ref::<HtmlInputElement>()
            .map(HtmlInputElement::value)
            .unwrap_or_default(),
    };
    setup.change(|setup| {
        setup.edit(|wheels| {
            let Some(wheel) = wheels.get_mut(place) else {
                return;
            };
            match field {
                "wheel-name" => {
                    let characters = text.chars().filter(|character| !character.is_control());
                    wheel.name = characters.take(NAME_MAX).collect();
                }
                "wheel-side" => wheel.side = Side::from_key(&text).unwrap_or_default(),
                _ => {
                    wheel.id = match NEW_ID.read(&text) {
                        Typed::Value(id) => id,
                        _ => NO_NEW_ID,
                    }
                }
            }
        });
    });
}
