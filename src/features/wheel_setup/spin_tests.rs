use motorlink_messages::{
    bus::{CommandKind, Refusal, StopOutcome},
    protocol::Rpm,
};

use super::*;
use crate::{
    features::wheel_setup::{stored, wheel::Layout},
    model::{names_and_sides::Side, scan_texts::tests::id},
};

/// The second of four wheels is driven.
fn spinning() -> Setup {
    let mut setup = Setup::at(Step::Spin, Layout::Four.wheels());
    assert_eq!(setup.spin(1), Some(id(2)));
    setup
}

/// The half second of this wheel is over.
fn stopping() -> Setup {
    let mut setup = spinning();
    assert_eq!(setup.end_spin(), Some(id(2)));
    assert_eq!(setup.end_spin(), None, "it is stopped once");
    setup
}

fn answering() -> Setup {
    let mut setup = stopping();
    assert_eq!(
        setup.on_notice(&stopped(2, true, StopReason::OneMotor)),
        None
    );
    assert_eq!(
        setup.activity,
        Activity::Answering {
            wheel: 1,
            other: false
        }
    );
    setup
}

fn stopped(motor: u8, confirmed: bool, reason: StopReason) -> Notice {
    Notice::StopEnded(StopReport {
        reason,
        motors: vec![StopOutcome {
            id: id(motor),
            confirmed,
            speed: Some(Rpm::new(0)),
        }],
    })
}

#[test]
fn the_page_asks_about_a_wheel_after_its_confirmed_stop() {
    let mut setup = answering();
    setup.answer_correct();
    assert_eq!(setup.activity, Activity::None);
    assert!(setup.wheels[1].is_checked);
    setup.finish();
    assert_eq!(setup.step, Step::Done);
}

#[test]
fn only_one_wheel_at_a_time_is_driven_and_only_in_the_step_spin() {
    for step in [
        Step::Wheels,
        Step::Id(1),
        Step::Label(1),
        Step::Check,
        Step::Done,
    ] {
        let mut setup = Setup::at(step, Layout::Four.wheels());
        assert_eq!(setup.spin(1), None, "{step:?}");
    }
    for mut setup in [spinning(), stopping()] {
        assert_eq!(setup.spin(1), None);
        assert_eq!(setup.spin(0), None);
        assert!(setup.is_busy());
    }
    // Before the answer, only the same wheel can be spun again.
    let mut setup = answering();
    assert_eq!(setup.spin(0), None);
    assert_eq!(setup.spin(1), Some(id(2)));
    assert_eq!(setup.spin(7), None, "no such wheel");
}

#[test]
fn a_refused_start_stops_the_motor_and_says_why() {
    let refusal = Refusal::Halted;
    let command = CommandKind::Drive(id(2));
    let mut setup = spinning();
    let notice = Notice::Refused { command, refusal };
    assert_eq!(setup.on_notice(&notice), Some(id(2)));
    assert_eq!(setup.activity, Activity::None);
    assert_eq!(setup.outcome, Outcome::Refused(terms::refusal(refusal)));

    let mut setup = spinning();
    assert_eq!(setup.on_notice(&Notice::TooLate(command)), Some(id(2)));
    assert_eq!(
        (setup.activity, setup.outcome),
        (Activity::None, Outcome::StoppedEarly(1))
    );

    // The notice of another motor.
    let mut setup = spinning();
    let command = CommandKind::Drive(id(1));
    let notice = Notice::Refused { command, refusal };
    assert_eq!(setup.on_notice(&notice), None);
    assert_eq!(setup.activity, Activity::Spinning(1));
}

#[test]
fn a_stop_from_another_cause_asks_no_question() {
    let began = Notice::StopBegan(StopReason::Operator);
    let hot = stopped(2, true, StopReason::OneMotor);
    let all = stopped(2, true, StopReason::Operator);
    for (mut setup, notice) in [
        (spinning(), &began),
        (stopping(), &began),
        // A fault or a limit, before the half second was over.
        (spinning(), &hot),
        (spinning(), &all),
        (stopping(), &all),
    ] {
        assert_eq!(setup.on_notice(notice), None);
        assert_eq!(
            (setup.activity, &setup.outcome),
            (Activity::None, &Outcome::StoppedEarly(1))
        );
        assert!(!setup.wheels[1].is_checked);
        assert_eq!(setup.end_spin(), None, "the timer fires later");
    }
}

#[test]
fn an_unconfirmed_stop_is_reported() {
    let mut setup = stopping();
    setup.on_notice(&stopped(2, false, StopReason::OneMotor));
    assert_eq!(setup.activity, Activity::None);
    assert_eq!(setup.outcome, Outcome::NotConfirmed(id(2)));
}

#[test]
fn the_stop_of_another_motor_changes_nothing() {
    let mut setup = stopping();
    setup.on_notice(&stopped(1, true, StopReason::OneMotor));
    assert_eq!(setup.activity, Activity::Stopping(1));
}

#[test]
fn a_lost_port_ends_the_activity_and_keeps_the_step() {
    for mut setup in [spinning(), stopping(), answering()] {
        setup.disconnected();
        assert_eq!((setup.step, setup.activity), (Step::Spin, Activity::None));
        assert_eq!(setup.outcome, Outcome::Disconnected);
        setup.answer_correct();
        assert!(!setup.wheels[1].is_checked);
    }
}

#[test]
fn a_reload_turns_no_wheel_and_keeps_the_answers() {
    let mut setup = answering();
    setup.answer_correct();
    assert_eq!(setup.spin(2), Some(id(3)));
    let after = stored::from_text(&stored::to_text(&setup)).unwrap();
    assert_eq!((after.step, after.activity), (Step::Spin, Activity::None));
    assert!(after.wheels[1].is_checked && !after.wheels[2].is_checked);
}

#[test]
fn a_wheel_that_turns_backwards_changes_side_and_is_checked_again() {
    let mut setup = answering();
    setup.wheels[1].is_checked = true;
    setup.answer_backwards();
    assert_eq!(setup.wheels[1].side, Side::Left);
    assert!(!setup.wheels[1].is_checked);
    assert_eq!(
        (setup.activity, &setup.outcome),
        (Activity::None, &Outcome::SideChanged(1))
    );
    assert!(setup.spin(1).is_some());
}

#[test]
fn if_another_wheel_turned_the_two_exchange_their_motors() {
    let mut setup = answering();
    setup.wheels[3].is_checked = true;
    setup.wheels[1].has_id = true;
    setup.answer_other(true);
    setup.answer_other(false);
    setup.answer_other(true);
    setup.exchange_with(3);
    let ids: Vec<_> = setup.wheels.iter().map(|wheel| wheel.id).collect();
    assert_eq!(ids, [1, 4, 3, 2]);
    assert_eq!(setup.wheels[1].name, "Front right");
    assert!(setup.wheels[3].has_id && !setup.wheels[1].has_id);
    assert!(!setup.wheels[3].is_checked, "it has another motor");
    assert_eq!(setup.outcome, Outcome::Exchanged(1, 3));
    // Without a question nothing is exchanged.
    setup.exchange_with(0);
    assert_eq!(setup.wheels[1].id, 4);
}

#[test]
fn a_wheel_that_did_not_turn_is_not_checked() {
    let mut setup = answering();
    setup.wheels[1].is_checked = true;
    setup.answer_nothing();
    assert!(!setup.wheels[1].is_checked);
    assert_eq!(setup.outcome, Outcome::NothingTurned(1));
}

#[test]
fn an_open_question_does_not_end_the_setup() {
    let mut setup = answering();
    setup.finish();
    assert_eq!(setup.step, Step::Spin);
}
