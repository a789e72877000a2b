//! What does not cross between a recording and the live line.

use super::*;

#[wasm_bindgen_test]
async fn no_replay_begins_while_a_port_is_open() {
    let (sessions, bench) = opened("replay-refused").await;
    // The port opens before the worker has answered.
    bench.report(motor(Mode::Velocity, Activity::Idle), false);
    let connected = || connection(&bench).contains("Connected");
    bench.until("the port", connected).await;
    post(&sessions, BEGUN);
    assert_eq!(sessions.next().await.0, ToSessions::Replay(ToReplay::End));
    assert!(connection(&bench).contains("Connected"));
    assert!(bench.find_all("region", "Replay").is_empty());

    let button = bench.find("button", "Replay");
    assert!(button.has_attribute("disabled"));
    let reason = button.get_attribute("title").unwrap();
    assert_eq!(reason, "Disconnect first.");
}

#[wasm_bindgen_test]
async fn nothing_is_sent_to_the_port_worker_during_a_replay() {
    let (sessions, bench) = replaying("replay-locked").await;
    let start = bench.find_all("button", "Start");
    assert!(!start.is_empty());
    for button in start {
        assert!(button.has_attribute("disabled"));
        let reason = button.get_attribute("title").unwrap_or_default();
        assert!(reason.contains("This is a recording"), "{reason}");
    }
    for key in ["f", "b", "1", "5", "k", "c", "p", "v", "s"] {
        press(key);
        pause(20).await;
    }
    // A slider adjusts what is driven: it is, in the recording.
    bench.enter("Target speed", "200");
    // Each is in its own place.
    for (panel, name) in [("Raw Hex", "Send"), ("ID Manager", "Full scan")] {
        bench.open(panel).await;
        let is_shown = || !bench.find_all("button", name).is_empty();
        bench.until(name, is_shown).await;
        for button in bench.find_all("button", name) {
            assert!(button.has_attribute("disabled"), "{name}");
            button.remove_attribute("disabled").unwrap();
            button.click();
        }
    }
    let motors = bench.find_all("button", "Motor 0x01");
    motors.iter().for_each(web_sys::HtmlElement::click);
    let commands = bench.commands().await;
    let is_stop = |command: &Command| matches!(command, Command::Stop(_) | Command::StopAll(_));
    assert!(commands.iter().all(is_stop), "{commands:?}");
    assert!(of_replay(sessions.received().await).is_empty());

    let stop = bench.find("button", "STOP all motors");
    stop.dispatch_event(&Event::new("pointerdown").unwrap())
        .unwrap();
    press("Escape");
    press(" ");
    // Escape closes the panel first.
    press("Escape");
    let sent = of_replay(sessions.received().await);
    assert!(sent.len() >= 2, "{sent:?}");
    assert!(sent.iter().all(|it| *it == ToReplay::Pause), "{sent:?}");
    assert!(bench.received().await.is_empty(), "no port is open");
}

#[wasm_bindgen_test]
async fn connecting_ends_the_replay_first() {
    let (sessions, bench) = replaying("replay-connect").await;
    bench.click("Virtual motor");
    assert_eq!(sessions.next().await.0, ToSessions::Replay(ToReplay::End));
    until_live(&bench).await;
    let sent = bench.received().await;
    let connects = |it: &ToWorker| matches!(it, ToWorker::ConnectVirtual(_));
    let place = sent.iter().position(connects);
    // The settings that were changed during the replay, and the selected motor, come before the port opens.
    let settings = |it: &ToWorker| {
        matches!(
            it,
            ToWorker::Command {
                command: Command::Configure(_),
                ..
            }
        )
    };
    let settings = sent.iter().position(settings).expect("the settings");
    assert!(place.is_some_and(|place| place > settings), "{sent:?}");
    assert!(sent.iter().any(|it| matches!(it, ToWorker::Select(_))));

    bench.report(motor(Mode::Velocity, Activity::Idle), false);
    let connected = || connection(&bench).contains("Connected");
    bench.until("the port", connected).await;
    // A late message of the worker changes nothing.
    post(&sessions, update(9_000, 77, true));
    pause(300).await;
    assert!(!bench.text("status", "Speed").contains("77"));
}

/// Replay was pressed twice before the worker answered.
#[wasm_bindgen_test]
async fn a_replay_that_begins_twice_sets_the_live_line_aside_once() {
    let (sessions, bench) = replaying("replay-twice").await;
    post(&sessions, BEGUN);
    post(&sessions, update(2_500, 110, false));
    let is_shown = || bench.text("status", "Speed").contains("+110");
    bench.until("the recording", is_shown).await;
    bench.find_all("button", "End replay").remove(0).click();
    until_live(&bench).await;
}

#[wasm_bindgen_test]
async fn a_recording_settles_nothing_that_is_said_of_live_motors() {
    let (sessions, bench) = opened("replay-notices").await;
    bench.post(&closed_port(vec![Notice::StopEnded(StopReport {
        reason: StopReason::Operator,
        motors: vec![StopOutcome {
            id: MotorId::FIRST,
            confirmed: false,
            speed: None,
        }],
    })]));
    let is_told = || {
        let text = document().body().unwrap().inner_text();
        text.contains("Standstill not confirmed: motor 0x01")
    };
    bench.until("the notice", is_told).await;
    begun(&sessions, &bench).await;
    for place in [3_000, 3_100, 3_200, 3_300] {
        post(&sessions, update(place, 0, false));
    }
    let stands = || bench.text("status", "Speed").starts_with('0');
    bench
        .until("the standing wheel of the recording", stands)
        .await;
    bench.find_all("button", "End replay").remove(0).click();
    until_live(&bench).await;
    assert!(is_told(), "it is of a live motor");
}

#[wasm_bindgen_test]
async fn a_port_that_opens_by_itself_and_a_failed_worker_end_the_replay() {
    let (_sessions, bench) = replaying("replay-odd").await;
    // A state of the closed port changes nothing.
    bench.post(&closed_port(vec![]));
    pause(200).await;
    assert!(connection(&bench).contains("Replay"));
    bench.report(motor(Mode::Velocity, Activity::Idle), false);
    until_live(&bench).await;
    let connected = || connection(&bench).contains("Connected");
    bench.until("the port", connected).await;

    let (sessions, bench) = replaying("replay-dead").await;
    bench.post(&ToPage::Died);
    until_live(&bench).await;
    assert!(connection(&bench).contains("Failed"));

    let (sessions_of_other, bench) = replaying("replay-lost").await;
    sessions_of_other.post(&FromSessions::Died);
    until_live(&bench).await;
    drop(sessions);
}
