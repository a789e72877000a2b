//! The panel `Experiments`, with a worker that notes what is asked of it.

use std::fmt::Write as _;

use motorlink::Preferences;
use motorlink_messages::{
    Adapter, Connection, ToPage, ToWorker,
    bus::Command,
    decode, encode,
    experiments::{
        runner::{Cause, End, Mark, Phase, RecordPart, Sample, Withheld},
        sequence::Sequence,
    },
    protocol::{Current, Instant, Mode, MotorId},
    runs::{FromRun, NotArmed, RunState, ToRun},
};
use wasm_bindgen::JsCast;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Event, EventInit, HtmlInputElement};

use crate::{
    bench::{Bench, document, now, pause, press, text_of},
    limits::leave,
    tools::report,
};

async fn panel(name: &str, mode: Mode) -> Bench {
    let bench = Bench::with_motor(name, mode).await;
    bench.open("Experiments").await;
    let is_loaded = || !bench.find_all("tab", "Sequence").is_empty();
    bench.until("the panel", is_loaded).await;
    bench.received().await;
    bench
}

/// What the run was told since the last call.
async fn told(bench: &Bench) -> Vec<ToRun> {
    let received = bench.received().await.into_iter();
    let runs = received.filter_map(|message| match message {
        ToWorker::Run { message, .. } => Some(decode(&message).unwrap()),
        _ => None,
    });
    runs.collect()
}

fn say(bench: &Bench, message: &FromRun) {
    bench.post(&ToPage::Run(encode(message).unwrap()));
}

fn state(run: u32, phase: Phase, began: Option<Instant>) -> FromRun {
    FromRun::State(RunState {
        run,
        now: now(),
        phase,
        began,
        passed: std::time::Duration::from_secs(1),
        step: 0,
    })
}

fn armed(run: u32) -> FromRun {
    let until = now() + std::time::Duration::from_secs(60);
    state(run, Phase::Armed { until }, None)
}

fn is_disabled(bench: &Bench, name: &str) -> bool {
    in_panel(bench, name)[0].has_attribute("disabled")
}

/// Arms what the tab asks, and returns the message.
async fn arm(bench: &Bench) -> (u32, Sequence) {
    bench
        .until("Arm to be possible", || !is_disabled(bench, "Arm"))
        .await;
    bench.click("Arm");
    let told = told(bench).await;
    let [ToRun::Arm { run, sequence, .. }] = told.as_slice() else {
        panic!("{told:?}")
    };
    (*run, Sequence::from_json(sequence).unwrap())
}

/// The buttons of this name in the panel: the packet log has a button `Pause` too.
fn in_panel(bench: &Bench, name: &str) -> Vec<web_sys::HtmlElement> {
    let mut found = bench.find_all("button", name);
    found.retain(|button| button.closest(".experiments").unwrap().is_some());
    found
}

fn cell(name: &str) -> HtmlInputElement {
    let found = document()
        .query_selector(&format!("[data-cell='{name}']"))
        .unwrap();
    found.unwrap().unchecked_into()
}

fn change(cell: &HtmlInputElement, text: &str) {
    cell.set_value(text);
    let options = EventInit::new();
    options.set_bubbles(true);
    let event = Event::new_with_event_init_dict("change", &options).unwrap();
    cell.dispatch_event(&event).unwrap();
}

