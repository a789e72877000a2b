//! What looks say of a line, and what they leave to be asked.

use super::*;

fn id(address: u8) -> MotorId {
    MotorId::new(address).unwrap()
}

/// A scan that has found the motors 1 and 2.
fn scan() -> Scan {
    let mut scan = Scan::begin(Instant::ZERO, &[id(1), id(2)], RoundTrip::new(), 0);
    for motor in [1, 1, 2, 2] {
        look(&mut scan, motor, Look::Reply(Duration::from_millis(3)));
    }
    scan
}

fn look(scan: &mut Scan, address: u8, look: Look) {
    scan.looked(id(address), Instant::ZERO, look);
}

#[test]
fn a_reply_that_is_lost_asks_every_silent_address_once_more() {
    let mut scan = scan();
    assert_eq!(scan.passes(), 1);
    look(&mut scan, 1, Look::Silence);
    look(&mut scan, 7, Look::Silence);
    assert_eq!(scan.passes(), 2);
    look(&mut scan, 8, Look::Noise);
    assert_eq!(scan.passes(), 2, "that noise is not of the lost one");
}

#[test]
fn an_answer_that_met_the_next_question_is_not_lost_on_the_line() {
    let mut scan = scan();
    look(&mut scan, 1, Look::Silence);
    look(&mut scan, 7, Look::Noise);
    assert_eq!(scan.passes(), 1);
    assert!(scan.doubtful().contains(&id(7)), "it is asked again");
}

#[test]
fn who_may_have_answered_into_the_next_window_is_asked_again() {
    let mut scan = scan();
    look(&mut scan, 6, Look::Silence);
    look(&mut scan, 7, Look::Noise);
    assert_eq!(scan.doubtful(), [id(6), id(7)]);
    look(&mut scan, 6, Look::Silence);
    look(&mut scan, 7, Look::Silence);
    assert!(scan.doubtful().is_empty());
}
