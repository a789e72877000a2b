use motorlink_messages::bus::{IdQueryOutcome, Refusal, StopReason};

use super::*;
use crate::model::scan_texts::tests::{id, new_id, report};

const SCANNING: JobStatus = JobStatus::Scanning {
    asked: 100,
    of: 254,
    left_ms: 900,
    found: Vec::new(),
};

/// The bus is seen scanning.
fn proving(to: u8) -> IdManager {
    let mut ids = IdManager::default();
    ids.request(new_id(to));
    assert!(ids.update(Some(&SCANNING)));
    assert!(!ids.update(Some(&SCANNING)), "once");
    ids
}

/// The bus has told this, and scans no more.
fn ended(ids: &mut IdManager, report: ScanReport) {
    ids.on_notice(&Notice::ScanEnded(report));
    ids.update(None);
}

fn asking() -> IdManager {
    let mut ids = proving(5);
    ended(&mut ids, report(&[1], &[]));
    assert_eq!(ids.question(), Some(change(SetIdFrames::Five)));
    ids
}

fn change(frames: SetIdFrames) -> IdChange {
    let (from, to) = (id(1), new_id(5));
    IdChange { from, to, frames }
}

fn set_id(frames: SetIdFrames) -> Command {
    let IdChange { from, to, frames } = change(frames);
    Command::SetId { from, to, frames }
}

fn setting() -> IdManager {
    let mut ids = asking();
    assert!(ids.agree().is_some());
    ids
}

fn refused(command: Command, refusal: Refusal) -> Notice {
    let command = command.into();
    Notice::Refused { command, refusal }
}

#[test]
fn one_motor_found_alone_is_asked_about_and_set_once() {
    let mut ids = asking();
    let (from, to) = (id(1), new_id(5));
    assert_eq!(ids.agree(), Some(set_id(SetIdFrames::Five)));
    assert_eq!(ids.agree(), None, "a second click sets nothing");
    assert_eq!(ids.question(), None);
    assert!(ids.message().title.contains("to ID 0x05"));

    let outcome = IdChangeOutcome::Changed;
    ids.on_notice(&Notice::IdChangeEnded { from, to, outcome });
    assert_eq!(ids.message().title, "Motor 0x01 now has ID 0x05");
    assert_eq!(ids.found(), [id(5)]);
}

#[test]
fn whatever_else_is_found_is_refused_with_the_reason() {
    let cancelled = ScanReport {
        complete: false,
        ..report(&[1], &[])
    };
    for (report, why) in [
        (report(&[1, 2], &[]), "2 motors found"),
        (report(&[], &[]), "no motors found"),
        (report(&[1], &[9]), "noise at 0x09"),
        (report(&[5], &[]), "already has this ID"),
        (cancelled, "the scan was cancelled"),
    ] {
        let mut ids = proving(5);
        ended(&mut ids, report);
        assert_eq!(ids.question(), None, "{why}");
        assert!(ids.message().title.contains(why), "{}", ids.message().title);
    }
}

#[test]
fn every_end_of_the_change_ends_the_wish_and_is_said() {
    let (from, to) = (id(1), new_id(5));
    for outcome in [
        IdChangeOutcome::Changed,
        IdChangeOutcome::Kept {
            frames: SetIdFrames::Five,
        },
        IdChangeOutcome::Lost,
        IdChangeOutcome::Both,
        IdChangeOutcome::NotAlone,
        IdChangeOutcome::NotStopped,
        IdChangeOutcome::Cancelled { frames_sent: 0 },
        IdChangeOutcome::Cancelled { frames_sent: 4 },
    ] {
        let mut ids = setting();
        ids.on_notice(&Notice::IdChangeEnded { from, to, outcome });
        let words = scan_texts::of_id_change(from, to, outcome);
        assert_eq!(ids.message(), words, "{outcome:?}");
        ended(&mut ids, report(&[1], &[]));
        assert_eq!(ids.question(), None, "{outcome:?}");
    }
}

#[test]
fn a_scan_that_ends_after_a_cancelled_wish_asks_nothing() {
    for begin in [proving as fn(u8) -> IdManager, |to| {
        let mut ids = IdManager::default();
        ids.request(new_id(to));
        ids
    }] {
        let mut ids = begin(5);
        ids.give_up();
        ended(&mut ids, report(&[1], &[]));
        assert_eq!(ids.question(), None);
        assert!(ids.message().title.starts_with("Full scan: motor 0x01"));
    }
}

#[test]
fn a_report_of_a_scan_from_before_the_wish_proves_nothing() {
    let mut ids = IdManager::default();
    ids.scan();
    ids.request(new_id(5));
    // In one message: the old scan has ended, and the one that was asked for has begun.
    ids.on_notice(&Notice::ScanEnded(report(&[1], &[])));
    assert_eq!(ids.question(), None);
    assert!(ids.update(Some(&SCANNING)));
    ended(&mut ids, report(&[1, 2], &[]));
    assert_eq!(ids.question(), None);
    assert!(ids.message().title.contains("2 motors found"));
}

#[test]
fn another_scan_in_between_ends_the_wish() {
    let mut ids = proving(5);
    ids.scan();
    ended(&mut ids, report(&[1], &[]));
    assert_eq!(ids.question(), None);

    // Also when it ends while the question is open.
    let mut ids = asking();
    ended(&mut ids, report(&[1, 2], &[]));
    assert_eq!(ids.question(), None);
    assert_eq!(ids.agree(), None);
}

