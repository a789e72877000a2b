//! The setup as a link: copied, and offered with a question to the page that opens it.

use js_sys::{Function, Promise};
use motorlink::Preferences;
use motorlink_messages::{
    ToWorker,
    bus::{Activity, Command, Limits},
    protocol::{Mode, Setpoint, SpeedTarget},
};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{FocusEvent, HtmlInputElement};

use crate::bench::{Bench, motor};

/// `{"motorlink_setup": 1, "speed_limit_rpm": 200, "motors": [{"id": 1, "name": "<b>Bug</b>", "side": "left"}]}`,
/// encoded by Python's `base64.urlsafe_b64encode`.
const LINK: &str = "#setup=eyJtb3Rvcmxpbmtfc2V0dXAiOiAxLCAic3BlZWRfbGltaXRfcnBtIjogMjAwLCAibW90b3JzIjogW3siaWQiOiAxLCAibmFtZSI6ICI8Yj5CdWc8L2I-IiwgInNpZGUiOiAibGVmdCJ9XX0";

fn storage() -> web_sys::Storage {
    web_sys::window().unwrap().local_storage().unwrap().unwrap()
}

/// Nothing is remembered but a speed limit.
fn remember_limit() {
    let limits = Limits::new(100, 2_700, 80).unwrap();
    Preferences {
        limits,
        ..Preferences::default()
    }
    .save();
    storage().remove_item("motorlink.fleet").unwrap();
}

fn forget() {
    Preferences::default().save();
    storage().remove_item("motorlink.fleet").unwrap();
    set_fragment("");
}

fn set_fragment(fragment: &str) {
    let location = web_sys::window().unwrap().location();
    location.set_hash(fragment).unwrap();
}

fn fragment() -> String {
    web_sys::window().unwrap().location().hash().unwrap()
}

fn speed_limit() -> u16 {
    Preferences::load().limits.speed_rpm()
}

async fn until_asked(bench: &Bench) -> String {
    let asks = || !bench.find_all("group", "Setup from a link").is_empty();
    bench.until("the question", asks).await;
    bench.text("group", "Setup from a link")
}

async fn until_said(bench: &Bench, text: &str) {
    let says = || {
        let said = bench.find_all("status", "Setup link");
        said.iter()
            .any(|said| said.text_content().is_some_and(|said| said.contains(text)))
    };
    bench.until(text, says).await;
}

async fn assert_nothing_is_commanded(bench: &Bench) {
    let received = bench.received().await;
    let is_command = |message: &ToWorker| matches!(message, ToWorker::Command { .. });
    assert!(!received.iter().any(is_command), "{received:?}");
}

#[wasm_bindgen_test]
async fn a_page_that_is_opened_by_a_link_asks_and_changes_nothing_before() {
    remember_limit();
    set_fragment(LINK);
    let bench = Bench::with_motor("link-opened", Mode::Velocity).await;
    let asked = until_asked(&bench).await;
    for line in [
        "Speed limit: 100 rpm → 200 rpm (higher limit)",
        "Motor 0x01: no side → <b>Bug</b>, left",
    ] {
        assert!(asked.contains(line), "no {line:?} in {asked}");
    }
    assert_eq!(fragment(), "", "a reload does not ask again");
    assert_eq!(speed_limit(), 100);
    assert_nothing_is_commanded(&bench).await;

    bench.click("Discard");
    until_said(&bench, "Nothing was changed.").await;
    assert!(bench.find_all("group", "Setup from a link").is_empty());
    assert_eq!(speed_limit(), 100);
    assert_nothing_is_commanded(&bench).await;

    // A link that is pasted into the address of an open page.
    set_fragment(LINK);
    until_asked(&bench).await;
    bench.click("Apply setup");
    until_said(&bench, "Imported: limits, 1 motor.").await;
    assert_eq!(speed_limit(), 200);
    assert_eq!(fragment(), "");
    let commands = bench.commands().await;
    let configures = |command: &Command| matches!(command, Command::Configure(_));
    assert!(commands.iter().all(configures), "{commands:?}");
    bench.find("button", "Motor 0x01, <b>Bug</b>, left");
    // The same link again.
    set_fragment(LINK);
    until_said(&bench, "The link has the present setup.").await;
    assert!(bench.find_all("group", "Setup from a link").is_empty());
    forget();
}

#[wasm_bindgen_test]
async fn while_a_motor_is_driven_a_link_is_not_applied() {
    remember_limit();
    let bench = Bench::with_motor("link-driven", Mode::Velocity).await;
    let setpoint = Setpoint::velocity(SpeedTarget::new(50).unwrap());
    bench.report(motor(Mode::Velocity, Activity::Driven { setpoint }), false);
    set_fragment(LINK);
    until_asked(&bench).await;
    let apply = bench.find("button", "Apply setup");
    bench
        .until("the reason", || apply.has_attribute("disabled"))
        .await;
    let title = apply.get_attribute("title").unwrap();
    assert!(title.contains("Motor 0x01 is in use"), "{title}");
    apply.remove_attribute("disabled").unwrap();
    apply.click();
    until_said(&bench, "Nothing was changed. Motor 0x01 is in use").await;
    assert_eq!(speed_limit(), 100);
    assert_nothing_is_commanded(&bench).await;
    forget();
}

