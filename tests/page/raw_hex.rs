//! The raw hex editor: what is typed, what is asked before it is sent, and what came back.

use motorlink_messages::{
    Notice,
    bus::{
        Activity, Command, Consent, RawAnswer, RawInterval, RawStatus, Refusal, Repeat, StopReason,
        is_hazardous,
    },
    protocol::{CurrentTarget, Frame, Layout, Mode, MotorId},
};
use wasm_bindgen::JsCast;
use wasm_bindgen_test::wasm_bindgen_test;
use web_sys::{Event, HtmlElement, HtmlInputElement};

use crate::{
    bench::{Bench, document, motor, press},
    tools::{open, report, until_enabled},
};

const QUERY: &str = "01 74 00 00 00 00 00 00 00 04";
const DRIVE: &str = "01 64 00 64 00 00 00 00 00 4F";
const QUESTION: (&str, &str) = ("alertdialog", "Send this frame?");

fn frame(text: &str) -> Frame {
    text.parse().unwrap()
}

fn sent(text: &str, repeat: Repeat, consent: Consent) -> Command {
    Command::SendRaw {
        frame: frame(text),
        repeat,
        consent,
    }
}

fn once(text: &str) -> Command {
    sent(text, Repeat::Once, Consent::None)
}

async fn raw_hex(name: &str) -> Bench {
    open(name, "Raw Hex").await
}

/// Types into the textbox; gives it back. A text area has the same `value` as an input.
fn write(bench: &Bench, text: &str) -> HtmlInputElement {
    let field: HtmlInputElement = bench.find("textbox", "Frame bytes").unchecked_into();
    field.set_value(text);
    field.dispatch_event(&Event::new("input").unwrap()).unwrap();
    field
}

fn cells(bench: &Bench) -> String {
    bench.text("status", "Frame with CRC")
}

fn words() -> String {
    let words = document().get_element_by_id("frame-words").unwrap();
    words.text_content().unwrap()
}

async fn send(bench: &Bench) {
    until_enabled(bench, "Send").await;
    bench.click("Send");
}

async fn until_asked(bench: &Bench, (role, name): (&str, &str)) {
    bench
        .until(name, || bench.find_all(role, name).len() == 1)
        .await;
}

#[wasm_bindgen_test]
async fn every_byte_is_labelled_and_the_crc_is_added_while_one_types() {
    let bench = raw_hex("labels").await;
    let field = write(&bench, "0x01,0x64 0064-00:00 00 00 00");
    bench
        .until("the CRC", || cells(&bench).contains("CRC added 9 4F"))
        .await;
    for cell in [
        "ID 0 01",
        "command 1 64",
        "value high 2 00",
        "value low 3 64",
        "accel 6 00",
        "brake 7 00",
    ] {
        assert!(cells(&bench).contains(cell), "{}", cells(&bench));
    }
    assert_eq!(words(), "To motor 0x01: drive +100 rpm.");
    assert_eq!(field.value(), "0x01,0x64 0064-00:00 00 00 00");
}

#[wasm_bindgen_test]
async fn what_is_wrong_is_shown_at_its_byte_and_is_not_sent() {
    let bench = raw_hex("wrong").await;
    let field = write(&bench, "01 74 0G 00");
    bench
        .until("words", || words().contains("Byte 2: “0G” is not hex"))
        .await;
    assert!(cells(&bench).contains("invalid 2 0G"), "{}", cells(&bench));
    assert_eq!(field.get_attribute("aria-invalid").unwrap(), "true");
    assert_eq!(field.value(), "01 74 0G 00");
    let send: HtmlElement = bench.find("button", "Send");
    assert!(send.has_attribute("disabled"));
    assert!(send.title().contains("9 or 10 bytes"), "{}", send.title());
}

#[wasm_bindgen_test]
async fn a_query_is_sent_at_once_and_its_answer_is_shown() {
    let bench = raw_hex("query").await;
    bench.click("Feedback query");
    send(&bench).await;
    assert_eq!(bench.commands().await, [once(QUERY)]);
    let reply = RawAnswer::Reply {
        frame: frame("01 02 00 0A 00 00 20 F6 00 4A"),
        asked: Some(Layout::Query),
        after_us: 2_430,
    };
    for (last, shown) in [
        (
            reply,
            "01 02 00 0A 00 00 20 F6 00 4A From 0x01 after 2.5 ms",
        ),
        (
            RawAnswer::Silence { waited_us: 8_000 },
            "No reply within 8.0 ms.",
        ),
    ] {
        report(&bench, |update| {
            update.raw = Some(RawStatus {
                frame: frame(QUERY),
                count: 1,
                sent: 1,
                answered: 1,
                running: false,
                last: Some(last),
            });
        });
        let answer = || bench.text("status", "Reply");
        bench.until(shown, || answer().contains(shown)).await;
    }
    // It answered other bytes than those.
    let appears = |text: &str| text.contains("The reply appears here");
    let answer = || bench.text("status", "Reply");
    write(&bench, "02 74 00 00 00 00 00 00 00");
    bench.until("no answer", || appears(&answer())).await;
    write(&bench, QUERY);
    bench
        .until("the answer", || answer().contains("No reply"))
        .await;
}

