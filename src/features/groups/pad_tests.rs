//! Scenarios of the drive pad.

use super::*;

const FINGER: By = By::Pointer(1);
const AHEAD: Stick = Stick {
    forward: 1.0,
    turn: 0.0,
};
const HALF: Stick = Stick {
    forward: 0.5,
    turn: 0.0,
};

/// Driving is allowed at 100 rpm.
#[allow(clippy::unnecessary_wraps, reason = "the other answer is none")]
fn yes() -> Option<i32> {
    Some(100)
}

fn no() -> Option<i32> {
    None
}

fn straight(rpm: i32) -> Wheels {
    Wheels {
        left: rpm,
        right: rpm,
    }
}

fn held() -> DrivePad {
    let mut pad = DrivePad::default();
    let start = pad.press(FINGER, AHEAD, &yes);
    assert_eq!(start, Some(Order::Start(straight(100))));
    pad
}

#[test]
fn forward_and_turn_are_mixed_within_the_limit() {
    for (turn, forward, left, right) in [
        (0.0, 0.0, 0, 0),
        (0.05, -0.05, 0, 0),
        (0.0, 1.0, 100, 100),
        (0.0, -0.5, -50, -50),
        (1.0, 0.0, 100, -100),
        (-0.5, 0.0, -50, 50),
        (0.25, 0.5, 75, 25),
        (1.0, 1.0, 100, 0),
        (-1.0, -1.0, -100, 0),
        (0.5, 1.0, 100, 33),
        (9.0, 9.0, 100, 0),
        (f64::NAN, 1.0, 100, 100),
    ] {
        let wheels = Stick::new(turn, forward).wheels(100);
        assert_eq!(wheels, Wheels { left, right }, "{turn} {forward}");
    }
    assert_eq!(AHEAD.wheels(0), straight(0));
}

#[test]
fn a_press_starts_moves_adjust_once_a_frame_and_letting_go_stops() {
    let mut pad = held();
    assert_eq!(pad.frame(), None, "nothing has changed");
    pad.steer(FINGER, Stick::default());
    pad.steer(FINGER, HALF);
    assert_eq!(pad.frame(), Some(Order::Adjust(straight(50))));
    assert_eq!(pad.frame(), None);
    assert_eq!(pad.release(FINGER), Some(Order::Stop));
    assert_eq!(pad.release(FINGER), None, "once");
    pad.steer(FINGER, AHEAD);
    assert_eq!(pad.frame(), None);
}

/// However a hold ends: a stick that still moves starts nothing, a new press does.
#[test]
fn a_hold_that_has_ended_is_not_taken_up_by_a_move() {
    type Way = fn(&mut DrivePad) -> Option<Order>;
    let ways: [(&str, Way, Option<Order>); 3] = [
        ("refused", DrivePad::end, Some(Order::Stop)),
        ("focus lost", DrivePad::leave, Some(Order::Stop)),
        (
            "all stopped",
            |pad| {
                pad.stopped();
                None
            },
            None,
        ),
    ];
    for (way, end, order) in ways {
        let mut pad = held();
        assert_eq!(end(&mut pad), order, "{way}");
        pad.steer(FINGER, HALF);
        assert_eq!(pad.frame(), None, "{way}");
        assert_eq!(pad.release(FINGER), None, "{way}");
        let again = pad.press(FINGER, HALF, &yes);
        assert_eq!(again, Some(Order::Start(straight(50))), "{way}");
    }
}

#[test]
fn a_press_that_is_not_allowed_starts_nothing_also_later() {
    let mut pad = DrivePad::default();
    assert_eq!(pad.press(FINGER, AHEAD, &no), None);
    pad.steer(FINGER, HALF);
    assert_eq!(pad.frame(), None);
    assert_eq!(pad.arrow("ArrowUp", true, &no), None);
    assert_eq!(pad.arrow("ArrowLeft", true, &yes), None, "not let go since");
    assert_eq!(pad.arrow("ArrowLeft", false, &yes), None);
    assert_eq!(pad.arrow("ArrowUp", false, &yes), None);
    let start = pad.arrow("ArrowUp", true, &yes);
    assert_eq!(start, Some(Order::Start(straight(100))));
}

#[test]
fn arrows_are_one_stick_that_is_let_go_with_the_last_of_them() {
    let mut pad = DrivePad::default();
    let start = pad.arrow("ArrowUp", true, &yes);
    assert_eq!(start, Some(Order::Start(straight(100))));
    assert_eq!(pad.arrow("ArrowRight", true, &yes), None);
    let curve = Wheels {
        left: 100,
        right: 0,
    };
    assert_eq!(pad.frame(), Some(Order::Adjust(curve)));
    assert_eq!(pad.arrow("ArrowUp", false, &yes), None);
    let spot = Wheels {
        left: 100,
        right: -100,
    };
    assert_eq!(pad.frame(), Some(Order::Adjust(spot)));
    assert_eq!(pad.arrow("Home", false, &yes), None);
    assert_eq!(pad.arrow("ArrowRight", false, &yes), Some(Order::Stop));
}

