//! The drive pad: pointer, arrows and gamepad.

use js_sys::Promise;
use motorlink_messages::{
    Notice,
    bus::{Activity, Command, Limits, Refusal, StopReason},
    protocol::{Setpoint, SpeedTarget},
};
use wasm_bindgen_futures::JsFuture;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Event, KeyboardEventInit};

use super::{
    adjust, both, happen, held, key, key_with, knob, pad, pointer, pointer_on, rover,
    until_enabled_pad,
};
use crate::{
    bench::{Bench, press},
    tools::{id, report, standing},
};

#[wasm_bindgen_test]
async fn letting_the_pad_go_stops() {
    let bench = rover("let-go").await;
    pointer(&bench, "pointermove", 0.0, 1.0);
    assert_eq!(bench.commands().await, [], "nothing is held");
    pointer(&bench, "pointerdown", 0.0, 1.0);
    assert_eq!(bench.commands().await, [held(100, -100)]);
    pointer(&bench, "pointermove", 0.0, 0.7);
    pointer(&bench, "pointermove", 0.25, 0.5);
    assert_eq!(bench.commands().await, [adjust(75, -25)], "once a frame");
    pointer(&bench, "pointerup", 0.25, 0.5);
    assert_eq!(bench.commands().await, [Command::Stop(id(1))]);
    pointer(&bench, "pointermove", 0.0, 1.0);
    assert_eq!(bench.commands().await, []);
}

/// On a phone the pad is as wide as the page: who scrolls over it drives nothing.
#[wasm_bindgen_test]
async fn a_finger_drives_only_by_the_knob() {
    let bench = rover("finger").await;
    let (pad, knob) = (pad(&bench), knob());
    for (kind, end) in [("touch", "pointerup"), ("pen", "pointercancel")] {
        pointer_on(&pad, &bench, kind, ("pointerdown", 0.0, 0.9));
        pointer_on(&pad, &bench, kind, ("pointermove", 0.0, 0.5));
        pointer_on(&pad, &bench, kind, ("pointerup", 0.0, 0.5));
        assert_eq!(bench.commands().await, [], "{kind}: it scrolls");
        pointer_on(&knob, &bench, kind, ("pointerdown", 0.0, 0.1));
        assert_eq!(bench.commands().await, [held(10, -10)], "{kind}");
        pointer_on(&pad, &bench, kind, ("pointermove", 0.0, 1.0));
        assert_eq!(bench.commands().await, [adjust(100, -100)], "{kind}");
        pointer_on(&pad, &bench, kind, (end, 0.0, 1.0));
        assert_eq!(bench.commands().await, [Command::Stop(id(1))], "{kind}");
    }
}

#[wasm_bindgen_test]
async fn a_finger_whose_release_was_missed_stops_when_it_comes_down_again() {
    let bench = rover("finger-again").await;
    let (pad, knob) = (pad(&bench), knob());
    pointer_on(&knob, &bench, "touch", ("pointerdown", 0.0, 0.1));
    assert_eq!(bench.commands().await, [held(10, -10)]);
    pointer_on(&pad, &bench, "touch", ("pointerdown", 0.0, 0.9));
    assert_eq!(bench.commands().await, [Command::Stop(id(1))]);
    pointer_on(&pad, &bench, "touch", ("pointermove", 0.0, 1.0));
    assert_eq!(bench.commands().await, []);
}

#[wasm_bindgen_test]
async fn the_pad_asks_for_no_more_than_the_speed_limit() {
    let low = motorlink::Preferences {
        limits: Limits::new(40, 2_000, 75).unwrap(),
        ..motorlink::Preferences::load()
    };
    low.save();
    let bench = rover("limited").await;
    motorlink::Preferences::default().save();
    pointer(&bench, "pointerdown", 0.0, 1.0);
    assert_eq!(bench.commands().await, [held(40, -40)]);
    pointer(&bench, "pointerup", 0.0, 1.0);
}

#[wasm_bindgen_test]
async fn arrows_drive_while_they_are_held() {
    let bench = rover("arrows").await;
    key(&bench, "keydown", "ArrowDown", true);
    assert_eq!(bench.commands().await, [], "held down from elsewhere");
    key(&bench, "keydown", "ArrowUp", false);
    key(&bench, "keydown", "ArrowUp", true);
    assert_eq!(bench.commands().await, [held(100, -100)]);
    key(&bench, "keydown", "ArrowLeft", false);
    assert_eq!(bench.commands().await, [adjust(0, -100)]);
    key(&bench, "keyup", "ArrowUp", false);
    assert_eq!(bench.commands().await, [adjust(-100, -100)]);
    key(&bench, "keyup", "ArrowLeft", false);
    assert_eq!(bench.commands().await, [Command::Stop(id(1))]);
}

