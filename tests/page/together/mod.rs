//! Motors that drive together: the strip, the panel and the drive pad.

mod pad;
mod ramp;

use motorlink_messages::{
    bus::{Activity, Command, Consent, GroupSetpoints},
    protocol::{Acceleration, Current, Mode, Rpm, Setpoint, SpeedTarget},
};
use wasm_bindgen::JsCast;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{
    Event, EventInit, EventTarget, HtmlElement, HtmlInputElement, HtmlSelectElement, KeyboardEvent,
    KeyboardEventInit, PointerEvent, PointerEventInit, Storage,
};

use crate::{
    bench::{Bench, document, press, text_of},
    tools::{id, report, standing, until_enabled},
};

const PAD: (&str, &str) = ("application", "Drive pad");

/// Of the pad, in pixels.
const SIZE: i32 = 200;

fn storage() -> Storage {
    web_sys::window().unwrap().local_storage().unwrap().unwrap()
}

/// A page with a left wheel 0x01 and a right wheel 0x02, and the open panel.
async fn rover(name: &str) -> Bench {
    let fleet = "1\tyes\tleft\tPort\n2\tyes\tright\tStarboard\n";
    storage().set_item("motorlink.fleet", fleet).unwrap();
    let bench = Bench::with_motor(name, Mode::Velocity).await;
    storage().remove_item("motorlink.fleet").unwrap();
    report(&bench, |update| {
        update.motors = vec![standing(1), standing(2)];
    });
    bench.open("Drive together").await;
    until_enabled_pad(&bench).await;
    let size = format!("width: {SIZE}px; height: {SIZE}px");
    pad(&bench).set_attribute("style", &size).unwrap();
    bench
}

fn pad(bench: &Bench) -> HtmlElement {
    bench.find(PAD.0, PAD.1)
}

async fn until_enabled_pad(bench: &Bench) {
    bench
        .until("the pad", || {
            let found = bench.find_all(PAD.0, PAD.1);
            let disabled = found
                .first()
                .and_then(|pad| pad.get_attribute("aria-disabled"));
            disabled.as_deref() == Some("false")
        })
        .await;
}

fn knob() -> HtmlElement {
    let knob = document().get_element_by_id("pad-knob").unwrap();
    knob.unchecked_into()
}

/// A pointer on the pad, in parts of the way from its middle to its edges.
fn pointer(bench: &Bench, name: &str, turn: f64, forward: f64) {
    pointer_on(&pad(bench), bench, "mouse", (name, turn, forward));
}

/// A pointer of this kind on the pad or its knob.
fn pointer_on(
    target: &HtmlElement,
    bench: &Bench,
    kind: &str,
    (name, turn, forward): (&str, f64, f64),
) {
    let pad = pad(bench);
    let place = pad.get_bounding_client_rect();
    let half = f64::from(SIZE) / 2.0;
    let init = PointerEventInit::new();
    init.set_bubbles(true);
    init.set_pointer_id(7);
    init.set_pointer_type(kind);
    init.set_is_primary(true);
    init.set_button(0);
    init.set_buttons(u16::from(name != "pointerup"));
    init.set_client_x(whole(place.x() + half + turn * half));
    init.set_client_y(whole(place.y() + half - forward * half));
    let event = PointerEvent::new_with_event_init_dict(name, &init).unwrap();
    target.dispatch_event(&event).unwrap();
}

#[allow(clippy::cast_possible_truncation, reason = "pixels of a screen")]
fn whole(pixels: f64) -> i32 {
    pixels.round() as i32
}

fn key(bench: &Bench, name: &str, key: &str, repeat: bool) {
    key_with(bench, name, key, |init| init.set_repeat(repeat));
}

fn key_with(bench: &Bench, name: &str, key: &str, how: impl FnOnce(&KeyboardEventInit)) {
    let init = KeyboardEventInit::new();
    init.set_key(key);
    how(&init);
    init.set_bubbles(true);
    init.set_cancelable(true);
    let event = KeyboardEvent::new_with_keyboard_event_init_dict(name, &init).unwrap();
    pad(bench).dispatch_event(&event).unwrap();
}

fn happen(at: &EventTarget, name: &str) {
    at.dispatch_event(&Event::new(name).unwrap()).unwrap();
}

/// A row's control has been changed; its list hears of it.
fn entered(control: &EventTarget) {
    let init = EventInit::new();
    init.set_bubbles(true);
    let input = Event::new_with_event_init_dict("input", &init).unwrap();
    control.dispatch_event(&input).unwrap();
}

/// What both wheels are received, as they count it.
fn parts(first: i32, second: i32) -> GroupSetpoints {
    let speed = |rpm| Setpoint::velocity(SpeedTarget::new(rpm).unwrap());
    GroupSetpoints::new(&[(id(1), speed(first)), (id(2), speed(second))]).unwrap()
}

