use motorlink_messages::bus::SetIdFrames;

use super::*;
use crate::{
    features::wheel_setup::stored,
    model::{
        notice_board::{Tone, Topic},
        scan_texts::tests::id,
    },
};

fn text(title: &str) -> NoticeText {
    NoticeText::new(Topic::Survey, Tone::Calm, title, &[])
}

fn changing() -> IdProgress {
    IdProgress {
        is_changing: true,
        end: None,
        message: text("changing"),
        more: None,
    }
}

fn ended(end: Option<End>) -> IdProgress {
    IdProgress {
        is_changing: false,
        end,
        message: text("message of the ID manager"),
        more: None,
    }
}

fn scanned(motors: &[u8]) -> IdProgress {
    let motors = motors.iter().map(|number| id(*number)).collect();
    ended(Some(End::Scanned { motors }))
}

/// The motor of the second wheel of four is being found.
fn finding() -> Setup {
    let mut setup = Setup::at(Step::Id(1), Layout::Four.wheels());
    assert_eq!(setup.find().map(AssignableId::id), Some(id(2)));
    setup.on_ids(&changing());
    assert_eq!(setup.activity, Activity::Finding, "it runs");
    setup
}

fn checking() -> Setup {
    let mut setup = Setup::at(Step::Check, Layout::Four.wheels());
    assert!(setup.check());
    setup.on_ids(&ended(None));
    assert_eq!(setup.activity, Activity::Checking, "it runs");
    setup
}

/// The setup after a reload.
fn reloaded(setup: &Setup) -> Setup {
    stored::from_text(&stored::to_text(setup)).unwrap()
}

#[test]
fn the_ids_follow_only_after_valid_wheels() {
    let mut setup = Setup::default();
    setup.edit(|wheels| wheels[1].id = 0);
    for have_ids in [false, true] {
        setup.leave_wheels(have_ids);
        assert_eq!(setup.step, Step::Wheels);
        assert_eq!(setup.outcome, Outcome::Problem(Problem::Id(1)));
    }
    setup.edit(|wheels| wheels[1].id = 9);
    assert_eq!(setup.outcome, Outcome::Nothing);
    setup.leave_wheels(false);
    assert_eq!(setup.step, Step::Id(0));
    setup.back();
    setup.leave_wheels(true);
    assert_eq!(setup.step, Step::Check);
}

#[test]
fn a_changed_id_or_side_resets_the_progress_of_its_wheel() {
    let mut setup = Setup::default();
    for wheel in &mut setup.wheels {
        (wheel.has_id, wheel.is_checked) = (true, true);
    }
    setup.edit(|wheels| {
        wheels[0].id = 9;
        wheels[1].change_side();
        wheels[2].name = "Third".to_owned();
        wheels.remove(3);
    });
    let progress: Vec<_> = setup
        .wheels
        .iter()
        .map(|wheel| (wheel.has_id, wheel.is_checked))
        .collect();
    assert_eq!(progress, [(false, false), (true, false), (true, true)]);
}

#[test]
fn the_only_motor_gets_its_label_and_then_the_next_wheel_follows() {
    let mut setup = finding();
    setup.on_ids(&scanned(&[2]));
    assert_eq!(
        (setup.step, setup.activity),
        (Step::Label(1), Activity::None)
    );
    assert!(setup.wheels[1].has_id && !setup.wheels[0].has_id);
    assert_eq!(
        setup.outcome,
        Outcome::Ids(text("message of the ID manager"))
    );
    setup.next_wheel();
    assert_eq!(
        (setup.step, &setup.outcome),
        (Step::Id(2), &Outcome::Nothing)
    );
    setup.next_wheel();
    setup.next_wheel();
    assert_eq!(setup.step, Step::Check, "after the last wheel");
}

#[test]
fn any_result_other_than_the_one_motor_keeps_the_step_and_says_why() {
    let of_manager = || Outcome::Ids(text("message of the ID manager"));
    for (progress, why) in [
        (scanned(&[]), of_manager()),
        (scanned(&[1, 2]), Outcome::Several(vec![id(1), id(2)])),
        // The tab ID Manager gave another ID to another motor.
        (scanned(&[7]), of_manager()),
        (ended(Some(End::Failed)), of_manager()),
        (ended(Some(End::Kept)), Outcome::Kept(None)),
        // A stop, a change of the selected motor, or a declined question.
        (ended(None), Outcome::Cancelled),
    ] {
        let mut setup = finding();
        setup.on_ids(&progress);
        assert_eq!((setup.step, setup.activity), (Step::Id(1), Activity::None));
        assert!(!setup.wheels[1].has_id, "{why:?}");
        assert_eq!(setup.outcome, why);
        assert!(setup.find().is_some(), "it can be tried again");
    }
}

