use motorlink_messages::bus::SetIdFrames;

use super::*;

pub(crate) fn id(id: u8) -> MotorId {
    MotorId::new(id).unwrap()
}

pub(crate) fn new_id(to: u8) -> AssignableId {
    AssignableId::new(id(to)).unwrap()
}

/// Of a whole scan.
pub(crate) fn report(found: &[u8], noisy: &[u8]) -> ScanReport {
    let ids = |of: &[u8]| of.iter().map(|of| id(*of)).collect();
    ScanReport {
        found: ids(found),
        noisy: ids(noisy),
        fault: None,
        asked: 254,
        complete: true,
        took_ms: 2_060,
    }
}

fn text(words: &NoticeText) -> String {
    format!("{} | {}", words.title, words.advice.join(" "))
}

#[test]
fn a_scan_names_who_answers_and_where_there_is_noise() {
    assert_eq!(
        text(&of_scan(&report(&[1, 2, 7], &[]))),
        "Full scan: 3 motors found (0x01, 0x02, 0x07) | Queried all 254 addresses in 2.1 s."
    );
    let noisy = text(&of_scan(&report(&[1], &[5])));
    assert!(noisy.starts_with("Noise, but no valid reply at 0x05"));
    assert!(noisy.contains("share an ID"), "{noisy}");
    assert!(noisy.contains("motor 0x01 found"), "{noisy}");
    let none = text(&of_scan(&report(&[], &[])));
    assert!(none.contains("orange and white"), "{none}");
    let cancelled = ScanReport {
        complete: false,
        asked: 118,
        ..report(&[1], &[])
    };
    assert_eq!(
        text(&of_scan(&cancelled)),
        "Scan cancelled after 118 addresses | Before that: motor 0x01 found."
    );
}

#[test]
fn a_scan_names_what_it_has_shown_of_the_line() {
    let of = |found: &[u8], fault| ScanReport {
        fault: Some(fault),
        ..report(found, &[])
    };
    let blocks = of(&[1], ScanFault::Blocks);
    let words = text(&of_scan(&blocks));
    assert!(
        words.starts_with("The adapter delivers only blocks of 32 bytes"),
        "{words}"
    );
    assert!(words.contains("motor 0x01 found"), "{words}");
    let to = AssignableId::new(id(7)).unwrap();
    let refused = text(&of_no_proof(&blocks, to));
    assert!(refused.contains("only blocks of 32 bytes"), "{refused}");
    let floats = text(&of_scan(&of(&[], ScanFault::Floating)));
    assert!(
        floats.starts_with("Bytes without a motor: the bus floats"),
        "{floats}"
    );
}

#[test]
fn a_crowd_is_counted() {
    let crowd: Vec<u8> = (1..=12).collect();
    let words = text(&of_scan(&report(&crowd, &[])));
    assert!(words.contains("12 motors found"), "{words}");
    assert!(words.contains("0x08 and 4 more"), "{words}");
}

#[test]
fn an_id_that_is_not_changed_says_why_and_names_the_motors() {
    let cancelled = ScanReport {
        complete: false,
        ..report(&[1], &[])
    };
    for (report, why) in [
        (report(&[1, 2], &[]), "2 motors found (0x01, 0x02)"),
        (report(&[], &[]), "no motors found"),
        (report(&[1], &[9]), "noise at 0x09"),
        (cancelled, "the scan was cancelled"),
    ] {
        let words = text(&of_no_proof(&report, new_id(5)));
        assert!(words.starts_with("The ID was not changed: "), "{words}");
        assert!(words.contains(why), "{words}");
    }
    let words = text(&of_no_proof(&report(&[5], &[]), new_id(5)));
    assert!(words.starts_with("Motor 0x05 already has this ID"));
}

#[test]
fn every_end_of_an_id_change_says_what_to_do() {
    for (outcome, tone, what) in [
        (IdChangeOutcome::Changed, Tone::Calm, "now has ID 0x05"),
        (
            IdChangeOutcome::Kept {
                frames: SetIdFrames::Five,
            },
            Tone::Warning,
            "Power-cycle the motor",
        ),
        (IdChangeOutcome::Lost, Tone::Error, "Full scan"),
        (IdChangeOutcome::Both, Tone::Error, "Full scan"),
        (IdChangeOutcome::NotAlone, Tone::Warning, "Nothing was sent"),
        (IdChangeOutcome::NotStopped, Tone::Error, "Check the wheel"),
        (
            IdChangeOutcome::Cancelled { frames_sent: 0 },
            Tone::Calm,
            "Nothing was sent",
        ),
        (
            IdChangeOutcome::Cancelled { frames_sent: 3 },
            Tone::Warning,
            "The ID may be",
        ),
    ] {
        let words = of_id_change(id(1), new_id(5), outcome);
        assert_eq!(words.tone, tone, "{outcome:?}");
        assert!(text(&words).contains(what), "{}", text(&words));
    }
}

#[test]
fn two_motors_at_once_are_offered_the_full_scan() {
    let words = of_id_query(IdQueryOutcome::Garbled);
    assert_eq!(words.remedy, Some(Remedy::FullScan));
    assert!(text(&words).contains("Full scan queries each address"));
    let words = of_id_query(IdQueryOutcome::One(id(7)));
    assert_eq!(
        (words.remedy, words.title.as_str()),
        (None, "Motor 0x07 found")
    );
}

#[test]
fn progress_is_said_with_an_estimate() {
    let scanning = |asked, left_ms| JobStatus::Scanning {
        asked,
        of: 254,
        left_ms,
        found: vec![],
    };
    let words = |job| of_progress(Some(&job));
    assert_eq!(words(scanning(118, 900)), "118 of 254, about 1 s left");
    assert_eq!(words(scanning(0, 6_001)), "0 of 254, about 7 s left");
    assert!(words(JobStatus::Stopping).contains("Stopping motors first"));
    assert!(of_progress(None).contains("stops all motors first"));
}
