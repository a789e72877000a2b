//! The ID manager: scans, the list of motors, and the way to a new ID.

use motorlink_messages::{
    Adapter, Connection, Notice, ToPage, ToWorker, Update,
    bus::{
        Activity, Command, IdChangeOutcome, IdQueryOutcome, JobStatus, MotorStatus, ScanReport,
        SetIdFrames, StopReason,
    },
    protocol::{AssignableId, Instant, Mode, MotorId},
};
use wasm_bindgen::JsCast;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::HtmlElement;

use crate::bench::{Bench, document, motor, press};

const QUESTION: (&str, &str) = ("alertdialog", "Change the ID?");

pub fn id(id: u8) -> MotorId {
    MotorId::new(id).unwrap()
}

fn new_id(to: u8) -> AssignableId {
    AssignableId::new(id(to)).unwrap()
}

/// Standing, and answering under this ID.
pub fn standing(as_id: u8) -> MotorStatus {
    let mut motor = motor(Mode::Velocity, Activity::Idle);
    motor.id = id(as_id);
    if let Some(sample) = &mut motor.last {
        sample.reply.id = id(as_id);
    }
    motor
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "milliseconds of a test"
)]
fn now() -> Instant {
    let performance = web_sys::window().unwrap().performance().unwrap();
    Instant::from_millis(performance.now() as u64)
}

/// The worker tells this, with motor 0x01 connected but for what is changed.
pub fn report(bench: &Bench, change: impl FnOnce(&mut Update)) {
    let mut update = Update {
        now: now(),
        connection: Connection::Connected(Adapter::VIRTUAL),
        halted: false,
        motors: vec![standing(1)],
        job: None,
        raw: None,
        line: None,
        samples: vec![],
        notices: vec![],
    };
    change(&mut update);
    bench.post(&ToPage::Update(update));
}

/// Opens a panel of a page with a motor.
pub async fn open(name: &str, panel: &str) -> Bench {
    let bench = Bench::with_motor(name, Mode::Velocity).await;
    bench.open(panel).await;
    bench
}

async fn id_manager(name: &str) -> Bench {
    open(name, "ID Manager").await
}

fn scanning() -> JobStatus {
    JobStatus::Scanning {
        asked: 118,
        of: 254,
        left_ms: 900,
        found: vec![id(1)],
    }
}

fn scanned(found: &[u8]) -> Notice {
    Notice::ScanEnded(ScanReport {
        found: found.iter().map(|found| id(*found)).collect(),
        noisy: vec![],
        fault: None,
        asked: 254,
        complete: true,
        took_ms: 2_000,
    })
}

/// The bus scans, and then tells whom it has found.
async fn scan(bench: &Bench, found: &[u8]) {
    report(bench, |update| update.job = Some(scanning()));
    let words = || {
        bench
            .find("progressbar", "Scan")
            .get_attribute("aria-valuetext")
    };
    bench
        .until("the scan to be seen", || words().unwrap().contains("118"))
        .await;
    report(bench, |update| update.notices = vec![scanned(found)]);
    bench
        .until("its end to be seen", || {
            words().unwrap().contains("No scan")
        })
        .await;
}

/// Wishes for ID 5, and the bus finds these motors.
async fn request_id(bench: &Bench, found: &[u8]) {
    bench.enter("New ID", "5");
    until_enabled(bench, "Set ID").await;
    bench.click("Set ID");
    assert_eq!(bench.commands().await, [Command::FullScan]);
    assert_eq!(bench.find_all(QUESTION.0, QUESTION.1).len(), 0);
    scan(bench, found).await;
}

pub async fn until_enabled(bench: &Bench, button: &str) {
    bench
        .until(button, || {
            !bench.find("button", button).has_attribute("disabled")
        })
        .await;
}

fn result(bench: &Bench) -> String {
    bench.text("status", "Scan result")
}