#[test]
fn a_stop_ends_the_wish_and_the_stop_before_a_scan_does_not() {
    for (reason, goes_on) in [
        (StopReason::Operator, false),
        (StopReason::PageSilent, false),
        (StopReason::PageHidden, false),
        (StopReason::Job, true),
    ] {
        let mut ids = proving(5);
        ids.on_notice(&Notice::StopBegan(reason));
        ended(&mut ids, report(&[1], &[]));
        assert_eq!(ids.question().is_some(), goes_on, "{reason:?}");
    }
    let mut ids = asking();
    ids.give_up();
    assert_eq!((ids.question(), ids.agree()), (None, None));
}

#[test]
fn a_lost_port_forgets_everything() {
    for mut ids in [proving(5), asking(), setting()] {
        ids.disconnected();
        assert_eq!(ids, IdManager::default());
        ended(&mut ids, report(&[1], &[]));
        assert_eq!(ids.question(), None);
    }
}

#[test]
fn a_scan_that_vanishes_without_a_report_leaves_nothing_pending() {
    let mut ids = proving(5);
    assert!(ids.update(None));
    ended(&mut ids, report(&[1], &[]));
    assert_eq!(ids.question(), None);
}

#[test]
fn a_refused_command_ends_the_wish_and_says_why() {
    let mut ids = IdManager::default();
    ids.request(new_id(5));
    ids.on_notice(&refused(Command::FullScan, Refusal::JobRunning));
    assert!(ids.message().advice[0].contains("bus scan is running"));
    ended(&mut ids, report(&[1], &[]));
    assert_eq!(ids.question(), None);

    let command = set_id(SetIdFrames::Five);
    for notice in [
        refused(command, Refusal::NotProvedAlone),
        Notice::TooLate(command.into()),
    ] {
        let mut ids = setting();
        ids.on_notice(&notice);
        assert!(
            !ids.message().title.contains("Changing motor"),
            "{notice:?}"
        );
    }

    // What another part of the page asked for is not ours.
    let mut ids = proving(5);
    ids.on_notice(&refused(Command::StopRaw, Refusal::JobRunning));
    ended(&mut ids, report(&[1], &[]));
    assert!(ids.question().is_some());
}

#[test]
fn garbled_answers_offer_the_full_scan_until_it_is_pressed() {
    let mut ids = IdManager::default();
    ids.on_notice(&Notice::IdQueryEnded(IdQueryOutcome::Garbled));
    assert!(ids.offers_full_scan());
    ids.scan();
    assert!(!ids.offers_full_scan());
}

fn frames_of(count: u8) -> SetIdFrames {
    let all = std::iter::successors(Some(SetIdFrames::default()), |frames| frames.more());
    all.into_iter()
        .find(|frames| frames.count() == count)
        .unwrap()
}

/// Twice as many each time, until that is the most.
#[test]
fn a_motor_that_kept_its_id_is_offered_more_frames_up_to_a_bound() {
    let mut ids = setting();
    let (from, to) = (id(1), new_id(5));
    for (sent, more) in [(5, Some(10)), (10, Some(20)), (20, Some(40)), (40, None)] {
        assert!(ids.message().advice[0].contains(&format!("{sent} frames")));
        assert_eq!(ids.offers_more(), None, "while it is being set");
        let frames = frames_of(sent);
        let outcome = IdChangeOutcome::Kept { frames };
        ids.on_notice(&Notice::IdChangeEnded { from, to, outcome });
        assert_eq!(ids.offers_more().map(SetIdFrames::count), more);
        let said = ids.message().advice.join(" ");
        assert!(said.contains(&format!("{sent} frames in a row")), "{said}");
        let Some(more) = more else {
            assert!(!said.contains("Or press Send"), "{said}");
            break;
        };
        assert!(said.contains(&format!("Send {more} frames")), "{said}");
        assert!(ids.request_more());
        assert_eq!((ids.question(), ids.offers_more()), (None, None));
        assert!(ids.update(Some(&SCANNING)), "it is proved once more");
        ended(&mut ids, report(&[1], &[]));
        assert_eq!(ids.question().map(|asked| asked.frames.count()), Some(more));
        assert!(ids.agree().is_some());
    }
    assert!(!ids.request_more());
}

#[test]
fn more_frames_are_offered_after_a_verified_failure_only() {
    let (from, to) = (id(1), new_id(5));
    for outcome in [
        IdChangeOutcome::Changed,
        IdChangeOutcome::Lost,
        IdChangeOutcome::Both,
        IdChangeOutcome::NotAlone,
        IdChangeOutcome::Cancelled { frames_sent: 4 },
    ] {
        let mut ids = setting();
        ids.on_notice(&Notice::IdChangeEnded { from, to, outcome });
        assert_eq!(ids.offers_more(), None, "{outcome:?}");
    }
    let ends: [fn(&mut IdManager); 3] = [IdManager::scan, IdManager::disconnected, |ids| {
        ids.request(new_id(6));
    }];
    for end in ends {
        let mut ids = setting();
        let frames = SetIdFrames::Five;
        let outcome = IdChangeOutcome::Kept { frames };
        ids.on_notice(&Notice::IdChangeEnded { from, to, outcome });
        end(&mut ids);
        assert_eq!(ids.offers_more(), None);
    }
}
