//! Scenarios of faults.

use motorlink_messages::protocol::Instant;

use super::*;

const ID: MotorId = MotorId::FIRST;

fn other() -> MotorId {
    MotorId::new(2).unwrap()
}

fn with(faults: &[Fault]) -> Faults {
    faults
        .iter()
        .fold(Faults::NONE, |all, fault| all.with(*fault))
}

/// Name, start and end of each fault.
fn entries(history: &FaultHistory, id: MotorId) -> Vec<(String, f64, End)> {
    let of = history.of(id);
    of.iter()
        .map(|one| (one.name(), one.came_ms, one.end))
        .collect()
}

fn stall(came_ms: f64, end: End) -> (String, f64, End) {
    ("stall".to_owned(), came_ms, end)
}

#[test]
fn a_fault_of_a_single_reply_is_kept_with_both_its_times() {
    let mut history = FaultHistory::default();
    assert!(!history.on_report(ID, Faults::NONE, 1.0));
    assert!(history.on_report(ID, with(&[Fault::Stall]), 2.0));
    assert!(history.on_report(ID, Faults::NONE, 4.0));
    for at_ms in [6.0, 8.0] {
        assert!(!history.on_report(ID, Faults::NONE, at_ms), "no news");
    }
    assert_eq!(entries(&history, ID), [stall(2.0, End::Gone(4.0))]);
    assert!(history.has_unseen(ID));
}

#[test]
fn two_faults_that_overlap_come_and_go_each_by_itself() {
    let mut history = FaultHistory::default();
    history.on_report(ID, with(&[Fault::Stall]), 1.0);
    history.on_report(ID, with(&[Fault::Stall, Fault::OverTemperature]), 2.0);
    history.on_report(ID, with(&[Fault::OverTemperature]), 3.0);
    let heat = |end| ("over-temperature".to_owned(), 2.0, end);
    assert_eq!(
        entries(&history, ID),
        [heat(End::Active), stall(1.0, End::Gone(3.0))]
    );
    history.on_report(ID, Faults::NONE, 4.0);
    assert_eq!(
        entries(&history, ID),
        [heat(End::Gone(4.0)), stall(1.0, End::Gone(3.0))]
    );
}

#[test]
fn what_is_still_there_stands_before_what_came_later_and_went() {
    let mut history = FaultHistory::default();
    history.on_report(ID, with(&[Fault::Stall]), 1.0);
    history.on_report(ID, with(&[Fault::Stall, Fault::Sensor]), 2.0);
    history.on_report(ID, with(&[Fault::Stall]), 3.0);
    assert_eq!(entries(&history, ID)[0], stall(1.0, End::Active));
}

#[test]
fn seen_while_it_is_there_a_fault_stays_until_it_goes() {
    let mut history = FaultHistory::default();
    history.on_report(ID, with(&[Fault::Stall]), 1.0);
    assert!(history.mark_seen(ID));
    assert!(!history.has_unseen(ID));
    assert!(!history.mark_seen(ID), "nothing more to be seen");
    assert!(!history.on_report(ID, with(&[Fault::Stall]), 2.0));
    assert_eq!(entries(&history, ID), [stall(1.0, End::Active)]);
    assert!(history.on_report(ID, Faults::NONE, 3.0));
    assert_eq!(entries(&history, ID), []);
    // The next occurrence is unseen again.
    history.on_report(ID, with(&[Fault::Stall]), 4.0);
    assert!(history.has_unseen(ID));
}

#[test]
fn what_has_ended_is_forgotten_once_seen_and_not_before() {
    let mut history = FaultHistory::default();
    history.on_report(ID, with(&[Fault::Stall]), 1.0);
    history.on_report(ID, Faults::NONE, 2.0);
    assert_eq!(entries(&history, ID).len(), 1);
    assert!(history.mark_seen(ID));
    assert_eq!(entries(&history, ID), []);
}

#[test]
fn the_faults_of_another_motor_are_its_own() {
    let mut history = FaultHistory::default();
    history.on_report(other(), with(&[Fault::Stall]), 1.0);
    history.on_report(ID, Faults::NONE, 2.0);
    assert_eq!(entries(&history, ID), []);
    assert!(!history.has_unseen(ID));
    assert!(!history.mark_seen(ID));
    assert_eq!(entries(&history, other()), [stall(1.0, End::Active)]);
}

#[test]
fn of_a_motor_that_is_heard_no_more_the_end_is_not_known() {
    let mut history = FaultHistory::default();
    history.on_report(ID, with(&[Fault::Stall]), 1.0);
    assert!(!history.end_unknown(Some(other())));
    assert!(history.end_unknown(None));
    assert!(!history.end_unknown(Some(ID)));
    assert_eq!(entries(&history, ID), [stall(1.0, End::Unknown)]);
    history.on_report(ID, with(&[Fault::Stall]), 9.0);
    assert_eq!(
        entries(&history, ID),
        [stall(9.0, End::Active), stall(1.0, End::Unknown)]
    );
}

#[test]
fn a_motor_of_a_recording_that_stopped_answering_leaves_its_fault_unknown() {
    let mut history = FaultHistory::default();
    let id = ID;
    let (at, stalled) = (Instant::ZERO, Some(with(&[Fault::Stall])));
    for (at_ms, faults) in [(1.0, stalled), (2.0, None), (3.0, stalled)] {
        history.on_change(&FaultChange { at, id, faults }, at_ms);
    }
    let expected = [stall(3.0, End::Active), stall(1.0, End::Unknown)];
    assert_eq!(entries(&history, ID), expected);
}

#[test]
fn a_bit_without_a_name_is_kept_by_its_number() {
    let mut history = FaultHistory::default();
    history.on_report(ID, Faults::from_byte(0x20), 1.0);
    assert_eq!(entries(&history, ID)[0].0, "bit 0x20");
}

#[test]
fn the_record_is_bounded_and_says_how_many_gave_way() {
    let mut history = FaultHistory::default();
    history.on_report(ID, with(&[Fault::OverTemperature]), 0.0);
    for place in 0..30_u8 {
        let at_ms = f64::from(place);
        history.on_report(
            ID,
            with(&[Fault::OverTemperature, Fault::Stall]),
            at_ms + 0.2,
        );
        history.on_report(ID, with(&[Fault::OverTemperature]), at_ms + 0.7);
    }
    let entries = entries(&history, ID);
    assert_eq!(entries.len(), FaultHistory::KEPT_MAX);
    assert_eq!(
        entries[0].0, "over-temperature",
        "what is still there does not give way"
    );
    assert_eq!(entries[1], stall(29.2, End::Gone(29.7)));
    assert_eq!(history.dropped(ID), 31 - FaultHistory::KEPT_MAX);
    history.mark_seen(ID);
    assert_eq!(history.dropped(ID), 0);
}