#[wasm_bindgen_test]
async fn a_scan_shows_how_far_it_is_and_can_be_cancelled() {
    let bench = id_manager("scan").await;
    assert!(bench.find("button", "Cancel").has_attribute("disabled"));
    bench.click("Scan");
    bench.click("Full scan");
    assert_eq!(
        bench.commands().await,
        [Command::IdQuery, Command::FullScan]
    );
    report(&bench, |update| update.job = Some(scanning()));
    until_enabled(&bench, "Cancel").await;
    let progress = bench.find("progressbar", "Scan");
    assert_eq!(progress.get_attribute("aria-valuenow").unwrap(), "118");
    assert_eq!(
        bench.text("progressbar", "Scan"),
        "118 of 254, about 1 s left"
    );
    assert!(
        bench
            .find("button", "Full scan")
            .title()
            .contains("bus scan")
    );
    bench.click("Cancel");
    assert_eq!(bench.commands().await, [Command::CancelJob]);
}

#[wasm_bindgen_test]
async fn a_click_on_a_motor_that_was_found_chooses_it() {
    let bench = id_manager("choose").await;
    report(&bench, |update| {
        update.motors = vec![standing(1), standing(2)];
    });
    let list = bench.find("list", "Motors found");
    let buttons = || list.query_selector_all(".found").unwrap();
    bench.until("two motors", || buttons().length() == 2).await;
    let second: HtmlElement = buttons().item(1).unwrap().unchecked_into();
    assert!(second.text_content().unwrap().contains("0x02"));
    second.focus().unwrap();
    bench.received().await;
    second.click();
    let received = bench.received().await;
    assert_eq!(received, [ToWorker::Select(id(2))]);
    bench
        .until("the motor to be chosen", || {
            let chosen = list.query_selector("[aria-pressed=true]").unwrap();
            chosen.is_some_and(|chosen| chosen.get_attribute("value").unwrap() == "2")
        })
        .await;
    // The keyboard's focus is still at the same motor.
    let focused = document().active_element().unwrap();
    assert_eq!(focused.get_attribute("value").as_deref(), Some("2"));
    motorlink::Preferences::default().save();
}

#[wasm_bindgen_test]
async fn several_answers_at_once_offer_the_full_scan() {
    let bench = id_manager("garbled").await;
    report(&bench, |update| {
        update.notices = vec![Notice::IdQueryEnded(IdQueryOutcome::Garbled)];
    });
    bench
        .until("words", || result(&bench).contains("Several motors"))
        .await;
    assert!(result(&bench).contains("Full scan queries each address"));
    // It is said once, not on the board of notices too.
    assert!(!bench.text("region", "Notices").contains("Several motors"));
}

#[wasm_bindgen_test]
async fn what_a_scan_finds_is_on_the_board_for_those_who_are_elsewhere() {
    let bench = Bench::with_motor("elsewhere", Mode::Velocity).await;
    report(&bench, |update| update.notices = vec![scanned(&[1, 2])]);
    let board = || bench.text("region", "Notices");
    bench
        .until("a notice", || board().contains("2 motors found"))
        .await;
    bench.open("ID Manager").await;
    bench
        .until("the panel to say it", || {
            !board().contains("2 motors found")
        })
        .await;
    assert!(result(&bench).contains("2 motors found (0x01, 0x02)"));
}

#[wasm_bindgen_test]
async fn an_id_is_set_once_after_a_scan_with_one_motor_and_a_question() {
    let bench = id_manager("set-id").await;
    request_id(&bench, &[1]).await;
    bench
        .until("the question", || {
            bench.find_all(QUESTION.0, QUESTION.1).len() == 1
        })
        .await;
    let words = bench.text(QUESTION.0, QUESTION.1);
    assert!(words.contains("Motor 0x01 becomes 0x05"), "{words}");
    let agree = bench.find("button", "Set ID 0x05");
    agree.click();
    agree.click();
    let (from, to) = (id(1), new_id(5));
    let frames = SetIdFrames::Five;
    assert_eq!(
        bench.commands().await,
        [Command::SetId { from, to, frames }]
    );
    assert_eq!(bench.find_all(QUESTION.0, QUESTION.1).len(), 0);

    let outcome = IdChangeOutcome::Changed;
    report(&bench, |update| {
        update.motors = vec![standing(5)];
        update.notices = vec![Notice::IdChangeEnded { from, to, outcome }];
    });
    bench
        .until("the end", || {
            result(&bench).contains("Motor 0x01 now has ID 0x05")
        })
        .await;
    assert!(bench.received().await.contains(&ToWorker::Select(id(5))));
    motorlink::Preferences::default().save();
}