#[wasm_bindgen_test]
async fn a_link_that_does_not_fit_changes_nothing_and_says_why() {
    remember_limit();
    let bench = Bench::with_motor("link-refused", Mode::Velocity).await;
    let cut = &LINK[..LINK.len() - 9];
    let long = ["#setup=", &"A".repeat(100_000)].concat();
    for (link, words) in [
        (cut, "The link is incomplete or damaged."),
        ("#setup=%3Cscript%3E", "The link is incomplete or damaged."),
        // {"motorlink_setup": 2}
        (
            "#setup=eyJtb3Rvcmxpbmtfc2V0dXAiOiAyfQ",
            "motorlink_setup: expected 1 (the supported version).",
        ),
        (&long, "Link too long: a setup has at most 64 KB."),
    ] {
        set_fragment(link);
        let taken = || fragment().is_empty();
        bench.until("the link to be taken", taken).await;
        until_said(&bench, &["Nothing was changed. ", words].concat()).await;
        assert!(bench.find_all("group", "Setup from a link").is_empty());
    }
    // Another fragment is not touched.
    bench.click("Close the panel");
    set_fragment("#setups");
    bench.received().await;
    assert_eq!(fragment(), "#setups");
    assert!(bench.find_all("region", "Setup link").is_empty());
    assert_eq!(speed_limit(), 100);
    forget();
}

#[wasm_bindgen_test]
async fn the_link_of_a_page_is_copied_and_opens_as_its_setup() {
    remember_limit();
    let bench = Bench::with_motor("link-copied", Mode::Velocity).await;
    bench.open("Settings").await;
    bench.click("Setup link");
    let shown = || !bench.find_all("button", "Copy link").is_empty();
    bench.until("the panel", shown).await;
    // The test's browser has no focus, without which a clipboard is not written to.
    let run = |script: &str| Function::new_no_args(script).call0(&JsValue::NULL).unwrap();
    run("window.copied = new Promise((resolve) => {
        navigator.clipboard.writeText = async (text) => resolve(text);
    });");
    bench.click("Copy link");
    until_said(&bench, "Link copied").await;
    let copied: Promise = run("return window.copied").unchecked_into();
    let copied = JsFuture::from(copied).await.unwrap().as_string().unwrap();
    let location = web_sys::window().unwrap().location();
    let page = location.origin().unwrap() + &location.pathname().unwrap() + "#setup=";
    assert!(copied.starts_with(&page), "{copied}");
    let field: HtmlInputElement = bench.find("textbox", "Link").unchecked_into();
    assert_eq!(field.value(), copied);
    run(
        "navigator.clipboard.writeText = async () => { throw new DOMException('', 'NotAllowedError'); }",
    );
    bench.click("Copy link");
    until_said(&bench, "Select the link and copy it").await;
    run("delete navigator.clipboard.writeText");

    // In a browser with another limit.
    bench.open("Settings").await;
    let field = bench.enter("Speed limit", "60");
    field
        .dispatch_event(&FocusEvent::new("blur").unwrap())
        .unwrap();
    bench.until("the limit", || speed_limit() == 60).await;
    set_fragment(&copied[copied.find('#').unwrap()..]);
    let asked = until_asked(&bench).await;
    assert!(
        asked.contains("Speed limit: 60 rpm → 100 rpm (higher limit)"),
        "{asked}"
    );
    forget();
}

/// What the page shows, as the end of a link.
fn view_in_link(bench: &Bench) -> String {
    let link = bench.find("textbox", "Link");
    let link: HtmlInputElement = link.dyn_into().unwrap();
    let link = link.value();
    let (_, view) = link.split_once('&').unwrap();
    view.to_owned()
}

#[wasm_bindgen_test]
async fn a_link_shows_the_view_at_once_and_changes_no_setting() {
    remember_limit();
    let bench = Bench::with_motor("link-view", Mode::Velocity).await;
    set_fragment(&format!(
        "{LINK}&motor=1&tab=current&traces=speed.temperature&compared=current&span_ms=10000&new=1"
    ));
    until_asked(&bench).await;
    assert_eq!(
        view_in_link(&bench),
        "motor=1&tab=current&traces=speed.temperature&compared=current&span_ms=10000"
    );
    let tab = bench.find("tab", "Current");
    assert_eq!(tab.get_attribute("aria-selected").as_deref(), Some("true"));
    assert_eq!(speed_limit(), 100);
    assert_nothing_is_commanded(&bench).await;
    bench.click("Discard");
    forget();
}
