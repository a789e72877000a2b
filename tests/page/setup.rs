//! The setup as a file: taken in as a whole or not at all, and never under a hand that drives.

use js_sys::Array;
use motorlink::Preferences;
use motorlink_messages::{
    ToWorker,
    bus::{Activity, BusSettings, Command, CommandRate, Limits, Ramp},
    protocol::{Mode, Setpoint, SpeedTarget, family::Model},
};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{
    DataTransfer, Event, EventInit, File, HtmlInputElement, HtmlSelectElement, Node, Storage,
};

use crate::{
    bench::{Bench, document, motor},
    fake_recorder::FakeRecorder,
    tools::{report, standing},
};

const ROVER: &str = r#"{"motorlink_setup": 1, "model": "ddsm315", "command_rate_hz": 120,
    "keep_driving_while_hidden": false, "ramp_rpm_per_s": 300,
    "temperature_limit_c": 60, "vehicle": {"wheel_radius_mm": 60, "track_width_mm": 420}, "motors": [
    {"id": 1, "name": "Port", "side": "left", "drives_together": true},
    {"id": 2, "name": "Starboard", "side": "right", "drives_together": true}]}"#;

/// Of the same file.
const MEASURES: &str = r#""vehicle": {"wheel_radius_mm": 60, "track_width_mm": 420}, "#;

fn storage() -> Storage {
    web_sys::window().unwrap().local_storage().unwrap().unwrap()
}

/// A page with two motors of which nothing is remembered, and the open panel.
async fn page(name: &str) -> Bench {
    let bench = Bench::with_motor(name, Mode::Velocity).await;
    report(&bench, |update| {
        update.motors = vec![standing(1), standing(2)];
    });
    bench.open("Drive together").await;
    bench
        .until("both rows", || {
            !bench.find_all("checkbox", "Drive 0x02").is_empty()
        })
        .await;
    bench
}

/// Chooses a file with this text, and waits for words about it.
async fn import(bench: &Bench, text: &str) -> String {
    bench.open("Settings").await;
    let said = bench.find("status", "Setup");
    // The result is beside the button, above the next heading.
    let next = bench.find("button", "Delete all data");
    let order = said.compare_document_position(&next);
    assert_ne!(order & Node::DOCUMENT_POSITION_FOLLOWING, 0);
    said.set_text_content(None);
    let parts = Array::of1(&JsValue::from_str(text));
    let file = File::new_with_str_sequence(&parts, "setup.json").unwrap();
    let files = DataTransfer::new().unwrap();
    files.items().add_with_file(&file).unwrap();
    let chooser = document().query_selector("input[accept='.json']").unwrap();
    let chooser: HtmlInputElement = chooser.unwrap().unchecked_into();
    chooser.set_files(files.files().as_ref());
    let init = EventInit::new();
    init.set_bubbles(true);
    let change = Event::new_with_event_init_dict("change", &init).unwrap();
    chooser.dispatch_event(&change).unwrap();
    let words = || said.text_content().unwrap_or_default();
    bench.until("words", || !words().is_empty()).await;
    words()
}

/// What the browser keeps.
fn kept() -> (Preferences, Option<String>, Option<String>) {
    let kept = |name| storage().get_item(name).unwrap();
    (
        Preferences::load(),
        kept("motorlink.fleet"),
        kept("motorlink.ramp"),
    )
}

fn forget() {
    Preferences::default().save();
    for name in ["motorlink.fleet", "motorlink.ramp", "motorlink.rover"] {
        storage().remove_item(name).unwrap();
    }
}

fn value(bench: &Bench, role: &str, name: &str) -> String {
    bench
        .find(role, name)
        .unchecked_into::<HtmlInputElement>()
        .value()
}

/// The fields that are shown: `Wheel radius` and `Track width`, or none.
fn measures(bench: &Bench) -> Vec<String> {
    let fields = ["Wheel radius", "Track width"].into_iter();
    let shown = fields.filter(|name| !bench.find_all("spinbutton", name).is_empty());
    shown.map(|name| value(bench, "spinbutton", name)).collect()
}

