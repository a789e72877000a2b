//! The drive pad in the browser: pointer, arrow keys and gamepads.
//!
//! It is HTML with listeners on the window: a hold may end with the pointer anywhere, and a view would be many
//! times as large.

use leptos::prelude::*;
use motorlink_i18n::tr;
use wasm_bindgen::JsCast;
use web_sys::{
    Element, Event, FocusOptions, HtmlElement, HtmlInputElement, KeyboardEvent, PointerEvent,
    VisibilityState,
};

use crate::{
    features::groups::{
        actions::Groups,
        pad::{By, Stick},
    },
    model::{guards::steer_blocked_by, names_and_sides::NamesAndSides},
    ui::{
        animation::Frames,
        format::signed,
        listener::on_window,
        reactive::{effect, memo},
    },
};

const PAD: &str = "drive-pad";
const KNOB: &str = "pad-knob";
const WORDS: &str = "pad-words";
const GAMEPAD: &str = "use-gamepad";

/// Application `Drive pad` and checkbox `Use gamepad`.
pub(crate) fn markup() -> String {
    [
        r#"<div class="drive-pad" id="drive-pad" role="application" aria-label=""#,
        tr!("Drive pad"),
        r#"" aria-describedby="pad-words" aria-disabled="true" tabindex="0">"#,
        r#"<span class="pad-knob" id="pad-knob"></span></div><p class="pad-words" id="pad-words"></p>"#,
        r#"<label class="check"><input type="checkbox" id="use-gamepad">"#,
        tr!("Use gamepad"),
        r#"</label><p class="quiet pad-hint">"#,
        tr!("Hold the bottom face button and drive with the left stick."),
        "</p>",
    ]
    .concat()
}

/// The events to listen to, in the capture phase.
const HEARD: [&str; 12] = [
    "pointerdown",
    "pointermove",
    "pointerup",
    "pointercancel",
    "lostpointercapture",
    "contextmenu",
    "keydown",
    "keyup",
    "blur",
    "visibilitychange",
    "gamepaddisconnected",
    "change",
];

/// The bit of the first button in `buttons` of a pointer event; a finger has it too.
const FIRST_BUTTON: u16 = 1;

/// Attaches the pad's animation loop and listeners.
pub(crate) fn attach_handlers(groups: Groups) {
    let frames = Frames::new(move |now_ms| groups.pad_frame(now_ms));
    groups.waker.set_value(Some(Box::new(frames.waker())));
    StoredValue::new_local(frames);
    for name in HEARD {
        on_window(name, move |event| on_event(groups, &event));
    }
    let disabled_reason = memo(move || {
        let members = groups.page.motors.names.with(NamesAndSides::group_members);
        groups
            .page
            .shown
            .with(|session| steer_blocked_by(session, &members))
    });
    effect(move || show(groups, disabled_reason.get()));
    effect(move || {
        let open = groups.page.shows_group();
        if !open || groups.page.dialog.with(Option::is_some) {
            groups.leave_pad();
        }
        groups.wake_pad();
    });
    // When the pad is removed, its hold ends and its checkbox is reset.
    on_cleanup(move || {
        groups.leave_pad();
        groups.set_gamepads_enabled(false);
    });
}

/// Shows the stick, and the sent speeds or the reason why it does not drive.
fn show(groups: Groups, disabled_reason: Option<String>) {
    let driving = groups.driving.get();
    let (pad, words) = (
        document().get_element_by_id(PAD),
        document().get_element_by_id(WORDS),
    );
    let (Some(pad), Some(words)) = (pad, words) else {
        return;
    };
    // These fail only for invalid names.
    let mark = |name, value: &str| drop(pad.set_attribute(name, value));
    mark(
        "aria-disabled",
        if disabled_reason.is_some() {
            "true"
        } else {
            "false"
        },
    );
    mark("title", disabled_reason.as_deref().unwrap_or_default());
    mark("data-held", if driving.is_some() { "yes" } else { "no" });
    let stick = driving.map(|(stick, _)| stick).unwrap_or_default();
    let knob = pad.first_element_child().map(Element::dyn_into);
    if let Some(Ok(knob)) = knob {
        let knob: HtmlElement = knob;
        let place = |name, part| drop(knob.style().set_property(name, &percent(part)));
        place("left", stick.turn);
        place("top", -stick.forward);
    }
    let sent = driving.map(|(_, wheels)| {
        let (left, right) = (signed(wheels.left), signed(wheels.right));
        tr!("Left {left} rpm, right {right} rpm", left, right)
    });
    let said = sent.or(disabled_reason);
    let said = said.as_deref();
    words.set_text_content(Some(
        said.unwrap_or(tr!("Hold to run: drag the knob, or use the arrow keys.")),
    ));
}

