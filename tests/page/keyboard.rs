//! The keys that stop, whatever has the focus.

use motorlink_messages::{
    bus::{Activity, Command, StopReason},
    protocol::{Mode, Rpm, Setpoint, SpeedTarget},
};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::{
    bench::{Bench, dispatch_key, document, motor, pause, press},
    tools::report,
};

const STOP_ALL: Command = Command::StopAll(StopReason::Operator);

/// A page with a motor that is driven at 50 rpm, and what drives it backwards has the focus.
async fn driven(name: &str) -> Bench {
    let bench = Bench::with_motor(name, Mode::Velocity).await;
    let setpoint = Setpoint::velocity(SpeedTarget::new(50).unwrap());
    bench.report(motor(Mode::Velocity, Activity::Driven { setpoint }), false);
    until_titled(&bench, "+50 rpm").await;
    focus(&bench, "button", "-100");
    bench
}

async fn until_titled(bench: &Bench, said: &str) {
    bench
        .until(said, || document().title().contains(said))
        .await;
}

async fn until_it_stands(bench: &Bench) {
    bench.report(motor(Mode::Velocity, Activity::Idle), false);
    bench
        .until("standstill", || document().title() == "MotorLink")
        .await;
}

fn focus(bench: &Bench, role: &str, name: &str) {
    bench.find(role, name).focus().unwrap();
}

#[wasm_bindgen_test]
async fn space_while_driven_stops_whatever_has_the_focus() {
    let bench = driven("space-driven").await;
    for (role, name) in [
        ("button", "-100"),
        ("button", "Start"),
        ("checkbox", "Auto-scroll"),
        ("combobox", "Motor"),
        ("slider", "Target speed"),
        ("spinbutton", "Target speed"),
        ("spinbutton", "Command rate"),
    ] {
        focus(&bench, role, name);
        assert!(!dispatch_key("keydown", " ", false), "{name}");
        assert!(!dispatch_key("keyup", " ", false), "{name}");
        assert_eq!(bench.commands().await, [STOP_ALL], "{name}");
    }
    focus(&bench, "searchbox", "Filter");
    assert!(dispatch_key("keydown", " ", false));
    assert!(dispatch_key("keyup", " ", false));
    assert_eq!(bench.commands().await, []);
}

/// Space stops then.
#[wasm_bindgen_test]
async fn enter_ticks_a_box_while_a_motor_is_driven() {
    let bench = driven("enter-box").await;
    focus(&bench, "checkbox", "Auto-scroll");
    let ticked = || {
        let found = document().query_selector("[type=checkbox]:focus:checked");
        found.unwrap().is_some()
    };
    assert!(ticked());
    for expected in [false, true] {
        dispatch_key("keydown", "Enter", false);
        // Held, it is one press.
        dispatch_key("keydown", "Enter", true);
        assert_eq!(ticked(), expected);
    }
    assert_eq!(bench.commands().await, []);
}

/// A browser presses a button when Space comes up.
#[wasm_bindgen_test]
async fn a_space_that_stopped_presses_nothing_when_it_comes_up_behind_the_standstill() {
    let bench = driven("space-up").await;
    assert!(!dispatch_key("keydown", " ", false));
    until_it_stands(&bench).await;
    assert!(!dispatch_key("keydown", " ", true));
    assert!(!dispatch_key("keyup", " ", false));
    assert_eq!(bench.commands().await, [STOP_ALL]);
    // Standing, the button has it.
    assert!(dispatch_key("keydown", " ", false));
    assert!(dispatch_key("keyup", " ", false));
    assert_eq!(bench.commands().await, []);
}

#[wasm_bindgen_test]
async fn space_stops_what_moves_though_no_setpoint_stands() {
    let bench = driven("space-moves").await;
    for (what, activity, rpm) in [
        ("coasting", Activity::Idle, -40),
        ("switching", Activity::Switching { to: Mode::Current }, 0),
        ("raw", Activity::DrivenRaw, 0),
    ] {
        let mut moving = motor(Mode::Velocity, activity);
        moving.speed = moving.speed.map(|(at, _)| (at, Rpm::new(rpm)));
        bench.report(moving, false);
        bench.received().await;
        assert!(!dispatch_key("keydown", " ", false), "{what}");
        assert!(!dispatch_key("keyup", " ", false), "{what}");
        assert_eq!(bench.commands().await, [STOP_ALL], "{what}");
    }
}

/// The worker tells of it with the next frame of the screen only.
#[wasm_bindgen_test]
async fn space_right_behind_a_start_stops() {
    let bench = Bench::with_motor("space-early", Mode::Velocity).await;
    bench.click("+50");
    focus(&bench, "button", "-100");
    assert!(!dispatch_key("keydown", " ", false));
    let commands = bench.commands().await;
    assert!(
        matches!(commands.as_slice(), [Command::Start { .. }, STOP_ALL]),
        "{commands:?}"
    );
}

/// An open list of the browser's own tells of no key that goes down, but of Escape that comes up.
#[wasm_bindgen_test]
async fn an_escape_that_only_comes_up_stops_what_is_driven() {
    let bench = driven("escape-up").await;
    focus(&bench, "combobox", "Motor");
    dispatch_key("keyup", "Escape", false);
    assert_eq!(bench.commands().await, [STOP_ALL]);
    press("Escape");
    dispatch_key("keyup", "Escape", false);
    assert_eq!(bench.commands().await, [STOP_ALL], "once");
    until_it_stands(&bench).await;
    dispatch_key("keyup", "Escape", false);
    assert_eq!(bench.commands().await, [], "at a standstill");
}

/// What is typed to find an option of a list drives nothing.
#[wasm_bindgen_test]
async fn letters_in_a_list_drive_nothing() {
    let bench = Bench::with_motor("letters-list", Mode::Velocity).await;
    report(&bench, |_| ());
    focus(&bench, "combobox", "Motor");
    for key in ["1", "f", "b", "c"] {
        assert!(dispatch_key("keydown", key, false), "{key}");
    }
    assert_eq!(bench.commands().await, []);
}

#[wasm_bindgen_test]
async fn what_was_refused_because_of_a_stop_is_withdrawn_by_release() {
    let bench = Bench::with_motor("refused-release", Mode::Velocity).await;
    bench.report(motor(Mode::Velocity, Activity::Idle), true);
    bench
        .until("Stopped", || {
            !bench.find_all("alertdialog", "Stopped").is_empty()
        })
        .await;
    press("f");
    let is_told = || {
        let text = document().body().unwrap().inner_text();
        text.contains("Motor 0x01 not started")
    };
    bench.until("the refusal", is_told).await;
    bench.click("Release");
    bench.until("no refusal", || !is_told()).await;
}

/// Tab behind the last control leaves the page, as far as the page can see: nothing has the focus.
#[wasm_bindgen_test]
async fn a_control_that_is_left_does_not_get_the_focus_back_and_one_that_is_hidden_passes_it_on() {
    let bench = Bench::with_motor("focus-left", Mode::Velocity).await;
    let focused = || document().active_element().unwrap().tag_name();
    let pause_button = bench.find("button", "Pause");
    pause_button.focus().unwrap();
    dispatch_key("keydown", "Tab", false);
    pause_button.blur().unwrap();
    pause(100).await;
    assert_eq!(focused(), "BODY");

    pause_button.focus().unwrap();
    pause_button.set_hidden(true);
    bench
        .until("the graph has it", || focused() == "SECTION")
        .await;
    pause_button.set_hidden(false);
}