#[wasm_bindgen_test]
async fn a_setup_is_taken_in_at_once_and_starts_nothing() {
    forget();
    let bench = page("setup-taken").await;
    // A person has chosen a model before.
    let model: HtmlSelectElement = bench.find("combobox", "Model").unchecked_into();
    model.set_value(Model::Ddsm400.spec().key);
    bench.enter_into("textbox", "Name of 0x01", "Typed");
    bench.received().await;

    let words = import(&bench, ROVER).await;
    assert_eq!(
        words,
        "Imported: model, command rate, keep driving while hidden, ramp, limits, measures of the vehicle, 2 motors."
    );
    let settings = BusSettings {
        rate: CommandRate::new(120).unwrap(),
        ramp: Ramp::new(300).ok(),
        limits: Limits::new(330, 2_700, 60).unwrap(),
        ..BusSettings::default()
    };
    let received = bench.commands().await;
    assert_eq!(received.last(), Some(&Command::Configure(settings)));
    assert_eq!(value(&bench, "spinbutton", "Command rate"), "120");
    bench.open("Drive together").await;
    assert_eq!(value(&bench, "spinbutton", "Ramp"), "300");
    let has_measures = || measures(&bench) == ["60", "420"];
    bench.until("the measures of the file", has_measures).await;
    assert_eq!(value(&bench, "textbox", "Name of 0x01"), "Port");
    let side: HtmlSelectElement = bench.find("combobox", "Side of 0x02").unchecked_into();
    assert_eq!(side.value(), "right");
    let drives: HtmlInputElement = bench.find("checkbox", "Drive 0x02").unchecked_into();
    assert!(drives.checked());
    assert_eq!(model.value(), Model::Ddsm315.spec().key);
    bench.find("button", "Motor 0x02, Starboard, right, mirrored");
    bench.open("Settings").await;
    assert_eq!(value(&bench, "spinbutton", "Temperature limit"), "60");
    let (preferences, fleet, ramp) = kept();
    assert_eq!(preferences.rate.hertz(), 120);
    assert_eq!(preferences.model, Model::Ddsm315);
    assert!(!preferences.keep_driving);
    let fleet = fleet.unwrap();
    assert!(fleet.contains("2\tyes\tright\tStarboard"), "{fleet}");
    assert_eq!(ramp.as_deref(), Some("300"));
    forget();
}

#[wasm_bindgen_test]
async fn deleted_measures_do_not_come_back() {
    forget();
    let _recorder = FakeRecorder::new("setup-erased");
    let bench = page("setup-erased").await;
    import(&bench, ROVER).await;
    bench.click("Delete all data");
    bench
        .until("the question", || {
            !bench.find_all("button", "Delete").is_empty()
        })
        .await;
    bench.click("Delete");
    let without = ROVER.replace(MEASURES, "");
    assert_ne!(without, ROVER);
    import(&bench, &without).await;
    bench.open("Drive together").await;
    bench
        .until("the measures", || !measures(&bench).is_empty())
        .await;
    assert_eq!(measures(&bench), ["51", "300"]);
    forget();
}

#[wasm_bindgen_test]
async fn a_file_that_does_not_fit_changes_nothing() {
    forget();
    let bench = page("setup-refused").await;
    bench.received().await;
    let before = kept();
    let file = ROVER.replace("\"right\"", "\"up\"");
    assert_eq!(
        import(&bench, &file).await,
        "Nothing was changed. motors[1].side: expected \"none\", \"left\" or \"right\"."
    );
    let words = import(&bench, "{\n  \"motorlink_setup\": 1,\n}").await;
    assert!(words.contains("line 3, column 1"), "{words}");
    assert_eq!(kept(), before);
    bench.open("Drive together").await;
    assert_eq!(value(&bench, "textbox", "Name of 0x01"), "");
    let received = bench.received().await;
    assert!(
        !received
            .iter()
            .any(|received| matches!(received, ToWorker::Command { .. })),
        "{received:?}"
    );
    forget();
}

#[wasm_bindgen_test]
async fn while_a_motor_is_driven_no_setup_is_taken_in() {
    forget();
    let bench = page("setup-driven").await;
    let setpoint = Setpoint::velocity(SpeedTarget::new(100).unwrap());
    bench.report(motor(Mode::Velocity, Activity::Driven { setpoint }), false);
    bench.open("Settings").await;
    let button = bench.find("button", "Import setup");
    bench
        .until("the button to say why", || button.has_attribute("disabled"))
        .await;
    let title = button.get_attribute("title").unwrap();
    assert!(title.contains("Motor 0x01 is in use"), "{title}");
    // The file was being chosen when driving began.
    let before = kept();
    let words = import(&bench, ROVER).await;
    assert!(words.contains("Motor 0x01 is in use"), "{words}");
    assert_eq!(kept(), before);
    bench.open("Settings").await;
    let export = bench.find("button", "Export setup");
    assert!(!export.has_attribute("disabled"));
    forget();
}
