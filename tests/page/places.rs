//! The five places of the page, by pointer and by keys.

use motorlink_messages::protocol::Mode;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{KeyboardEvent, KeyboardEventInit};

use crate::{
    bench::{Bench, document, press},
    tools::{report, standing},
};

const PLACES: [(&str, &str); 5] = [
    ("Drive", "drive"),
    ("Record", "record"),
    ("Test", "test"),
    ("Setup", "setup"),
    ("Diagnose", "diagnose"),
];

fn open_place(bench: &Bench) -> String {
    let is_open = |name: &&str| {
        let current = bench.find("button", name).get_attribute("aria-current");
        current.as_deref() == Some("page")
    };
    let open: Vec<&str> = PLACES
        .into_iter()
        .map(|(name, _)| name)
        .filter(is_open)
        .collect();
    open.join(", ")
}

fn shown() -> String {
    let root = document().document_element().unwrap();
    root.get_attribute("data-place").unwrap_or_default()
}

fn press_with_alt(code: &str) {
    let init = KeyboardEventInit::new();
    init.set_key("¡");
    init.set_code(code);
    init.set_alt_key(true);
    init.set_bubbles(true);
    init.set_cancelable(true);
    let event = KeyboardEvent::new_with_keyboard_event_init_dict("keydown", &init).unwrap();
    document().body().unwrap().dispatch_event(&event).unwrap();
}

#[wasm_bindgen_test]
async fn a_place_is_opened_by_its_button_and_by_its_key() {
    let bench = Bench::with_motor("places", Mode::Velocity).await;
    assert_eq!(open_place(&bench), "Drive");
    for (place, (name, key)) in PLACES.into_iter().enumerate().rev() {
        press_with_alt(&format!("Digit{}", place + 1));
        bench.until(name, || shown() == key).await;
        assert_eq!(open_place(&bench), name);
        let title = bench.find("button", name).title();
        assert_eq!(title, format!("{name} (Alt+{})", place + 1));
    }
    for (name, key) in PLACES {
        bench.click(name);
        bench.until(name, || shown() == key).await;
        assert_eq!(open_place(&bench), name);
    }
    press_with_alt("Digit6");
    assert_eq!(open_place(&bench), "Diagnose");
    assert!(bench.commands().await.is_empty(), "nothing is driven");
}

#[wasm_bindgen_test]
async fn the_keys_of_the_controls_start_nothing_where_they_are_not_shown() {
    let bench = Bench::with_motor("places-keys", Mode::Velocity).await;
    for name in ["Record", "Test", "Setup", "Diagnose"] {
        bench.click(name);
        for key in ["f", "b", "1", "5", "c", "p"] {
            press(key);
        }
        assert!(bench.commands().await.is_empty(), "{name}");
    }
    bench.click("Drive");
    press("f");
    assert_eq!(bench.commands().await.len(), 1);
}

#[wasm_bindgen_test]
async fn the_group_is_offered_from_two_motors_on() {
    let bench = Bench::with_motor("places-group", Mode::Velocity).await;
    assert!(bench.find_all("radiogroup", "Drive").is_empty());
    report(&bench, |update| {
        update.motors = vec![standing(1), standing(2)];
    });
    let is_offered = || bench.find_all("radiogroup", "Drive").len() == 1;
    bench.until("the choice", is_offered).await;
    bench.open("Drive together").await;
    bench.find("radio", "Motor").click();
    let is_closed = || bench.find_all("region", "Drive together").is_empty();
    bench.until("the controls of the motor", is_closed).await;
}