fn on_event(groups: Groups, event: &Event) {
    let element = event.target().and_then(|at| at.dyn_into::<Element>().ok());
    let id = element.as_ref().map(Element::id).unwrap_or_default();
    let on_knob = id == KNOB;
    let on_pad = on_knob || id == PAD;
    match event.type_().as_str() {
        "contextmenu" if on_pad => event.prevent_default(),
        // The page gets no keys while the browser's menu is open.
        "contextmenu" => groups.leave_pad(),
        // Blur events of elements arrive here too: those of the pad and of the page count.
        "blur" if on_pad || element.is_none() => groups.leave_pad(),
        "visibilitychange" if document().visibility_state() == VisibilityState::Hidden => {
            groups.leave_pad();
        }
        "gamepaddisconnected" => groups.gamepad_unplugged(),
        "change" if id == GAMEPAD => {
            let input = element.as_ref().and_then(|element| element.dyn_ref());
            groups.set_gamepads_enabled(input.is_some_and(HtmlInputElement::checked));
        }
        _ => {}
    }
    if let Some(event) = event.dyn_ref::<KeyboardEvent>() {
        on_key(groups, event, on_pad);
    } else if let Some(event) = event.dyn_ref::<PointerEvent>() {
        let is_beside_knob = event.pointer_type() != "mouse" && !on_knob;
        if is_beside_knob && event.type_() == "pointerdown" {
            // A finger or pen beside the knob scrolls the page; it must not drive. If it holds the knob, its release was
            // missed.
            groups.release_pad(By::Pointer(event.pointer_id()));
        } else {
            let pad = document().get_element_by_id(PAD).filter(|_| on_pad);
            on_pointer(groups, event, pad.and_then(|pad| pad.dyn_into().ok()));
        }
    }
}

fn on_pointer(groups: Groups, event: &PointerEvent, pad: Option<HtmlElement>) {
    let by = By::Pointer(event.pointer_id());
    match (event.type_().as_str(), pad) {
        ("pointerup" | "pointercancel" | "lostpointercapture", _) => groups.release_pad(by),
        ("pointerdown", Some(pad)) if event.button() == 0 => {
            // Without pointer capture, the window still gets the end.
            let _ = pad.set_pointer_capture(event.pointer_id());
            // Scrolling would move the pad under the pointer, and so the stick.
            let options = FocusOptions::new();
            options.set_prevent_scroll(true);
            let _ = pad.focus_with_options(&options);
            groups.pad_pressed(by, stick(&pad, event));
        }
        // Its release was missed.
        ("pointermove", _) if event.buttons() & FIRST_BUTTON == 0 => groups.release_pad(by),
        ("pointermove", Some(pad)) => groups.pad_steered(by, stick(&pad, event)),
        _ => {}
    }
}

fn on_key(groups: Groups, event: &KeyboardEvent, on_pad: bool) {
    let key = event.key();
    let modified = event.ctrl_key() || event.alt_key();
    // While Meta is down, macOS reports no releases of other keys.
    if event.meta_key() || key == "Meta" {
        groups.leave_pad();
    } else if event.type_() == "keyup" {
        groups.pad_arrow(&key, false);
    } else if on_pad && key.starts_with("Arrow") && !modified {
        event.prevent_default();
        // A repeated key was pressed before, perhaps elsewhere.
        if !event.repeat() {
            groups.pad_arrow(&key, true);
        }
    }
}

/// The position of the pointer, from the middle of the pad to its edges.
fn stick(pad: &HtmlElement, event: &PointerEvent) -> Stick {
    let place = pad.get_bounding_client_rect();
    let part = |at: f64, from: f64, size: f64| (at - from) / size * 2.0 - 1.0;
    let turn = part(number(event.client_x()), place.x(), place.width());
    let back = part(number(event.client_y()), place.y(), place.height());
    Stick::new(turn, -back)
}

/// A pointer's coordinates are integers or floats, depending on the browser.
fn number(pixels: impl Into<f64>) -> f64 {
    pixels.into()
}

/// Of the way from the middle to the edge.
fn percent(part: f64) -> String {
    format!("{:.0}%", 50.0 + part * 50.0)
}