#[wasm_bindgen_test]
async fn two_motors_are_named_and_nothing_is_asked() {
    let bench = id_manager("two").await;
    request_id(&bench, &[1, 2]).await;
    assert!(result(&bench).contains("2 motors found (0x01, 0x02)"));
    assert_eq!(bench.find_all(QUESTION.0, QUESTION.1).len(), 0);
    assert_eq!(bench.commands().await, []);
}

#[wasm_bindgen_test]
async fn a_stop_or_another_place_ends_the_wish_for_an_id() {
    for leave in ["STOP", "place"] {
        let bench = id_manager(&format!("leave-{leave}")).await;
        bench.enter("New ID", "5");
        until_enabled(&bench, "Set ID").await;
        bench.click("Set ID");
        if leave == "place" {
            bench.click("Drive");
            bench.open("ID Manager").await;
        } else {
            bench.find("button", "STOP all motors").click();
        }
        bench.commands().await;
        scan(&bench, &[1]).await;
        assert_eq!(bench.find_all(QUESTION.0, QUESTION.1).len(), 0, "{leave}");
        assert_eq!(bench.commands().await, [], "{leave}");
    }
}

#[wasm_bindgen_test]
async fn escape_at_a_standstill_only_closes_the_question() {
    let bench = id_manager("escape-question").await;
    request_id(&bench, &[1]).await;
    bench
        .until("the question", || {
            bench.find_all(QUESTION.0, QUESTION.1).len() == 1
        })
        .await;
    press("Escape");
    assert_eq!(bench.commands().await, []);
    assert_eq!(bench.find_all(QUESTION.0, QUESTION.1).len(), 0);
}

#[wasm_bindgen_test]
async fn a_stop_closes_the_question() {
    let bench = id_manager("stop-question").await;
    request_id(&bench, &[1]).await;
    bench
        .until("the question", || {
            bench.find_all(QUESTION.0, QUESTION.1).len() == 1
        })
        .await;
    bench.find("button", "STOP all motors").click();
    let stop = Command::StopAll(StopReason::Operator);
    assert_eq!(bench.commands().await, [stop]);
    assert_eq!(bench.find_all(QUESTION.0, QUESTION.1).len(), 0);
}

#[wasm_bindgen_test]
async fn an_id_that_no_motor_may_get_is_refused_at_the_field() {
    let bench = id_manager("refused-id").await;
    for (text, why) in [
        ("0", "0 is not a valid ID"),
        ("255", "1 to 254"),
        ("0xC8", "ID query"),
        ("x", "such as 5 or 0x05"),
        ("1", "already has ID 0x01"),
    ] {
        let field = bench.enter("New ID", text);
        let words = || {
            let words = field.get_attribute("aria-describedby").unwrap();
            let words = document().get_element_by_id(&words).unwrap();
            words.text_content().unwrap()
        };
        bench.until(why, || words().contains(why)).await;
        assert_eq!(field.get_attribute("aria-invalid").unwrap(), "true");
        assert!(bench.find("button", "Set ID").has_attribute("disabled"));
        assert_eq!(field.value(), text);
    }
    assert_eq!(bench.commands().await, []);
}

#[wasm_bindgen_test]
async fn a_change_of_loop_leaves_the_place_open() {
    for panel in ["ID Manager", "Raw Hex"] {
        let bench = open(&format!("torn-{}", panel.len()), panel).await;
        report(&bench, |update| {
            let mode = Mode::Current;
            update.motors = vec![motor(mode, Activity::Idle)];
            update.notices = vec![Notice::ModeSwitched { id: id(1), mode }];
        });
        bench
            .until("the loop", || {
                bench.text("status", "Mode").contains("Current loop")
            })
            .await;
        bench.find("region", panel);
    }
}
