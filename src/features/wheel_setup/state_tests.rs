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
        message: text("what the ID manager says"),
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
    assert_eq!(setup.act, Act::Finding, "it is under way");
    setup
}

fn checking() -> Setup {
    let mut setup = Setup::at(Step::Check, Layout::Four.wheels());
    assert!(setup.check());
    setup.on_ids(&ended(None));
    assert_eq!(setup.act, Act::Checking, "it is under way");
    setup
}

/// What is stored, and loaded after a reload.
fn reloaded(setup: &Setup) -> Setup {
    stored::from_text(&stored::to_text(setup)).unwrap()
}

#[test]
fn the_wheels_have_to_be_complete_before_the_ids() {
    let mut setup = Setup::default();
    setup.edit(|wheels| wheels[1].id = 0);
    for have_ids in [false, true] {
        setup.begin(have_ids);
        assert_eq!(setup.step, Step::Wheels);
        assert_eq!(setup.said, Said::Problem(Problem::Id(1)));
    }
    setup.edit(|wheels| wheels[1].id = 9);
    assert_eq!(setup.said, Said::Nothing);
    setup.begin(false);
    assert_eq!(setup.step, Step::Id(0));
    setup.back();
    setup.begin(true);
    assert_eq!(setup.step, Step::Check);
}

#[test]
fn what_was_done_with_a_wheel_counts_for_its_id_and_side_only() {
    let mut setup = Setup::default();
    for wheel in &mut setup.wheels {
        (wheel.has_id, wheel.is_right) = (true, true);
    }
    setup.edit(|wheels| {
        wheels[0].id = 9;
        wheels[1].turn_side();
        wheels[2].name = "Third".to_owned();
        wheels.remove(3);
    });
    let done: Vec<_> = setup
        .wheels
        .iter()
        .map(|wheel| (wheel.has_id, wheel.is_right))
        .collect();
    assert_eq!(done, [(false, false), (true, false), (true, true)]);
}

#[test]
fn the_only_motor_with_the_id_gets_its_label_and_the_next_wheel_follows() {
    let mut setup = finding();
    setup.on_ids(&scanned(&[2]));
    assert_eq!((setup.step, setup.act), (Step::Label(1), Act::None));
    assert!(setup.wheels[1].has_id && !setup.wheels[0].has_id);
    assert_eq!(setup.said, Said::Ids(text("what the ID manager says")));
    setup.next_wheel();
    assert_eq!((setup.step, &setup.said), (Step::Id(2), &Said::Nothing));
    setup.next_wheel();
    setup.next_wheel();
    assert_eq!(setup.step, Step::Check, "after the last wheel");
}

#[test]
fn anything_but_the_one_motor_keeps_the_step_and_says_why() {
    let said = || Said::Ids(text("what the ID manager says"));
    for (progress, why) in [
        (scanned(&[]), said()),
        (scanned(&[1, 2]), Said::Several(vec![id(1), id(2)])),
        // Another motor got another ID, by the tab.
        (scanned(&[7]), said()),
        (ended(Some(End::Failed)), said()),
        (ended(Some(End::Kept)), Said::Kept(None)),
        // A stop, another motor, or a declined question.
        (ended(None), Said::Cancelled),
    ] {
        let mut setup = finding();
        setup.on_ids(&progress);
        assert_eq!((setup.step, setup.act), (Step::Id(1), Act::None));
        assert!(!setup.wheels[1].has_id, "{why:?}");
        assert_eq!(setup.said, why);
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
    assert_eq!(setup.said, Said::Kept(Some(SetIdFrames::Ten)));
}

#[test]
fn a_result_that_nobody_asked_for_here_changes_nothing() {
    for step in [Step::Wheels, Step::Id(1), Step::Label(1), Step::Check] {
        let mut setup = Setup::at(step, Layout::Four.wheels());
        let before = setup.clone();
        setup.on_ids(&scanned(&[2]));
        assert_eq!(setup, before, "{step:?}");
    }
}

#[test]
fn a_lost_port_ends_what_is_done_and_keeps_the_step() {
    for (mut setup, step) in [(finding(), Step::Id(1)), (checking(), Step::Check)] {
        setup.disconnected();
        assert_eq!((setup.step, setup.act), (step, Act::None));
        assert_eq!(setup.said, Said::Disconnected);
        setup.on_ids(&scanned(&[2]));
        assert_eq!(setup.step, step, "a late result");
        assert!(!setup.wheels[1].has_id);
    }
    let mut idle = Setup::at(Step::Label(1), Layout::Four.wheels());
    idle.disconnected();
    assert_eq!(idle.said, Said::Nothing);
}

#[test]
fn a_refused_scan_keeps_the_step_and_says_why() {
    let mut setup = finding();
    setup.refused("a scan runs".to_owned());
    assert_eq!((setup.step, setup.act), (Step::Id(1), Act::None));
    assert_eq!(setup.said, Said::Refused("a scan runs".to_owned()));
}

#[test]
fn nothing_else_begins_while_something_is_done() {
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
fn a_reload_goes_on_at_the_step_and_does_nothing_by_itself() {
    let mut set = finding();
    set.on_ids(&scanned(&[2]));
    for (setup, step) in [
        (finding(), Step::Id(1)),
        (set, Step::Label(1)),
        (checking(), Step::Check),
    ] {
        let after = reloaded(&setup);
        assert_eq!((after.step, after.act), (step, Act::None));
        assert_eq!(after.wheels, setup.wheels);
    }
}

#[test]
fn the_check_names_who_is_missing_and_who_is_too_many() {
    let mut setup = checking();
    assert!(!setup.may_spin());
    setup.on_ids(&scanned(&[1, 3, 9]));
    assert_eq!(setup.act, Act::None);
    let answers: Vec<_> = setup
        .wheels
        .iter()
        .map(|wheel| setup.has_answered(wheel))
        .collect();
    assert_eq!(answers, [Some(true), Some(false), Some(true), Some(false)]);
    assert_eq!(setup.strangers(), [id(9)]);
    assert!(setup.may_spin());
    setup.set_id_of(1);
    assert_eq!(setup.step, Step::Id(1));
}

#[test]
fn a_check_without_an_answer_or_without_an_end_leads_nowhere() {
    for progress in [scanned(&[]), scanned(&[9]), ended(Some(End::Failed))] {
        let mut setup = checking();
        setup.on_ids(&progress);
        setup.begin_spins();
        assert_eq!((setup.step, setup.act), (Step::Check, Act::None));
    }
    let mut setup = checking();
    setup.on_ids(&scanned(&[1]));
    setup.disconnected();
    setup.begin_spins();
    assert_eq!(
        setup.step,
        Step::Check,
        "what answered is not known any more"
    );
}

#[test]
fn each_step_leads_back_to_the_one_before() {
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
fn beginning_again_keeps_the_wheels_and_forgets_what_was_done() {
    let mut wheels = Layout::Two.wheels();
    for wheel in &mut wheels {
        (wheel.has_id, wheel.is_right) = (true, true);
    }
    let mut setup = Setup::at(Step::Done, wheels);
    setup.begin_again();
    assert_eq!(setup, Setup::at(Step::Wheels, Layout::Two.wheels()));
}