#[wasm_bindgen_test]
async fn arming_shows_what_will_move_and_only_run_starts_it() {
    let bench = panel("experiments-arm", Mode::Velocity).await;
    assert!(is_disabled(&bench, "Run"), "nothing is armed");
    let (number, sequence) = arm(&bench).await;
    assert!(!sequence.steps.is_empty());
    assert!(is_disabled(&bench, "Run"), "the worker has not armed it");
    say(&bench, &armed(number));
    bench.until("Run", || !is_disabled(&bench, "Run")).await;
    let shown = text_of(&bench.find("region", "Experiments"));
    for words in [
        "Motor 0x01: \u{2212}100 to +100 rpm, velocity loop",
        "Limits: 330 rpm, 2.7 A, 75 °C.",
        "1 min 20 s",
        "200 setpoints a second",
    ] {
        assert!(shown.contains(words), "{words}: {shown}");
    }
    assert!(told(&bench).await.is_empty(), "nothing starts by itself");
    press("Tab");
    bench.find("button", "Run").focus().unwrap();
    bench.click("Run");
    let told_now = told(&bench).await;
    assert_eq!(told_now, [ToRun::Start { run: number }]);
    say(&bench, &state(number, Phase::Running, Some(now())));
    bench.until("Pause", || !is_disabled(&bench, "Pause")).await;
    assert!(is_disabled(&bench, "Run") && is_disabled(&bench, "Arm"));
    let focused = || document().active_element().and_then(|at| at.text_content());
    let is_on_pause = || focused().as_deref() == Some("Pause");
    bench.until("the focus on Pause", is_on_pause).await;
    in_panel(&bench, "Pause")[0].click();
    assert_eq!(told(&bench).await, [ToRun::Pause]);
    say(&bench, &state(number, Phase::Paused, Some(now())));
    bench
        .until("Resume", || !bench.find_all("button", "Resume").is_empty())
        .await;
    bench.click("Resume");
    assert!(
        told(&bench).await.is_empty(),
        "the second click of a double click on Pause"
    );
    pause(700).await;
    bench.click("Resume");
    assert_eq!(told(&bench).await, [ToRun::Resume]);
    let (cause, at) = (Cause::Stopped, now());
    say(
        &bench,
        &state(
            number,
            Phase::Ended(End::Aborted { cause, at }),
            Some(now()),
        ),
    );
    let is_said = || {
        bench
            .text("status", "Result of the run")
            .contains("stopped by you")
    };
    bench.until("the cause", is_said).await;
    assert!(
        is_disabled(&bench, "Run"),
        "another run needs another arm step"
    );
    assert!(told(&bench).await.is_empty());
}

#[wasm_bindgen_test]
async fn a_run_above_the_speed_limit_is_refused_before_it_is_armed() {
    let bench = panel("experiments-too-fast", Mode::Velocity).await;
    bench.until("Arm", || !is_disabled(&bench, "Arm")).await;
    bench.open("Settings").await;
    leave(&bench.enter("Speed limit", "60"));
    bench.open("Experiments").await;
    bench
        .until("the reason", || is_disabled(&bench, "Arm"))
        .await;
    let title = in_panel(&bench, "Arm")[0].title();
    assert!(title.contains("speed limit of 60 rpm"), "{title}");
    bench.open("Settings").await;
    leave(&bench.enter("Speed limit", "330"));
}

#[wasm_bindgen_test]
async fn a_changed_question_disarms_and_a_refusal_is_said() {
    let bench = panel("experiments-disarm", Mode::Velocity).await;
    let (number, _) = arm(&bench).await;
    say(&bench, &armed(number));
    bench.until("Run", || !is_disabled(&bench, "Run")).await;
    change(&cell("1:value"), "60");
    assert_eq!(told(&bench).await, [ToRun::Abort]);
    assert!(is_disabled(&bench, "Run"));
    let (number, sequence) = arm(&bench).await;
    assert!(sequence.to_json().contains("60"));
    let reason = NotArmed::Halted;
    say(
        &bench,
        &FromRun::NotArmed {
            run: number,
            reason,
        },
    );
    let is_said = || {
        bench
            .text("status", "Result of the run")
            .contains("Release")
    };
    bench.until("the refusal", is_said).await;
    // A late answer to another request arms nothing.
    say(&bench, &armed(number.wrapping_sub(1)));
    pause(100).await;
    assert!(is_disabled(&bench, "Run"));
}

#[wasm_bindgen_test]
async fn another_limit_disarms_because_the_summary_names_it() {
    let bench = panel("experiments-limit", Mode::Velocity).await;
    let (number, _) = arm(&bench).await;
    say(&bench, &armed(number));
    bench.until("Run", || !is_disabled(&bench, "Run")).await;
    bench.open("Settings").await;
    leave(&bench.enter("Speed limit", "200"));
    assert!(told(&bench).await.contains(&ToRun::Abort));
    Preferences::default().save();
}

#[wasm_bindgen_test]
async fn a_field_that_is_no_number_cannot_be_armed_with_the_number_before() {
    let bench = panel("experiments-field", Mode::Velocity).await;
    bench.find("tab", "Step response").click();
    let is_shown = || !bench.find_all("spinbutton", "Hold").is_empty();
    bench.until("the field", is_shown).await;
    bench.until("Arm", || !is_disabled(&bench, "Arm")).await;
    bench.enter("Hold", "5o");
    bench
        .until("the block", || is_disabled(&bench, "Arm"))
        .await;
    let shown = text_of(&bench.find("region", "Experiments"));
    assert!(shown.contains("Hold: enter a number."), "{shown}");
    bench.find("tab", "Frequency response").click();
    let is_other = || !bench.find_all("spinbutton", "Points").is_empty();
    bench.until("the other tab", is_other).await;
    bench.find("tab", "Step response").click();
    bench
        .until("Arm with the shown number", || !is_disabled(&bench, "Arm"))
        .await;
}