/// On macOS no key but Meta comes up while Meta is down.
#[wasm_bindgen_test]
async fn an_arrow_whose_release_may_be_lost_stops() {
    let with_meta = |init: &KeyboardEventInit| init.set_meta_key(true);
    for way in ["meta", "letter", "meta-up", "again", "menu"] {
        let bench = rover(&format!("arrow-{way}")).await;
        key(&bench, "keydown", "ArrowUp", false);
        assert_eq!(bench.commands().await, [held(100, -100)], "{way}");
        match way {
            "meta" => key_with(&bench, "keydown", "Meta", with_meta),
            "letter" => key_with(&bench, "keydown", "c", with_meta),
            "meta-up" => key(&bench, "keyup", "Meta", false),
            "again" => key(&bench, "keydown", "ArrowUp", false),
            _ => happen(&web_sys::window().unwrap(), "contextmenu"),
        }
        assert_eq!(bench.commands().await, [Command::Stop(id(1))], "{way}");
        key_with(&bench, "keydown", "ArrowUp", |init| {
            init.set_meta_key(true);
            init.set_repeat(true);
        });
        key(&bench, "keydown", "ArrowUp", true);
        assert_eq!(bench.commands().await, [], "{way}");
        key(&bench, "keydown", "ArrowUp", false);
        assert_eq!(bench.commands().await, [held(100, -100)], "{way}");
    }
}

#[wasm_bindgen_test]
async fn a_pad_that_is_lost_stops() {
    let window = web_sys::window().unwrap();
    let document = window.document().unwrap();
    for way in ["blur", "window", "hidden", "closed", "cancelled"] {
        let bench = rover(&format!("lost-{way}")).await;
        pointer(&bench, "pointerdown", 0.0, 1.0);
        assert_eq!(bench.commands().await, [held(100, -100)], "{way}");
        match way {
            "blur" => happen(&pad(&bench), "blur"),
            "window" => happen(&window, "blur"),
            "closed" => bench.click("Record"),
            "cancelled" => pointer(&bench, "pointercancel", 0.0, 1.0),
            _ => {
                let hide = "Object.defineProperty(document, 'visibilityState', \
                            { value: 'hidden', configurable: true })";
                js_sys::eval(hide).unwrap();
                let hidden = Event::new("visibilitychange").unwrap();
                document.dispatch_event(&hidden).unwrap();
                js_sys::eval("delete document.visibilityState").unwrap();
            }
        }
        assert_eq!(bench.commands().await, [Command::Stop(id(1))], "{way}");
        if way != "closed" {
            pointer(&bench, "pointermove", 0.0, 0.5);
        }
        assert_eq!(bench.commands().await, [], "{way}");
    }
}

/// Gives the browser a gamepad, or takes it away.
fn gamepad(seen: Option<(bool, f64)>) {
    let made = seen.map_or_else(
        || "null".to_owned(),
        |(is_down, back)| {
            format!(
                "Object.create(Gamepad.prototype, {{ \
                   connected: {{ value: true }}, \
                   axes: {{ value: [0, {back}, 0, 0] }}, \
                   buttons: {{ value: [Object.create(GamepadButton.prototype, \
                                       {{ pressed: {{ value: {is_down} }} }})] }} }})"
            )
        },
    );
    let script = format!(
        "{{ const made = {made}; \
           Object.defineProperty(navigator, 'getGamepads', \
             {{ value: () => [null, made], configurable: true }}); }}"
    );
    js_sys::eval(&script).unwrap();
}

/// Gives the page's frames times with 16 ms between its steps, however late a busy machine draws them: a gamepad that the
/// page has not polled for half a second must be released before it drives.
fn frames_in_step() {
    let script = "{ const draw = window.requestAnimationFrame; \
                    let now = performance.now(); \
                    window.requestAnimationFrame = step => draw(() => step(now += 16)); \
                    window.drawsAgain = () => { window.requestAnimationFrame = draw; }; }";
    js_sys::eval(script).unwrap();
}

/// The commands after the page has polled this gamepad.
async fn commands_of(bench: &Bench, seen: Option<(bool, f64)>) -> Vec<Command> {
    gamepad(seen);
    for _ in 0..3 {
        let frame = Promise::new(&mut |resolve, _| {
            let window = web_sys::window().unwrap();
            window.request_animation_frame(&resolve).unwrap();
        });
        JsFuture::from(frame).await.unwrap();
    }
    bench.commands().await
}

