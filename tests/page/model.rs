//! The page follows the model: tabs, ranges, words, and the choice itself.

use motorlink::Preferences;
use motorlink_messages::{
    Adapter, Connection, ModelChoice, ToWorker, Update,
    bus::{Activity, Command, Consent, LineStatus},
    protocol::{Mode, MotorId, OpenLoopTarget, Setpoint, SpeedTarget, family::Model},
};
use wasm_bindgen::JsCast;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Event, HtmlSelectElement};

use crate::{
    bench::{Bench, motor, text_of},
    tools::report,
};

const PORT: Connection = Connection::Connected(Adapter::Serial(None));

/// A serial port with motors that answer as this model.
fn line(model: Model) -> impl FnOnce(&mut Update) {
    move |update| {
        update.connection = PORT;
        update.line = Some(LineStatus {
            model,
            model_known: true,
            ..LineStatus::default()
        });
    }
}

fn tabs(bench: &Bench) -> Vec<String> {
    let names = ["Velocity", "Current", "Position", "Open loop"];
    let there = names.map(|name| bench.find_all("tab", name));
    there.iter().flatten().map(text_of).collect()
}

fn is_chosen(bench: &Bench, tab: &str) -> bool {
    let chosen = bench.find("tab", tab).get_attribute("aria-selected");
    chosen.as_deref() == Some("true")
}

fn select(bench: &Bench) -> HtmlSelectElement {
    bench.find("combobox", "Model").unchecked_into()
}

fn choose(bench: &Bench, key: &str) {
    select(bench).set_value(key);
    let change = Event::new("change").unwrap();
    select(bench).dispatch_event(&change).unwrap();
}

fn limit_of(bench: &Bench, role: &str, name: &str, attribute: &str) -> String {
    let field = bench.find(role, name);
    field.get_attribute(attribute).unwrap_or_default()
}

#[wasm_bindgen_test]
async fn tabs_and_ranges_are_those_of_the_model() {
    Preferences::default().save();
    let bench = Bench::with_motor("model-tabs", Mode::Velocity).await;
    for (model, loops, rpm_max) in [
        (Model::Ddsm210, "Velocity, Position, Open loop", "210"),
        (
            Model::Ddsm400,
            "Velocity, Current, Position, Open loop",
            "380",
        ),
        (Model::Ddsm315, "Velocity, Current, Position", "315"),
        (Model::Ddsm115, "Velocity, Current, Position", "330"),
    ] {
        report(&bench, line(model));
        let max = || limit_of(&bench, "spinbutton", "Target speed", "aria-valuemax");
        bench.until("the range", || max() == rpm_max).await;
        assert_eq!(tabs(&bench).join(", "), loops, "{model}");
        // The limit of Settings is 330 rpm.
        let slider = limit_of(&bench, "slider", "Target speed", "max");
        let limited = if rpm_max == "380" { "330" } else { rpm_max };
        assert_eq!(slider, limited, "{model}");
        let key = model.spec().key;
        assert!(model == Model::Ddsm315 || select(&bench).value() == key);
    }
    Preferences::default().save();
}

#[wasm_bindgen_test]
async fn a_tab_that_the_model_does_not_have_gives_way_to_velocity() {
    Preferences::default().save();
    let bench = Bench::with_motor("model-tab-gone", Mode::Velocity).await;
    report(&bench, line(Model::Ddsm400));
    bench
        .until("the model", || {
            !bench.find_all("tab", "Open loop").is_empty()
        })
        .await;
    bench.find("tab", "Current").click();
    bench
        .until("Current", || is_chosen(&bench, "Current"))
        .await;
    let reach = limit_of(&bench, "spinbutton", "Target current", "aria-valuemax");
    assert_eq!(reach, "4.00");
    let end = limit_of(&bench, "slider", "Target current", "max");
    assert_eq!(end, "11058", "the limit of Settings, 2.7 A");
    report(&bench, line(Model::Ddsm210));
    bench
        .until("Velocity", || is_chosen(&bench, "Velocity"))
        .await;
    let current = || bench.text("status", "Current");
    bench
        .until("the mark", || current().contains("scale uncertain"))
        .await;
    assert!(!current().contains(" A"), "{}", current());
    Preferences::default().save();
}

#[wasm_bindgen_test]
async fn the_open_loop_drives_at_a_raw_output() {
    Preferences::default().save();
    let bench = Bench::with_motor("model-open-loop", Mode::Velocity).await;
    report(&bench, |update| {
        line(Model::Ddsm210)(update);
        update.motors = vec![motor(Mode::OpenLoop, Activity::Idle)];
    });
    bench
        .until("the tab", || !bench.find_all("tab", "Open loop").is_empty())
        .await;
    bench.find("tab", "Open loop").click();
    bench
        .until("Open loop", || is_chosen(&bench, "Open loop"))
        .await;
    bench.received().await;
    bench.enter("Target output", "-3276");
    bench.click("Start");
    let start = |raw| Command::Start {
        id: MotorId::FIRST,
        setpoint: Setpoint::OpenLoop(OpenLoopTarget::new(raw).unwrap()),
        consent: Consent::None,
    };
    assert_eq!(bench.commands().await, [start(-3_276)]);
    bench.click("0 %");
    assert_eq!(bench.commands().await, [start(0)]);
    let field = bench.enter("Target output", "32768");
    bench
        .until("the range", || {
            field.get_attribute("aria-invalid").as_deref() == Some("true")
        })
        .await;
    Preferences::default().save();
}

#[wasm_bindgen_test]
async fn the_found_model_is_chosen_and_another_one_opens_the_port_again() {
    Preferences::default().save();
    let bench = Bench::with_motor("model-chosen", Mode::Velocity).await;
    report(&bench, line(Model::Ddsm400));
    bench
        .until("the model", || select(&bench).value() == "ddsm400")
        .await;
    assert_eq!(Preferences::load().model, Model::Ddsm400);
    // Only the person tells these two apart.
    report(&bench, line(Model::Ddsm115));
    bench
        .until("the model", || select(&bench).value() == "ddsm115")
        .await;
    bench.received().await;
    choose(&bench, "ddsm315");
    let opened = bench.received().await.into_iter().find_map(|to| match to {
        ToWorker::ConnectSerial { model, .. } => Some(model),
        _ => None,
    });
    let choice = ModelChoice {
        model: Model::Ddsm315,
        detect: true,
    };
    assert_eq!(opened, Some(choice));
    report(&bench, line(Model::Ddsm115));
    bench.received().await;
    assert_eq!(Preferences::load().model, Model::Ddsm315, "still chosen");

    let setpoint = Setpoint::velocity(SpeedTarget::new(50).unwrap());
    report(&bench, |update| {
        line(Model::Ddsm115)(update);
        update.motors = vec![motor(Mode::Velocity, Activity::Driven { setpoint })];
    });
    bench
        .until("the reason", || select(&bench).disabled())
        .await;
    assert!(select(&bench).title().contains("Stop all motors first"));
    // The list was open when driving began.
    choose(&bench, "ddsm210");
    assert_eq!(select(&bench).value(), "ddsm115");
    assert_eq!(bench.received().await, []);
    Preferences::default().save();
}

#[wasm_bindgen_test]
async fn without_detection_the_worker_is_told_so() {
    Preferences::default().save();
    let bench = Bench::with_motor("model-detect", Mode::Velocity).await;
    bench.open("Settings").await;
    bench.find("checkbox", "Detect the model").click();
    assert!(!Preferences::load().detect_model);
    Preferences::default().save();
}