#[wasm_bindgen_test]
async fn a_wrong_step_is_named_in_its_cell_and_cannot_be_armed() {
    let bench = panel("experiments-wrong", Mode::Velocity).await;
    change(&cell("2:value"), "400");
    let is_said = || {
        bench
            .text("status", "Sequence check")
            .contains("Row 3: 400 is above 330")
    };
    bench.until("the error", is_said).await;
    let is_marked = || cell("2:value").get_attribute("aria-invalid").as_deref() == Some("true");
    bench.until("the mark", is_marked).await;
    assert!(is_disabled(&bench, "Arm") && is_disabled(&bench, "Run"));
    change(&cell("2:value"), "fast");
    let is_said = || {
        bench
            .text("status", "Sequence check")
            .contains("expected a number")
    };
    bench.until("the other error", is_said).await;
    assert!(is_disabled(&bench, "Save sequence"));
    change(&cell("2:value"), "100");
    bench.until("Arm", || !is_disabled(&bench, "Arm")).await;
    assert!(told(&bench).await.is_empty());
}

#[wasm_bindgen_test]
async fn another_loop_is_named_with_the_switch_that_helps() {
    let bench = panel("experiments-loop", Mode::Current).await;
    assert!(is_disabled(&bench, "Arm"));
    bench.click("Switch motor 0x01 to the velocity loop");
    let commands = bench.commands().await;
    assert!(
        matches!(
            commands.as_slice(),
            [Command::SwitchMode {
                mode: Mode::Velocity,
                ..
            }]
        ),
        "{commands:?}"
    );
}

#[wasm_bindgen_test]
async fn the_tabs_follow_the_arrow_keys_and_each_study_can_be_armed() {
    let bench = panel("experiments-tabs", Mode::Velocity).await;
    bench.find("tab", "Sequence").focus().unwrap();
    press("ArrowRight");
    let selected = |name| {
        bench
            .find("tab", name)
            .get_attribute("aria-selected")
            .as_deref()
            == Some("true")
    };
    bench
        .until("the next tab", || selected("Step response"))
        .await;
    bench.enter("To", "80");
    bench.enter("Repeats", "2");
    pause(100).await;
    let (_, sequence) = arm(&bench).await;
    assert!(sequence.to_json().contains("80"), "{}", sequence.to_json());
    bench.find("tab", "Step response").focus().unwrap();
    press("End");
    bench.until("the last tab", || selected("Code")).await;
    assert_eq!(
        told(&bench).await,
        [ToRun::Abort],
        "another question disarms"
    );
    press("Home");
    bench.until("the first tab", || selected("Sequence")).await;
}

/// A repeat holds all steps of the first table: one press removes them all.
#[wasm_bindgen_test]
async fn each_change_of_the_steps_is_taken_back_by_undo() {
    let bench = panel("removed", Mode::Velocity).await;
    let count = || bench.find("grid", "Steps").get_attribute("aria-rowcount");
    let undo = || {
        bench
            .find_all("button", "Undo")
            .into_iter()
            .find(|undo| undo.closest(".run-buttons").unwrap().is_some())
            .unwrap()
    };
    let before = count();
    assert!(undo().has_attribute("disabled"));
    bench.click("Remove");
    bench.until("the removal", || count() != before).await;
    bench
        .until("an undo", || !undo().has_attribute("disabled"))
        .await;
    undo().click();
    bench.until("the steps", || count() == before).await;
    // Each press takes back one change.
    bench.click("Add step");
    bench.until("a step", || count() != before).await;
    let one_more = count();
    bench.click("Add step");
    bench.until("another", || count() != one_more).await;
    undo().click();
    bench.until("one less", || count() == one_more).await;
    undo().click();
    bench.until("the steps", || count() == before).await;
    assert!(undo().has_attribute("disabled"));
}

#[wasm_bindgen_test]
async fn ten_thousand_steps_do_not_fill_the_page() {
    let bench = panel("experiments-long", Mode::Velocity).await;
    let mut rows = "time_s,rpm\n".to_owned();
    for row in 0..10_000 {
        writeln!(rows, "{}.{:02},{}", row / 50, row % 50 * 2, row % 100).unwrap();
    }
    let input = document()
        .query_selector(".experiment-fields input[type=file]")
        .unwrap()
        .unwrap();
    choose_file(&input, "long.csv", &rows);
    let count = || bench.find("grid", "Steps").get_attribute("aria-rowcount");
    bench
        .until("the rows", || count().as_deref() == Some("10001"))
        .await;
    let drawn = document().query_selector_all(".step-row").unwrap();
    assert!(drawn.length() < 100, "{} rows are drawn", drawn.length());
    // A file that is wrong changes nothing.
    choose_file(
        &input,
        "wrong.json",
        r#"{ "motorlink_sequence": 1, "steps": [{ "rpm": 1 }] }"#,
    );
    let is_said = || {
        bench
            .text("status", "Result of the run")
            .contains("steps[0].for_s")
    };
    bench.until("the refusal", is_said).await;
    assert_eq!(count().as_deref(), Some("10001"));
    assert!(told(&bench).await.is_empty());
}