#[wasm_bindgen_test]
async fn a_frame_that_can_move_a_wheel_is_asked_about_once() {
    assert!(is_hazardous(&frame(DRIVE)));
    let bench = raw_hex("hazard").await;
    write(&bench, DRIVE);
    send(&bench).await;
    assert_eq!(bench.commands().await, []);
    until_asked(&bench, QUESTION).await;
    let words = bench.text(QUESTION.0, QUESTION.1);
    assert!(words.contains("STOP, Space and Escape"), "{words}");
    let agree = bench.find("button", "Send it");
    agree.click();
    agree.click();
    assert_eq!(bench.commands().await, [once(DRIVE)]);

    send(&bench).await;
    assert_eq!(bench.commands().await, [once(DRIVE)], "not asked again");
    assert_eq!(bench.find_all(QUESTION.0, QUESTION.1).len(), 0);
}

#[wasm_bindgen_test]
async fn consent_to_one_frame_lets_no_other_through() {
    const WRONG_CRC: &str = "01 64 00 64 00 00 00 00 00 5B";
    let bench = raw_hex("hazard-other").await;
    write(&bench, WRONG_CRC);
    send(&bench).await;
    until_asked(&bench, QUESTION).await;
    bench.click("Send it");
    assert_eq!(bench.commands().await, [once(WRONG_CRC)]);
    for other in ["01 64 01 F4 00 00 00 00 00 C3", DRIVE] {
        let bytes = write(&bench, other).value();
        bench
            .until("the other frame", || cells(&bench).contains(&bytes[27..]))
            .await;
        send(&bench).await;
        assert_eq!(bench.commands().await, [], "{other}");
        until_asked(&bench, QUESTION).await;
        assert!(bench.text(QUESTION.0, QUESTION.1).contains(other));
        bench.click("Cancel");
    }
    // Nor the same frame once its motor reads it in another loop.
    send(&bench).await;
    until_asked(&bench, QUESTION).await;
    bench.click("Send it");
    assert_eq!(bench.commands().await, [once(DRIVE)]);
    report(&bench, |update| {
        update.motors = vec![motor(Mode::Current, Activity::Idle)];
    });
    bench
        .until("the loop", || {
            bench.text("status", "Mode").contains("Current loop")
        })
        .await;
    send(&bench).await;
    until_asked(&bench, QUESTION).await;
    assert_eq!(bench.commands().await, []);
}

#[wasm_bindgen_test]
async fn a_stop_instead_of_an_answer_sends_nothing() {
    let bench = raw_hex("hazard-stop").await;
    write(&bench, DRIVE);
    send(&bench).await;
    until_asked(&bench, QUESTION).await;
    press(" ");
    let stop = Command::StopAll(StopReason::Operator);
    assert_eq!(bench.commands().await, [stop]);
    assert_eq!(bench.find_all(QUESTION.0, QUESTION.1).len(), 0);
}

#[wasm_bindgen_test]
async fn a_high_current_is_asked_about_each_time() {
    let high = "01 64 75 30 00 00 00 00 00 A7";
    let bench = raw_hex("high-raw").await;
    write(&bench, high);
    send(&bench).await;
    until_asked(&bench, QUESTION).await;
    bench.click("Send it");
    assert_eq!(bench.commands().await, [once(high)]);
    for _ in 0..2 {
        let refusal = Refusal::NeedsConsent(CurrentTarget::new(30_000).unwrap());
        report(&bench, |update| {
            let command = once(high).into();
            update.notices = vec![Notice::Refused { command, refusal }];
        });
        until_asked(&bench, ("alertdialog", "High current")).await;
        bench.click("Send +7.32 A");
        let agreed = sent(high, Repeat::Once, Consent::HighCurrent);
        assert_eq!(bench.commands().await, [agreed]);
        send(&bench).await;
        assert_eq!(bench.commands().await, [once(high)]);
    }
}