fn start(first: i32, second: i32) -> Command {
    Command::StartGroup {
        setpoints: parts(first, second),
        consent: Consent::None,
    }
}

/// The pad drives at once or not at all.
fn held(first: i32, second: i32) -> Command {
    Command::DriveGroup {
        setpoints: parts(first, second),
        consent: Consent::None,
    }
}

fn adjust(first: i32, second: i32) -> Command {
    Command::AdjustGroup {
        setpoints: parts(first, second),
        consent: Consent::None,
    }
}

/// The bus tells that it does this with both.
fn both(bench: &Bench, activity: Activity) {
    report(bench, |update| {
        update.motors = [1, 2].map(standing).into();
        for motor in &mut update.motors {
            motor.activity = activity;
        }
    });
}

#[wasm_bindgen_test]
async fn every_member_is_driven_in_its_direction_and_a_stop_is_one() {
    let bench = rover("together").await;
    until_enabled(&bench, "Start group").await;
    bench.enter("Group speed", "60");
    bench.click("Start group");
    assert_eq!(bench.commands().await, [start(60, -60)]);
    bench.click("Stop group");
    assert_eq!(bench.commands().await, [Command::Stop(id(1))]);
}

#[wasm_bindgen_test]
async fn a_group_follows_the_entered_speed_and_is_not_started_by_it() {
    let bench = rover("group-speed").await;
    let enter = || {
        bench.enter("Group speed", "-70").focus().unwrap();
        press("Enter");
    };
    enter();
    assert_eq!(bench.commands().await, []);
    bench.click("Start group");
    both(
        &bench,
        Activity::Driven {
            setpoint: Setpoint::velocity(SpeedTarget::ZERO),
        },
    );
    assert_eq!(bench.commands().await, [start(-70, 70)]);
    enter();
    assert_eq!(bench.commands().await, [adjust(-70, 70)]);
    both(&bench, Activity::Idle);
    bench.commands().await;
    enter();
    assert_eq!(bench.commands().await, []);
}

#[wasm_bindgen_test]
async fn the_panel_says_what_a_start_waits_for_and_a_stop_ends_it() {
    let bench = rover("stage").await;
    let says = || bench.text("region", "Drive together");
    bench.click("Start group");
    report(&bench, |update| {
        update.motors = [1, 2].map(standing).into();
        for motor in &mut update.motors {
            motor.waiting = Some(Setpoint::velocity(SpeedTarget::ZERO));
            motor.activity = Activity::Stopping { confirmed: false };
        }
    });
    bench
        .until("the stage", || says().contains("then the group starts"))
        .await;
    assert_eq!(bench.commands().await, [start(100, -100)]);
    bench.enter("Group speed", "70").focus().unwrap();
    press("Enter");
    assert_eq!(bench.commands().await, [adjust(70, -70)]);
    bench.click("Stop group");
    assert_eq!(bench.commands().await, [Command::Stop(id(1))]);
}