#[test]
fn a_motor_that_kept_its_id_is_offered_more_frames() {
    let mut setup = finding();
    setup.on_ids(&IdProgress {
        more: Some(SetIdFrames::Ten),
        ..ended(Some(End::Kept))
    });
    assert_eq!(setup.outcome, Outcome::Kept(Some(SetIdFrames::Ten)));
}

#[test]
fn a_result_without_a_request_changes_nothing() {
    for step in [Step::Wheels, Step::Id(1), Step::Label(1), Step::Check] {
        let mut setup = Setup::at(step, Layout::Four.wheels());
        let before = setup.clone();
        setup.on_ids(&scanned(&[2]));
        assert_eq!(setup, before, "{step:?}");
    }
}

#[test]
fn a_lost_port_ends_the_activity_and_keeps_the_step() {
    for (mut setup, step) in [(finding(), Step::Id(1)), (checking(), Step::Check)] {
        setup.disconnected();
        assert_eq!((setup.step, setup.activity), (step, Activity::None));
        assert_eq!(setup.outcome, Outcome::Disconnected);
        setup.on_ids(&scanned(&[2]));
        assert_eq!(setup.step, step, "a late result");
        assert!(!setup.wheels[1].has_id);
    }
    let mut idle = Setup::at(Step::Label(1), Layout::Four.wheels());
    idle.disconnected();
    assert_eq!(idle.outcome, Outcome::Nothing);
}

#[test]
fn a_refused_scan_keeps_the_step_and_says_why() {
    let mut setup = finding();
    setup.refused("a scan runs".to_owned());
    assert_eq!((setup.step, setup.activity), (Step::Id(1), Activity::None));
    assert_eq!(setup.outcome, Outcome::Refused("a scan runs".to_owned()));
}

#[test]
fn nothing_else_starts_while_an_activity_runs() {
    for mut setup in [finding(), checking()] {
        let before = setup.clone();
        assert_eq!(setup.find(), None);
        assert!(!setup.check());
        setup.back();
        setup.next_wheel();
        setup.set_id_of(0);
        setup.begin_spins();
        assert_eq!(setup, before);
    }
}

#[test]
fn a_reload_keeps_the_step_and_starts_nothing() {
    let mut set = finding();
    set.on_ids(&scanned(&[2]));
    for (setup, step) in [
        (finding(), Step::Id(1)),
        (set, Step::Label(1)),
        (checking(), Step::Check),
    ] {
        let after = reloaded(&setup);
        assert_eq!((after.step, after.activity), (step, Activity::None));
        assert_eq!(after.wheels, setup.wheels);
    }
}

#[test]
fn the_check_names_missing_and_unassigned_motors() {
    let mut setup = checking();
    assert!(!setup.may_spin());
    setup.on_ids(&scanned(&[1, 3, 9]));
    assert_eq!(setup.activity, Activity::None);
    let answers: Vec<_> = setup
        .wheels
        .iter()
        .map(|wheel| setup.has_answered(wheel))
        .collect();
    assert_eq!(answers, [Some(true), Some(false), Some(true), Some(false)]);
    assert_eq!(setup.unassigned_motors(), [id(9)]);
    assert!(setup.may_spin());
    setup.set_id_of(1);
    assert_eq!(setup.step, Step::Id(1));
}

#[test]
fn a_check_without_a_result_keeps_the_step() {
    for progress in [scanned(&[]), scanned(&[9]), ended(Some(End::Failed))] {
        let mut setup = checking();
        setup.on_ids(&progress);
        setup.begin_spins();
        assert_eq!((setup.step, setup.activity), (Step::Check, Activity::None));
    }
    let mut setup = checking();
    setup.on_ids(&scanned(&[1]));
    setup.disconnected();
    setup.begin_spins();
    assert_eq!(setup.step, Step::Check, "the answers are no longer known");
}

#[test]
fn back_goes_to_the_step_before() {
    let mut setup = Setup::at(Step::Done, Layout::Two.wheels());
    let mut steps = Vec::new();
    for _ in 0..6 {
        setup.back();
        steps.push(setup.step);
    }
    assert_eq!(
        steps,
        [
            Step::Spin,
            Step::Check,
            Step::Id(1),
            Step::Id(0),
            Step::Wheels,
            Step::Wheels,
        ]
    );
    let mut label = Setup::at(Step::Label(1), Layout::Two.wheels());
    label.back();
    assert_eq!(label.step, Step::Id(1));
}

#[test]
fn a_new_start_keeps_the_wheels_without_their_progress() {
    let mut wheels = Layout::Two.wheels();
    for wheel in &mut wheels {
        (wheel.has_id, wheel.is_checked) = (true, true);
    }
    let mut setup = Setup::at(Step::Done, wheels);
    setup.start_again();
    assert_eq!(setup, Setup::at(Step::Wheels, Layout::Two.wheels()));
}