#[test]
fn keys_that_are_held_when_the_bus_stops_start_nothing_by_another_key() {
    let mut pad = DrivePad::default();
    pad.arrow("ArrowUp", true, &yes);
    assert_eq!(pad.end(), Some(Order::Stop));
    assert_eq!(pad.arrow("ArrowLeft", true, &yes), None);
    assert_eq!(pad.frame(), None);
    // Releases elsewhere are missed, so a lost focus releases all keys.
    assert_eq!(pad.leave(), None);
    assert!(pad.arrow("ArrowUp", true, &yes).is_some());
}

/// Its release was missed, so others may have been missed too.
#[test]
fn a_key_that_goes_down_twice_stops_and_starts_nothing() {
    let mut pad = DrivePad::default();
    assert!(pad.arrow("ArrowUp", true, &yes).is_some());
    assert_eq!(pad.arrow("ArrowRight", true, &yes), None);
    assert_eq!(pad.arrow("ArrowUp", true, &yes), Some(Order::Stop));
    assert_eq!(pad.arrow("ArrowUp", false, &yes), None);
    let again = pad.arrow("ArrowUp", true, &yes);
    assert_eq!(again, Some(Order::Start(straight(100))));
}

#[test]
fn a_pointer_that_is_pressed_twice_stops_and_starts_nothing() {
    let mut pad = held();
    assert_eq!(pad.press(FINGER, HALF, &yes), Some(Order::Stop));
    assert_eq!(pad.frame(), None);
    assert_eq!(pad.release(FINGER), None);
    assert!(pad.press(FINGER, HALF, &yes).is_some());
}

#[test]
fn who_presses_second_has_nothing_even_when_the_first_lets_go() {
    let mut pad = held();
    assert_eq!(pad.arrow("ArrowDown", true, &yes), None);
    assert_eq!(pad.press(By::Pointer(2), HALF, &yes), None);
    pad.steer(By::Pointer(2), HALF);
    assert_eq!(pad.frame(), None);
    assert_eq!(pad.release(By::Pointer(2)), None);
    assert_eq!(pad.release(FINGER), Some(Order::Stop));
    assert_eq!(pad.arrow("ArrowLeft", true, &yes), None);
    assert_eq!(pad.frame(), None);
}

#[test]
fn a_gamepad_drives_while_its_button_is_down() {
    let mut pad = DrivePad::default();
    let up = Some((false, AHEAD));
    let down = |stick| Some((true, stick));
    assert_eq!(pad.gamepad(0, up, &yes), None);
    let start = pad.gamepad(0, down(AHEAD), &yes);
    assert_eq!(start, Some(Order::Start(straight(100))));
    assert_eq!(pad.gamepad(0, down(HALF), &yes), None);
    assert_eq!(pad.frame(), Some(Order::Adjust(straight(50))));
    assert_eq!(pad.gamepad(1, None, &yes), None, "another one");
    assert_eq!(pad.gamepad(0, up, &yes), Some(Order::Stop));
    assert!(pad.gamepad(0, down(AHEAD), &yes).is_some());
    assert_eq!(pad.gamepad(0, None, &yes), Some(Order::Stop), "unplugged");
}

#[test]
fn a_button_that_is_down_when_it_is_first_seen_starts_nothing() {
    let down = Some((true, AHEAD));
    let up = Some((false, AHEAD));
    let mut pad = DrivePad::default();
    for _ in 0..3 {
        assert_eq!(pad.gamepad(0, down, &yes), None, "plugged in so");
    }
    pad.gamepad(0, up, &yes);
    assert!(pad.gamepad(0, down, &yes).is_some());
    assert_eq!(pad.release_gamepads(), Some(Order::Stop));
    for _ in 0..3 {
        assert_eq!(pad.gamepad(0, down, &yes), None, "held all the while");
    }
    pad.gamepad(0, up, &yes);
    assert_eq!(pad.release_gamepads(), None);
    assert_eq!(pad.gamepad(0, down, &yes), None, "pressed unseen");
    // Held when the bus ended it.
    pad.gamepad(0, up, &yes);
    assert!(pad.gamepad(0, down, &yes).is_some());
    assert_eq!(pad.end(), Some(Order::Stop));
    assert_eq!(pad.gamepad(0, down, &yes), None);
    assert_eq!(pad.frame(), None);
}