/// The worker tells what the motor counts: −100 is forward of a right wheel.
#[wasm_bindgen_test]
async fn a_right_wheel_alone_is_asked_and_read_with_the_other_sign() {
    let bench = rover("mirrored").await;
    bench.find("radio", "Motor").click();
    bench.click("Motor 0x02, Starboard, right, mirrored");
    until_enabled(&bench, "+100").await;
    bench.commands().await;
    let setpoint = |rpm| Setpoint::Velocity {
        speed: SpeedTarget::new(rpm).unwrap(),
        acceleration: Acceleration::new(1),
    };
    bench.click("+100");
    let drive = Command::Start {
        id: id(2),
        setpoint: setpoint(-100),
        consent: Consent::None,
    };
    assert_eq!(bench.commands().await, [drive]);
    report(&bench, |update| {
        let mut motor = standing(2);
        motor.activity = Activity::Driven {
            setpoint: setpoint(-100),
        };
        motor.speed = motor.speed.map(|(at, _)| (at, Rpm::new(-98)));
        motor.current = motor.current.map(|(at, _)| (at, Current::from_amps(-0.5)));
        update.motors = vec![standing(1), motor];
    });
    bench
        .until("the speed", || {
            bench.text("status", "Speed") == "+98 rpm mirrored"
        })
        .await;
    assert_eq!(bench.text("status", "Current"), "+0.50 A mirrored");
    let wheel = bench.text("region", "Wheel");
    let chip = "0x02 · Target +100 rpm · mirrored";
    assert!(wheel.starts_with(chip), "{wheel}");
    let figures = figures_beside(&bench.find("button", "Motor 0x02, Starboard, right, mirrored"));
    assert!(figures.contains("+98 rpm"), "{figures}");
    let field = bench.find("spinbutton", "Target speed");
    let field: HtmlElement = field.closest(".field").unwrap().unwrap().unchecked_into();
    let words = text_of(&field);
    assert!(words.contains("+ is clockwise"), "{words}");

    // What is adjusted has the same sign.
    bench.enter("Target speed", "40").focus().unwrap();
    press("Enter");
    let adjust = Command::Adjust {
        id: id(2),
        setpoint: setpoint(-40),
        consent: Consent::None,
    };
    assert_eq!(bench.commands().await, [adjust]);

    // Its side stays while it is driven, and is free again when it stands.
    bench.open("Drive together").await;
    bench
        .until("the panel", || {
            bench.find_all("combobox", "Side of 0x02").len() == 1
        })
        .await;
    let side: HtmlSelectElement = bench.find("combobox", "Side of 0x02").unchecked_into();
    bench.until("the side to be held", || side.disabled()).await;
    assert!(side.title().contains("running"), "{}", side.title());
    side.set_value("left");
    entered(&side);
    bench.find("button", "Motor 0x02, Starboard, right, mirrored");
    both(&bench, Activity::Idle);
    bench
        .until("the side to be free", || !side.disabled())
        .await;
    // It is refused for half a second behind a start, of which the worker may not have received yet.
    bench
        .until("the other sign", || {
            side.set_value("left");
            entered(&side);
            bench
                .find_all("button", "Motor 0x02, Starboard, left")
                .len()
                == 1
        })
        .await;
    bench
        .until("the sign of the wire", || {
            !bench.text("status", "Speed").contains("mirrored")
        })
        .await;
    assert_eq!(bench.commands().await, [], "nothing moves by it");
    storage().remove_item("motorlink.fleet").unwrap();
    motorlink::Preferences::default().save();
}

#[wasm_bindgen_test]
async fn what_cannot_drive_says_why() {
    let bench = rover("why-not").await;
    let side: HtmlSelectElement = bench.find("combobox", "Side of 0x02").unchecked_into();
    side.set_value("none");
    entered(&side);
    bench
        .until("the missing side", || {
            pad(&bench).title().contains("side of motor 0x02")
        })
        .await;
    pointer(&bench, "pointerdown", 0.0, 1.0);
    pointer(&bench, "pointerup", 0.0, 1.0);
    assert_eq!(bench.commands().await, []);
    bench.find("checkbox", "Drive 0x01").click();
    bench.find("checkbox", "Drive 0x02").click();
    let button = || bench.find("button", "Start group");
    bench
        .until("nobody to drive", || {
            button().title().contains("Select the motors")
        })
        .await;
    assert!(button().has_attribute("disabled"));
    storage().remove_item("motorlink.fleet").unwrap();
}

/// What the chip of a motor shows; its button has the motor's name alone.
fn figures_beside(button: &HtmlElement) -> String {
    text_of(&button.parent_element().unwrap().unchecked_into())
}

#[wasm_bindgen_test]
async fn the_strip_has_a_chip_for_each_motor_with_the_name_it_was_given() {
    let bench = rover("strip").await;
    let chip = || bench.find("button", "Motor 0x02, Starboard, right, mirrored");
    let figures = figures_beside(&chip());
    assert!(figures.contains("0 rpm"), "{figures}");
    let name: HtmlInputElement = bench.find("textbox", "Name of 0x01").unchecked_into();
    assert_eq!(name.value(), "Port");
    name.set_value("<b>A</b>");
    entered(&name);
    let renamed = ("button", "Motor 0x01, <b>A</b>, left");
    bench
        .until("the name", || {
            bench.find_all(renamed.0, renamed.1).len() == 1
        })
        .await;
    let stored = storage().get_item("motorlink.fleet").unwrap().unwrap();
    assert!(stored.contains("<b>A</b>"), "{stored}");
    storage().remove_item("motorlink.fleet").unwrap();
    chip().click();
    bench
        .until("the choice", || {
            chip().get_attribute("aria-pressed").as_deref() == Some("true")
        })
        .await;
    motorlink::Preferences::default().save();
}

#[wasm_bindgen_test]
async fn another_motor_is_looked_at_while_all_drive_on() {
    let bench = rover("look").await;
    bench.click("Start group");
    both(
        &bench,
        Activity::Driven {
            setpoint: Setpoint::velocity(SpeedTarget::ZERO),
        },
    );
    assert_eq!(bench.commands().await, [start(100, -100)]);
    bench
        .find("button", "Motor 0x02, Starboard, right, mirrored")
        .click();
    assert_eq!(bench.commands().await, []);
    motorlink::Preferences::default().save();
}
