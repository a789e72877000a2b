//! Another language while a motor is driven.

use motorlink_messages::{
    bus::{Activity, Command, StopReason},
    protocol::{Acceleration, Mode, Setpoint, SpeedTarget},
};
use wasm_bindgen::JsCast;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Event, EventInit, HtmlInputElement, HtmlSelectElement};

use crate::bench::{Bench, document, motor, press};

/// Chooses a language in the list of this name.
pub fn choose(bench: &Bench, name: &str, language: &str) {
    let choice: HtmlSelectElement = bench.find("combobox", name).unchecked_into();
    choice.set_value(language);
    let bubbles = EventInit::new();
    bubbles.set_bubbles(true);
    let event = Event::new_with_event_init_dict("change", &bubbles).unwrap();
    choice.dispatch_event(&event).unwrap();
}

#[wasm_bindgen_test]
async fn another_language_changes_the_words_and_nothing_else() {
    let bench = Bench::with_motor("language", Mode::Velocity).await;
    bench.enter("Target speed", "42");
    let setpoint = Setpoint::Velocity {
        speed: SpeedTarget::new(42).unwrap(),
        acceleration: Acceleration::FASTEST,
    };
    bench.report(motor(Mode::Velocity, Activity::Driven { setpoint }), false);
    bench
        .until("the motor to be driven", || {
            bench.text("region", "Wheel").contains("+42 rpm")
        })
        .await;
    bench.received().await;

    choose(&bench, "Language", "de");
    bench
        .until("German words", || {
            !bench.find_all("button", "STOP, alle Motoren").is_empty()
        })
        .await;
    let root = document().document_element().unwrap();
    assert_eq!(root.get_attribute("lang").as_deref(), Some("de"));
    assert!(bench.find_all("button", "STOP all motors").is_empty());
    // Space is to stop the wheel, so the list does not get the focus back.
    let focused = || document().active_element()?.get_attribute("aria-label");
    assert_ne!(focused().as_deref(), Some("Sprache"));
    // Nobody pressed anything that the bus should know of.
    assert_eq!(bench.commands().await, []);
    // What was entered and what is shown stands.
    let speed: HtmlInputElement = bench.find("spinbutton", "Solldrehzahl").unchecked_into();
    assert_eq!(speed.value(), "42");
    press(" ");
    let stop = Command::StopAll(StopReason::Operator);
    assert_eq!(bench.commands().await, [stop]);

    choose(&bench, "Sprache", "en");
    bench
        .until("English words", || {
            !bench.find_all("button", "STOP all motors").is_empty()
        })
        .await;
}

#[wasm_bindgen_test]
async fn at_a_standstill_the_focus_stays_on_the_list() {
    let bench = Bench::with_motor("language-focus", Mode::Velocity).await;
    for (name, language) in [("Language", "de"), ("Sprache", "en")] {
        choose(&bench, name, language);
        let now = if language == "de" {
            "Sprache"
        } else {
            "Language"
        };
        let focused = || document().active_element()?.get_attribute("aria-label");
        bench
            .until("the focus to be back", || focused().as_deref() == Some(now))
            .await;
    }
}