#[wasm_bindgen_test]
async fn a_gamepad_drives_while_its_button_is_held_and_the_box_is_ticked() {
    let bench = rover("gamepad").await;
    let stop = Command::Stop(id(1));
    let (released, pressed) = (Some((false, -1.0)), Some((true, -1.0)));
    frames_in_step();
    assert_eq!(commands_of(&bench, released).await, []);
    gamepad(pressed);
    bench.find("checkbox", "Use gamepad").click();
    let down_before = commands_of(&bench, pressed).await;
    assert_eq!(down_before, [], "down before it was looked at");
    assert_eq!(commands_of(&bench, released).await, []);
    assert_eq!(commands_of(&bench, pressed).await, [held(100, -100)]);
    let back = commands_of(&bench, Some((true, 0.5))).await;
    assert_eq!(back, [adjust(-50, 50)]);
    assert_eq!(commands_of(&bench, Some((false, 0.5))).await, [stop]);
    assert_eq!(commands_of(&bench, pressed).await, [held(100, -100)]);
    assert_eq!(commands_of(&bench, None).await, [stop], "unplugged");
    let plugged_in = commands_of(&bench, pressed).await;
    assert_eq!(plugged_in, [], "down when it is plugged in");
    assert_eq!(commands_of(&bench, released).await, []);
    assert_eq!(commands_of(&bench, pressed).await, [held(100, -100)]);
    bench.find("checkbox", "Use gamepad").click();
    assert_eq!(bench.commands().await, [stop], "the box");
    js_sys::eval("delete navigator.getGamepads; drawsAgain()").unwrap();
}

#[wasm_bindgen_test]
async fn a_move_after_a_stop_starts_nothing() {
    let bench = rover("stopped").await;
    pointer(&bench, "pointerdown", 0.0, 1.0);
    press("Escape");
    let stop = Command::StopAll(StopReason::Operator);
    assert_eq!(bench.commands().await, [held(100, -100), stop]);
    pointer(&bench, "pointermove", 0.0, 0.5);
    pointer(&bench, "pointerup", 0.0, 0.5);
    assert_eq!(bench.commands().await, []);

    // A stop of the bus's own: a motor fell silent, or reports a fault.
    pointer(&bench, "pointerdown", 0.0, 1.0);
    both(
        &bench,
        Activity::Driven {
            setpoint: Setpoint::velocity(SpeedTarget::ZERO),
        },
    );
    assert_eq!(bench.commands().await, [held(100, -100)]);
    both(&bench, Activity::Stopping { confirmed: false });
    assert_eq!(bench.commands().await, [Command::Stop(id(1))]);
    pointer(&bench, "pointermove", 0.0, 0.5);
    assert_eq!(bench.commands().await, []);
    pointer(&bench, "pointerup", 0.0, 0.5);
    // And nothing by a new press, until they stand.
    bench
        .until("the pad to be disabled", || {
            pad(&bench).title().contains("is stopping")
        })
        .await;
    pointer(&bench, "pointerdown", 0.0, 1.0);
    assert_eq!(bench.commands().await, []);
    both(&bench, Activity::Idle);
    until_enabled_pad(&bench).await;
    pointer(&bench, "pointermove", 0.0, 0.5);
    assert_eq!(bench.commands().await, []);
    pointer(&bench, "pointerup", 0.0, 0.5);
    pointer(&bench, "pointerdown", 0.0, 1.0);
    assert_eq!(bench.commands().await, [held(100, -100)]);
    pointer(&bench, "pointerup", 0.0, 1.0);
}

#[wasm_bindgen_test]
async fn a_refusal_ends_the_hold() {
    let bench = rover("refused").await;
    for command in [held(100, -100), adjust(50, -50)] {
        pointer(&bench, "pointerdown", 0.0, 1.0);
        assert_eq!(bench.commands().await, [held(100, -100)]);
        report(&bench, |update| {
            update.motors = vec![standing(1), standing(2)];
            update.notices = vec![Notice::Refused {
                command: command.into(),
                refusal: Refusal::NotDriven(id(2)),
            }];
        });
        assert_eq!(bench.commands().await, [Command::Stop(id(1))]);
        pointer(&bench, "pointermove", 0.0, 0.5);
        pointer(&bench, "pointerup", 0.0, 0.5);
        assert_eq!(bench.commands().await, []);
    }
}
