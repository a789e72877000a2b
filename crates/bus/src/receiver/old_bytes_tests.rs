//! What bytes of earlier requests may be, and what they tell of the echo.

use super::*;

/// A drive frame, which is also a reply of a DDSM210 with this temperature.
fn drive(temperature: u8) -> Frame {
    Frame::with_crc([1, 0x64, 0, 0, 0, 0, 0, temperature, 0])
}

/// Whether a frame is found as the reply of a DDSM210 to another one.
fn finds(receiver: &mut Receiver, frame: Frame) -> bool {
    receiver.push(frame.bytes());
    let found = receiver.find(ID, Layout::Drive, &drive(0), true);
    receiver.buffer.clear();
    found == Found::At(0)
}

#[test]
fn a_block_is_remembered_until_the_end_of_the_exchange() {
    let query = frame(QUERY);
    let mut receiver = after(&[0; BLOCK - FRAME_LEN]);
    receiver.push(frame(REPLY).bytes());
    assert!(!receiver.clear(&query).is_block);
    receiver.push(&[0; BLOCK]);
    receiver.push(frame(REPLY).bytes());
    let (_, before) = receiver.take(BLOCK, &query).unwrap();
    assert!(before.is_block);
    assert!(receiver.clear(&query).is_block);
    assert!(!receiver.clear(&query).is_block);
}

/// Bytes before a reply tell nothing of the echo where they may be older than its request: in a block, and while a reply
/// is owed.
#[test]
fn old_bytes_rule_out_no_echo() {
    let query = frame(QUERY);
    let rules_out = |is_owed: bool, before: usize| {
        let mut receiver = after(&[]);
        for _ in 0..12 {
            if is_owed {
                receiver.window_ended(&query);
            }
            let bytes = [&vec![0; before], &frame(REPLY).bytes()[..]].concat();
            receiver.push(&bytes);
            receiver.take(before, &query).unwrap();
            receiver.clear(&query);
        }
        receiver.echo.is_ruled_out()
    };
    assert!(rules_out(false, 0) && rules_out(false, 1));
    assert!(rules_out(true, 0) && !rules_out(true, 1));
    assert!(!rules_out(false, BLOCK - FRAME_LEN));
}

/// The reply of a DDSM210 may be a copy of its request, as an echo is.
#[test]
fn a_copy_of_the_request_rules_out_no_echo() {
    let sent = drive(0);
    let other = drive(30);
    let ruled_out_by = |reply: Frame| {
        let mut receiver = Receiver::new(Model::Ddsm210);
        for _ in 0..12 {
            receiver.push(reply.bytes());
            receiver.take(0, &sent).unwrap();
        }
        receiver.echo.is_ruled_out()
    };
    assert!(ruled_out_by(other) && !ruled_out_by(sent));
}

#[test]
fn a_frame_like_an_unanswered_request_is_a_reply_once_nothing_is_owed() {
    let unanswered = drive(30);
    let sent = drive(0);
    let other = drive(31);
    let mut receiver = Receiver::new(Model::Ddsm210);
    receiver.window_ended(&unanswered);
    for _ in 0..OWED_MIN {
        assert!(receiver.is_owed() && !finds(&mut receiver, unanswered));
        receiver.push(other.bytes());
        receiver.take(0, &sent).unwrap();
    }
    assert!(finds(&mut receiver, unanswered));
}

/// On an adapter that does not echo, a copy of the request is the reply of a DDSM210.
#[test]
fn a_copy_is_no_reply_once_an_echo_was_detected() {
    let sent = drive(0);
    let other = drive(30);
    let mut receiver = Receiver::new(Model::Ddsm210);
    for _ in 0..12 {
        receiver.push(other.bytes());
        receiver.take(0, &sent).unwrap();
    }
    receiver.push(sent.bytes());
    let found = |receiver: &Receiver| receiver.find(ID, Layout::Drive, &sent, true);
    assert_eq!(found(&receiver), Found::At(0));
    receiver.echo_detected();
    assert_eq!(found(&receiver), Found::Copy);
}

/// Each doubt costs a request.
#[test]
fn a_copy_is_doubted_32_times_at_most() {
    let sent = drive(0);
    let mut receiver = Receiver::new(Model::Ddsm210);
    receiver.push(sent.bytes());
    for _ in 0..DOUBTS_MAX {
        assert!(receiver.has_doubtful_copy(&sent));
    }
    assert!(!receiver.has_doubtful_copy(&sent) && !receiver.wants_proof());
}

/// As if it came after its window: only the end of the exchange finds it.
#[test]
fn a_reply_at_the_end_of_an_exchange_tells_of_the_echo_too() {
    let query = frame(QUERY);
    let rules_out = |is_owed: bool, before: &[u8]| {
        let mut receiver = after(&[]);
        for _ in 0..12 {
            if is_owed {
                receiver.window_ended(&query);
            }
            receiver.push(&[before, frame(REPLY).bytes()].concat());
            receiver.clear(&query);
        }
        receiver.echo.is_ruled_out()
    };
    assert!(rules_out(false, &[]) && rules_out(false, &[0]));
    assert!(!rules_out(true, &[]) && !rules_out(false, &query.bytes()[..4]));
    assert!(!rules_out(false, &[0; BLOCK - FRAME_LEN]));
}

#[test]
fn replies_are_owed_for_the_last_8_unanswered_requests() {
    let sent = drive(0);
    let other = drive(31);
    let mut receiver = Receiver::new(Model::Ddsm210);
    for request in 0..=OWED_MAX {
        receiver.window_ended(&drive(40 + request));
    }
    assert!(finds(&mut receiver, drive(40)), "only the last are known");
    assert!(!finds(&mut receiver, drive(41)));
    for _ in 0..OWED_MAX {
        assert!(receiver.is_owed());
        receiver.push(other.bytes());
        receiver.take(0, &sent).unwrap();
    }
    assert!(!receiver.is_owed());
}