#[wasm_bindgen_test]
async fn a_refusal_that_comes_after_a_stop_asks_nothing() {
    let bench = raw_hex("late-refusal").await;
    write(&bench, DRIVE);
    send(&bench).await;
    until_asked(&bench, QUESTION).await;
    bench.click("Send it");
    press("Escape");
    let refusal = Refusal::NeedsConsent(CurrentTarget::new(30_000).unwrap());
    report(&bench, |update| {
        let command = once(DRIVE).into();
        update.notices = vec![Notice::Refused { command, refusal }];
    });
    let answer = || bench.text("status", "Reply");
    bench
        .until("words", || answer().contains("above 6.1 A"))
        .await;
    assert_eq!(bench.find_all("alertdialog", "High current").len(), 0);
}

#[wasm_bindgen_test]
async fn a_frame_is_repeated_as_entered_until_it_is_stopped() {
    let bench = raw_hex("repeat").await;
    write(&bench, QUERY);
    bench.find("checkbox", "Repeat").click();
    bench.enter("Count", "0");
    bench.enter("Interval", "50");
    send(&bench).await;
    let interval = RawInterval::new(50).unwrap();
    let repeat = Repeat::Times { count: 0, interval };
    assert_eq!(bench.commands().await, [sent(QUERY, repeat, Consent::None)]);
    bench.click("Drive");
    report(&bench, |update| {
        update.raw = Some(RawStatus {
            frame: frame(QUERY),
            count: 0,
            sent: 7,
            answered: 6,
            running: true,
            last: None,
        });
    });
    bench.open("Raw Hex").await;
    bench
        .until("how often it was sent", || {
            let answers = bench.find_all("status", "Reply");
            answers.first().is_some_and(|answer| {
                answer
                    .text_content()
                    .unwrap()
                    .contains("sent 7, replies: 6")
            })
        })
        .await;
    // Without a style sheet the controls of Drive have one too.
    bench.find_all("button", "Stop").pop().unwrap().click();
    assert_eq!(bench.commands().await, [Command::StopRaw]);

    bench.enter("Interval", "1");
    bench
        .until("a refusal", || {
            bench
                .find("button", "Send")
                .title()
                .contains("2 to 60\u{202F}000")
        })
        .await;
}

#[wasm_bindgen_test]
async fn in_the_textbox_space_types_and_escape_stops_what_is_driven() {
    let bench = raw_hex("space").await;
    write(&bench, "01").focus().unwrap();
    let type_all = || [" ", "f", "s", "Escape"].map(press);
    type_all();
    assert_eq!(bench.commands().await, []);
    bench.report(motor(Mode::Velocity, Activity::DrivenRaw), false);
    bench
        .until("raw frames", || document().title().contains("raw frames"))
        .await;
    type_all();
    let stop = Command::StopAll(StopReason::Operator);
    assert_eq!(bench.commands().await, [stop]);
}

#[wasm_bindgen_test]
async fn a_frame_that_is_typed_beside_the_textbox_drives_nothing() {
    let bench = raw_hex("beside").await;
    for key in ["0", "1", "5", "f", "B", "c"] {
        press(key);
    }
    assert_eq!(bench.commands().await, []);
}

#[wasm_bindgen_test]
async fn the_key_for_a_stop_works_beside_a_repeated_frame() {
    let bench = raw_hex("key-stop").await;
    report(&bench, |update| {
        update.raw = Some(RawStatus {
            frame: frame(DRIVE),
            count: 0,
            sent: 7,
            answered: 6,
            running: true,
            last: None,
        });
    });
    let answer = || bench.text("status", "Reply");
    bench
        .until("the repeat", || answer().contains("Repeating"))
        .await;
    press("s");
    assert_eq!(
        bench.commands().await,
        [Command::StopRaw, Command::Stop(MotorId::FIRST)]
    );
}

#[wasm_bindgen_test]
async fn a_drive_frame_that_was_sent_once_offers_a_stop_until_the_motor_stands() {
    let bench = raw_hex("raw-keeps").await;
    let sent = |may_turn| {
        report(&bench, move |update| {
            update.raw = Some(RawStatus {
                frame: frame(DRIVE),
                count: 1,
                sent: 1,
                answered: 1,
                running: false,
                last: None,
            });
            update.motors[0].may_turn = may_turn;
        });
    };
    let offered = || bench.find_all("button", "Stop it").len() == 1;
    sent(true);
    bench.until("the offer", offered).await;
    bench.received().await;
    bench.click("Stop it");
    assert_eq!(bench.commands().await, [Command::StopRaw]);
    sent(false);
    bench.until("no offer", || !offered()).await;
}