fn choose_file(input: &web_sys::Element, name: &str, content: &str) {
    let script = "const files = new DataTransfer();
        files.items.add(new File([content], name));
        input.files = files.files;
        input.dispatchEvent(new Event('change'));";
    let choose = js_sys::Function::new_with_args("input, name, content", script);
    let choose = choose.call3(
        &wasm_bindgen::JsValue::NULL,
        input,
        &name.into(),
        &content.into(),
    );
    choose.unwrap();
}

/// A run of the study "When frames cease" whose motor keeps its last command.
fn silence_part(began: Instant) -> RecordPart {
    let at = |ms: u64| began + std::time::Duration::from_millis(ms);
    let marks = [0, 2_000, 2_600, 4_600, 5_200].into_iter().enumerate();
    let is_asked = |ms: &u64| !(4_600..5_200).contains(ms);
    let sample = |ms| Sample {
        id: MotorId::FIRST,
        at: at(ms),
        rpm: Some(30),
        current: Some(Current::from_amps(0.2)),
        degrees: None,
        celsius: Some(30),
    };
    RecordPart {
        samples: (0..5_400)
            .step_by(10)
            .filter(is_asked)
            .map(sample)
            .collect(),
        sent: Vec::new(),
        marks: marks.map(|(step, ms)| Mark { at: at(ms), step }).collect(),
    }
}

#[wasm_bindgen_test]
async fn when_frames_cease_is_armed_with_its_warning_and_its_result_is_in_the_row() {
    let bench = panel("experiments-silence", Mode::Velocity).await;
    // One virtual motor shares the names of the real line: what it does is not remembered.
    report(&bench, |update| {
        update.connection = Connection::Connected(Adapter::Serial(None));
    });
    bench.received().await;
    let row = || {
        let list = document().query_selector(".found-list");
        list.unwrap().unwrap().text_content().unwrap()
    };
    bench
        .until("the row", || row().contains("not tested"))
        .await;
    bench.find("tab", "Characterise").click();
    let kind = || bench.find_all("button", "When frames cease").pop();
    bench.until("the kinds", || kind().is_some()).await;
    bench.click("When frames cease");
    let pressed = || kind()?.get_attribute("aria-pressed");
    bench
        .until("the kind", || pressed().as_deref() == Some("true"))
        .await;
    bench.until("Arm", || !is_disabled(&bench, "Arm")).await;
    bench.click("Arm");
    let asked = told(&bench).await;
    let [ToRun::Arm { run, options, .. }] = asked.as_slice() else {
        panic!("{asked:?}")
    };
    assert_eq!(options.silent_steps.get(1), Some(Withheld::DriveFrames));
    assert_eq!(options.silent_steps.get(3), Some(Withheld::Requests));
    say(&bench, &armed(*run));
    bench.until("Run", || !is_disabled(&bench, "Run")).await;
    let shown = text_of(&bench.find("region", "Experiments"));
    for words in [
        "Motor 0x01: 0 to +30 rpm, velocity loop",
        "It takes 5.4 s.",
        "Frames cease for 0.6 s, twice. The wheel may keep turning meanwhile",
    ] {
        assert!(shown.contains(words), "{words}: {shown}");
    }
    bench.click("Run");
    assert_eq!(told(&bench).await, [ToRun::Start { run: *run }]);
    let began = now();
    say(&bench, &state(*run, Phase::Running, Some(began)));
    let part = silence_part(began);
    say(&bench, &FromRun::Part { run: *run, part });
    let at = began + std::time::Duration::from_millis(5_400);
    say(
        &bench,
        &state(*run, Phase::Ended(End::Finished { at }), Some(began)),
    );
    let is_kept = || row().contains("keeps its last command");
    bench.until("the result in the row", is_kept).await;
    let result = || bench.text("status", "When frames cease");
    bench
        .until("the figures", || {
            result().contains("keeps its last command")
        })
        .await;
    let storage = web_sys::window().unwrap().local_storage().unwrap();
    storage.unwrap().remove_item("motorlink.fleet").unwrap();
}
