//! Names and sides, edited where the motors are listed.

use motorlink_messages::{
    bus::Activity,
    protocol::{Setpoint, SpeedTarget},
};
use wasm_bindgen::JsCast;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{HtmlElement, HtmlInputElement, Storage};

use crate::{
    bench::{Bench, document, press, text_of},
    tools::{open, report, standing},
};

const DIALOG: (&str, &str) = ("dialog", "Name and side of motor 0x02");

fn storage() -> Storage {
    web_sys::window().unwrap().local_storage().unwrap().unwrap()
}

/// A page with two motors and the open ID manager.
async fn two_motors(name: &str) -> Bench {
    storage().remove_item("motorlink.fleet").unwrap();
    let bench = open(name, "ID Manager").await;
    report(&bench, |update| {
        update.motors = vec![standing(1), standing(2)];
    });
    bench
        .until("both lists", || {
            bench.find_all("button", DIALOG.1).len() == 2
        })
        .await;
    bench
}

/// The button of motor 0x02 in the strip, or in the list of found motors.
fn edit_button(bench: &Bench, in_strip: bool) -> HtmlElement {
    let mut buttons = bench.find_all("button", DIALOG.1);
    buttons.retain(|button| button.closest(".motor-strip").unwrap().is_some() == in_strip);
    assert_eq!(buttons.len(), 1);
    buttons.remove(0)
}

/// Presses the button as a keyboard does, and waits until the name has the focus.
async fn edit(bench: &Bench, in_strip: bool) -> HtmlInputElement {
    let button = edit_button(bench, in_strip);
    button.focus().unwrap();
    button.click();
    let name = || bench.find_all("textbox", "Name").into_iter().next();
    bench
        .until("the focus in the name", || {
            name().is_some_and(|name| document().active_element() == Some(name.into()))
        })
        .await;
    name().unwrap().unchecked_into()
}

async fn until_focus_is_back(bench: &Bench, in_strip: bool) {
    bench
        .until("the focus on the button", || {
            let focused = document().active_element();
            focused == Some(edit_button(bench, in_strip).into())
        })
        .await;
}

#[wasm_bindgen_test]
async fn a_name_is_given_in_either_list_and_shown_in_every_place() {
    for in_strip in [true, false] {
        let bench = two_motors(&format!("named-{in_strip}")).await;
        let name = edit(&bench, in_strip).await;
        assert_eq!(name.value(), "");
        name.set_value(" Front ");
        bench.find("radio", "right, mirrored").click();
        press("Enter");
        let chip = ("button", "Motor 0x02, Front, right, mirrored");
        bench
            .until("the strip", || bench.find_all(chip.0, chip.1).len() == 1)
            .await;
        let found = text_of(&bench.find("list", "Motors found"));
        assert!(found.contains("0x02 · 2 Front right"), "{found}");
        until_focus_is_back(&bench, in_strip).await;
        bench.open("Drive together").await;
        let row: HtmlInputElement = bench.find("textbox", "Name of 0x02").unchecked_into();
        assert_eq!(row.value(), "Front");
        assert!(bench.find_all(DIALOG.0, DIALOG.1).is_empty());
        let stored = storage().get_item("motorlink.fleet").unwrap().unwrap();
        assert!(stored.contains("2\tno\tright\tFront\t\n"), "{stored}");
        assert_eq!(bench.commands().await, [], "{in_strip}");
    }
    storage().remove_item("motorlink.fleet").unwrap();
}

#[wasm_bindgen_test]
async fn escape_closes_the_name_alone_and_changes_nothing() {
    let bench = two_motors("name-escape").await;
    bench.open("Drive together").await;
    edit(&bench, true).await.set_value("Other");
    press("Escape");
    bench
        .until("no dialog", || {
            bench.find_all(DIALOG.0, DIALOG.1).is_empty()
        })
        .await;
    until_focus_is_back(&bench, true).await;
    assert_eq!(bench.find_all("region", "Drive together").len(), 1);
    assert!(storage().get_item("motorlink.fleet").unwrap().is_none());
    assert_eq!(bench.commands().await, []);
    // The next time, the field has what is stored.
    assert_eq!(edit(&bench, true).await.value(), "");
}

