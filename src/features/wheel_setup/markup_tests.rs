use motorlink_messages::bus::SetIdFrames;

use super::*;
use crate::features::wheel_setup::wheel::Layout;

fn of(setup: &Setup, blocked: &Blocked) -> String {
    controls(setup, blocked, Model::Ddsm400)
}

#[test]
fn every_step_is_marked_in_the_list_and_has_its_next_button() {
    for (step, place, value) in [
        (Step::Wheels, "Wheels", "set-ids"),
        (Step::Id(1), "IDs", "find"),
        (Step::Label(1), "IDs", "next"),
        (Step::Check, "Bus", "check"),
        (Step::Spin, "Direction", "spin-1"),
        (Step::Done, "Direction", "drive"),
    ] {
        let setup = Setup::at(step, Layout::Two.wheels());
        let marked = format!("<li aria-current=\"step\">{place}</li>");
        assert!(head(&setup).contains(&marked), "{step:?}");
        let html = of(&setup, &Blocked::default());
        assert!(html.contains(&format!("value=\"{value}\"")), "{html}");
    }
}

#[test]
fn a_scan_that_cannot_start_says_why_and_a_scan_of_the_panel_can_be_cancelled() {
    let mut setup = Setup::at(Step::Id(0), Layout::Two.wheels());
    let blocked = Blocked {
        change: Some("Not connected.".to_owned()),
        ..Blocked::default()
    };
    let html = of(&setup, &blocked);
    assert_eq!(html.matches("Not connected.").count(), 2, "{html}");
    assert!(!html.contains("value=\"cancel\""));
    setup.activity = Activity::Finding;
    let html = of(&setup, &blocked);
    assert!(html.contains("value=\"cancel\""), "{html}");
    assert_eq!(
        html.matches(" disabled").count(),
        3,
        "find, back, skip: {html}"
    );
}

#[test]
fn more_frames_are_offered_only_after_a_motor_kept_its_id() {
    let mut setup = Setup::at(Step::Id(0), Layout::Two.wheels());
    assert!(!of(&setup, &Blocked::default()).contains("frames"));
    setup.outcome = Outcome::Kept(Some(SetIdFrames::Ten));
    assert!(of(&setup, &Blocked::default()).contains("Send 10 frames"));
    setup.outcome = Outcome::Kept(None);
    assert!(!of(&setup, &Blocked::default()).contains("frames"));
}

#[test]
fn the_label_names_the_id_and_the_model() {
    let html = of(
        &Setup::at(Step::Label(1), Layout::Two.wheels()),
        &Blocked::default(),
    );
    assert!(html.contains("Label it 0x02"), "{html}");
    assert!(html.contains("DDSM400"), "{html}");
    assert!(html.contains("Labelled: check all"), "the last one: {html}");
}

#[test]
fn only_the_answers_can_be_pressed_while_the_page_asks() {
    let mut setup = Setup::at(Step::Spin, Layout::Four.wheels());
    setup.activity = Activity::Answering {
        wheel: 2,
        other: false,
    };
    let html = of(&setup, &Blocked::default());
    for answer in ["correct", "backwards", "other", "nothing"] {
        assert!(html.contains(&format!("value=\"{answer}\"")), "{html}");
    }
    // The three other wheels, and Finish.
    assert_eq!(html.matches(" disabled").count(), 4, "{html}");
}
