//! What probes tell about the line, and which addresses are probed again.

use super::*;

fn id(address: u8) -> MotorId {
    MotorId::new(address).unwrap()
}

/// A scan that has found the motors 1 and 2.
fn scan() -> Scan {
    let mut scan = Scan::begin(Instant::ZERO, &[id(1), id(2)], RoundTrip::new(), 0);
    for motor in [1, 1, 2, 2] {
        probe(
            &mut scan,
            motor,
            ProbeResult::Reply(Duration::from_millis(3)),
        );
    }
    scan
}

fn probe(scan: &mut Scan, address: u8, result: ProbeResult) {
    scan.probe_ended(id(address), Instant::ZERO, result);
}

#[test]
fn a_reply_that_is_lost_asks_every_silent_address_once_more() {
    let mut scan = scan();
    assert_eq!(scan.passes(), 1);
    probe(&mut scan, 1, ProbeResult::Silence);
    probe(&mut scan, 7, ProbeResult::Silence);
    assert_eq!(scan.passes(), 2);
    probe(&mut scan, 8, ProbeResult::Noise);
    assert_eq!(scan.passes(), 2, "that noise is not of the lost one");
}

#[test]
fn an_answer_that_met_the_next_question_is_not_lost_on_the_line() {
    let mut scan = scan();
    probe(&mut scan, 1, ProbeResult::Silence);
    probe(&mut scan, 7, ProbeResult::Noise);
    assert_eq!(scan.passes(), 1);
    assert!(scan.doubtful().contains(&id(7)), "it is asked again");
}

#[test]
fn who_may_have_answered_into_the_next_window_is_asked_again() {
    let mut scan = scan();
    probe(&mut scan, 6, ProbeResult::Silence);
    probe(&mut scan, 7, ProbeResult::Noise);
    assert_eq!(scan.doubtful(), [id(6), id(7)]);
    probe(&mut scan, 6, ProbeResult::Silence);
    probe(&mut scan, 7, ProbeResult::Silence);
    assert!(scan.doubtful().is_empty());
}