#[wasm_bindgen_test]
async fn a_driven_motor_gets_a_name_and_keeps_its_side_and_the_data_that_comes_moves_nothing() {
    let bench = two_motors("name-driven").await;
    let drive = || {
        report(&bench, |update| {
            let mut second = standing(2);
            second.activity = Activity::Driven {
                setpoint: Setpoint::velocity(SpeedTarget::ZERO),
            };
            update.motors = vec![standing(1), second];
        });
    };
    drive();
    bench.received().await;
    edit_button(&bench, true).click();
    let dialog = || bench.find(DIALOG.0, DIALOG.1);
    // Space stops, because the focus is in no text field.
    bench
        .until("the focus in the dialog", || {
            !bench.find_all(DIALOG.0, DIALOG.1).is_empty()
                && document().active_element() == Some(dialog().into())
        })
        .await;
    let sides = bench.find("radiogroup", "Side");
    assert!(sides.has_attribute("disabled"));
    assert!(text_of(&dialog()).contains("Stop it, then change its side."));
    let name: HtmlInputElement = bench.find("textbox", "Name").unchecked_into();
    name.set_value("Rear");
    let (top, width) = (
        dialog().get_bounding_client_rect().top(),
        dialog().offset_width(),
    );
    drive();
    bench.received().await;
    assert_eq!(name.value(), "Rear");
    assert!((dialog().get_bounding_client_rect().top() - top).abs() < 0.5);
    assert_eq!(dialog().offset_width(), width);
    bench.click("Save");
    bench
        .until("the name", || {
            bench.find_all("button", "Motor 0x02, Rear").len() == 1
        })
        .await;
    assert_eq!(bench.commands().await, []);
    // On another line the name would go to another motor.
    edit_button(&bench, true).click();
    bench
        .until("the dialog", || {
            !bench.find_all(DIALOG.0, DIALOG.1).is_empty()
        })
        .await;
    report(&bench, |update| {
        update.connection = motorlink_messages::Connection::Disconnected;
        update.motors = vec![];
    });
    bench
        .until("no dialog", || {
            bench.find_all(DIALOG.0, DIALOG.1).is_empty()
        })
        .await;
    storage().remove_item("motorlink.fleet").unwrap();
}

#[wasm_bindgen_test]
async fn titles_name_the_selected_motor_where_there_are_several() {
    let bench = two_motors("titles").await;
    let titles = || {
        let all = document().get_elements_by_class_name("motor-title");
        let all = (0..all.length()).filter_map(|place| all.item(place));
        all.map(|title| title.text_content().unwrap_or_default())
            .collect::<Vec<_>>()
    };
    let all_are = |title: &str| {
        let titles = titles();
        let id = title.split_once(' ').map_or(title, |(id, _)| id);
        // The words of the wheel follow its ID.
        let is_it = |it: &String| it == title || it.strip_suffix(" · ") == Some(id);
        titles.len() == 7 && titles.iter().all(is_it)
    };
    bench.until("the motor", || all_are("0x01")).await;
    let name = edit(&bench, true).await;
    name.set_value("Port bow");
    bench.click("Save");
    let chip = || bench.find_all("button", "Motor 0x02, Port bow");
    bench.until("the name", || chip().len() == 1).await;
    chip().remove(0).click();
    // The name does not wrap.
    bench
        .until("the other", || all_are("0x02 Port\u{A0}bow"))
        .await;
    report(&bench, |update| update.motors = vec![standing(2)]);
    bench.until("no title", || all_are("")).await;
    motorlink::Preferences::default().save();
    storage().remove_item("motorlink.fleet").unwrap();
}
