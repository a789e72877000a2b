//! Echoes, junk, cut frames and several replies in the received bytes.

use super::*;
use motorlink_protocol::family::Reading;

#[path = "receiver/old_bytes_tests.rs"]
mod old_bytes;

const QUERY: &str = "01 74 00 00 00 00 00 00 00 04";
const REPLY: &str = "01 02 00 0A 00 00 20 F6 00 4A";
const ID: MotorId = MotorId::FIRST;

fn frame(text: &str) -> Frame {
    text.parse().unwrap()
}

fn received(frame: Frame) -> Segment {
    let reading = Reading::decode(Model::Ddsm115, &frame, None).unwrap();
    Segment::Reply(ReceivedReply { frame, reading })
}

fn frames(other_bytes: &OtherBytes) -> Vec<Frame> {
    other_bytes
        .replies()
        .map(|received| received.frame)
        .collect()
}

fn after(bytes: &[u8]) -> Receiver {
    let mut receiver = Receiver::new(Model::Ddsm115);
    receiver.push(bytes);
    receiver
}

#[test]
fn a_reply_is_found_behind_an_echo_of_any_length() {
    for cut in 0..=FRAME_LEN {
        let mut bytes = frame(QUERY).bytes()[..cut].to_vec();
        bytes.extend(frame(REPLY).bytes());
        let mut receiver = after(&bytes);
        assert_eq!(
            receiver.find(ID, Layout::Query, &frame(QUERY), false),
            Found::At(cut),
            "echo of {cut} bytes"
        );
        let (found, before) = receiver.take(cut, &frame(QUERY)).unwrap();
        assert_eq!(found.frame, frame(REPLY));
        assert_eq!(
            before,
            OtherBytes {
                echoed: cut,
                ..OtherBytes::default()
            }
        );
    }
}

#[test]
fn the_last_bytes_of_an_echo_before_a_reply_are_no_junk() {
    for length in 2..FRAME_LEN {
        let mut bytes = frame(QUERY).bytes()[FRAME_LEN - length..].to_vec();
        bytes.extend(frame(REPLY).bytes());
        let (_, before) = after(&bytes).take(length, &frame(QUERY)).unwrap();
        assert_eq!((before.echoed, before.junk_bytes), (length, 0));
        let all = after(&bytes).clear(&frame(QUERY));
        assert_eq!((all.echoed, all.junk_bytes), (length, 0));
        assert_eq!(frames(&all), [frame(REPLY)]);
    }
}

#[test]
fn an_echo_alone_is_no_reply() {
    let mut receiver = after(frame(QUERY).bytes());
    assert_eq!(
        receiver.find(ID, Layout::Query, &frame(QUERY), true),
        Found::Nothing
    );
    assert_eq!(receiver.clear(&frame(QUERY)).echoed, FRAME_LEN);
}

#[test]
fn a_reply_is_found_behind_junk_of_any_length() {
    for length in 0..CAPACITY - FRAME_LEN {
        let mut bytes = vec![0x55; length];
        bytes.extend(frame(REPLY).bytes());
        assert_eq!(
            after(&bytes).find(ID, Layout::Query, &frame(QUERY), false),
            Found::At(length)
        );
    }
}

#[test]
fn a_flood_keeps_the_newest_bytes() {
    let mut receiver = after(&[0x55; 1000]);
    receiver.push(frame(REPLY).bytes());
    assert_eq!(
        receiver.find(ID, Layout::Query, &frame(QUERY), false),
        Found::At(CAPACITY - FRAME_LEN)
    );
    let (_, before) = receiver.take(CAPACITY - FRAME_LEN, &frame(QUERY)).unwrap();
    assert_eq!(before.junk_bytes, 1000);
}

/// One byte of echo in front of a reply whose shifted image has a good CRC too: motor 1 in the
/// current loop, so that the shifted mode byte is 1.
#[test]
fn a_shifted_image_with_a_good_crc_is_not_taken_for_the_reply() {
    let image = (0..=u16::MAX)
        .map(|position| {
            let [hi, lo] = position.to_be_bytes();
            Frame::with_crc([1, 1, 0, 40, 0, 0, hi, lo, 0])
        })
        .find(|true_reply| {
            let mut shifted = vec![1];
            shifted.extend(&true_reply.bytes()[..9]);
            Frame::new(shifted.try_into().unwrap()).crc_holds()
        })
        .expect("one in 256 does");
    let mut receiver = after(&[1]);
    receiver.push(&image.bytes()[..9]);
    assert_eq!(
        receiver.find(ID, Layout::Query, &frame(QUERY), false),
        Found::Ambiguous
    );
    receiver.push(&image.bytes()[9..]);
    assert_eq!(
        receiver.find(ID, Layout::Query, &frame(QUERY), false),
        Found::At(1)
    );
}

/// Two replies in one chunk, found by the fault simulation: the last byte of the first and nine bytes of
/// the second have a good CRC as a reply of motor 2 at 2,048 rpm.
#[test]
fn a_window_across_two_good_frames_is_not_taken_for_a_reply() {
    let first = frame("02 02 00 08 00 00 75 7F 00 02");
    let second = frame("01 01 00 08 00 00 58 00 10 85");
    let sent = frame("02 74 00 00 00 00 00 00 00 F1");
    let bytes = [*first.bytes(), *second.bytes()].concat();
    let image: [u8; FRAME_LEN] = bytes[9..19].try_into().unwrap();
    assert!(Frame::new(image).crc_holds());
    let motors = [(MotorId::new(2).unwrap(), 0), (ID, 10)];
    for (id, offset) in motors {
        for settled in [false, true] {
            let found = after(&bytes).find(id, Layout::Query, &sent, settled);
            assert_eq!(found, Found::At(offset), "{id}");
        }
    }
    assert_eq!(frames(&after(&bytes).clear(&sent)), [first, second]);
}

/// One byte of the echo and nine of the reply have a good CRC as a reply without a fault, found by the fault simulation.
/// A reply without a fault and a stray byte behind it may look the same.
#[test]
fn a_reply_with_a_fault_behind_one_echoed_byte_is_no_other_reply() {
    let sent = frame("02 74 00 00 00 00 00 00 00 F1");
    let reply = frame("02 02 00 08 00 00 4F 00 10 85");
    let bytes = [&sent.bytes()[..1], reply.bytes()].concat();
    let image: [u8; FRAME_LEN] = bytes[..FRAME_LEN].try_into().unwrap();
    assert!(Frame::new(image).crc_holds());
    let id = MotorId::new(2).unwrap();
    assert_eq!(
        after(&bytes).find(id, Layout::Query, &sent, false),
        Found::Ambiguous
    );
    assert_eq!(
        after(&bytes).find(id, Layout::Query, &sent, true),
        Found::Nothing
    );
}

/// While the second reply is incomplete, the window across both looks like the last reply. More bytes may come.
#[test]
fn a_window_that_ends_the_bytes_is_not_taken_before_the_line_is_quiet() {
    let bytes = [
        *frame("02 02 00 08 00 00 75 7F 00 02").bytes(),
        *frame("01 01 00 08 00 00 58 00 10 85").bytes(),
    ]
    .concat();
    let sent = frame("02 74 00 00 00 00 00 00 00 F1");
    let mut receiver = after(&bytes[..19]);
    let second = MotorId::new(2).unwrap();
    assert_eq!(
        receiver.find(second, Layout::Query, &sent, false),
        Found::Ambiguous
    );
    receiver.push(&bytes[19..]);
    assert_eq!(
        receiver.find(second, Layout::Query, &sent, false),
        Found::At(0)
    );
}

/// The last byte of a corrupt frame and nine bytes of the good frame after it have a good CRC, too.
#[test]
fn the_first_of_a_row_of_frames_is_found_behind_a_spoilt_one() {
    let first = frame("02 02 00 08 00 00 75 7F 00 02");
    let second = frame(REPLY);
    let last = (1..u8::MAX)
        .find(|last| {
            replier_at(
                Model::Ddsm115,
                &[&[*last], first.bytes().as_slice()].concat(),
                0,
            )
            .is_some()
        })
        .expect("the CRC tells all first bytes apart");
    let mut bytes = vec![0x55; 9];
    bytes.push(last);
    bytes.extend(first.bytes());
    bytes.extend(second.bytes());
    let mut receiver = after(&bytes);
    let id = MotorId::new(2).unwrap();
    assert_eq!(
        receiver.find(id, Layout::Query, &frame(QUERY), false),
        Found::At(10)
    );
    let rest = receiver.clear(&frame(QUERY));
    assert_eq!(frames(&rest), [first, second], "{last:02X}");
}

#[test]
fn behind_junk_that_makes_an_image_the_reply_is_the_window_that_ends_the_bytes() {
    let reply = *frame(REPLY).bytes();
    let junk = (0..=u16::MAX)
        .map(|junk| [1, 2, junk.to_be_bytes()[0], junk.to_be_bytes()[1]])
        .find(|junk| replier_at(Model::Ddsm115, &[junk.as_slice(), &reply].concat(), 0).is_some())
        .expect("one in 256 does");
    let mut receiver = after(&[junk.as_slice(), &reply].concat());
    assert_eq!(
        receiver.find(ID, Layout::Query, &frame(QUERY), false),
        Found::Ambiguous
    );
    assert_eq!(
        receiver.find(ID, Layout::Query, &frame(QUERY), true),
        Found::At(4)
    );
    let (taken, before) = receiver.take(4, &frame(QUERY)).unwrap();
    assert_eq!((taken.frame, before.junk_bytes), (frame(REPLY), 4));
}

#[test]
fn a_late_reply_in_front_is_not_taken_for_an_echo_of_its_first_byte() {
    let rest = after(frame(REPLY).bytes()).clear(&frame(QUERY));
    assert_eq!(
        rest,
        OtherBytes {
            segments: vec![received(frame(REPLY))],
            ..OtherBytes::default()
        }
    );
}

#[test]
fn a_spoilt_reply_is_no_echo_of_one_byte() {
    let mut spoilt = *frame(REPLY).bytes();
    spoilt[9] ^= 1;
    let rest = after(&spoilt).clear(&frame(QUERY));
    assert_eq!(
        rest,
        OtherBytes {
            segments: vec![Segment::Junk(JunkBytes::new(&spoilt))],
            junk_bytes: 10,
            ..OtherBytes::default()
        }
    );
}

#[test]
fn frames_of_others_are_kept_apart_from_junk() {
    let other = Frame::with_crc([2, 2, 0, 0, 0, 0, 30, 0, 0]);
    let mut bytes = vec![0x33];
    bytes.extend(other.bytes());
    bytes.extend(frame(REPLY).bytes());
    let mut receiver = after(&bytes);
    assert_eq!(
        receiver.find(ID, Layout::Query, &frame(QUERY), false),
        Found::At(11)
    );
    let (_, before) = receiver.take(11, &frame(QUERY)).unwrap();
    assert_eq!(
        before,
        OtherBytes {
            echoed: 0,
            segments: vec![Segment::Junk(JunkBytes::new(&[0x33])), received(other)],
            junk_bytes: 1,
            ..OtherBytes::default()
        }
    );
}

/// Seed 12313 of the fault simulation. The frame that begins at its second byte has a good CRC too,
/// with fault bits that no motor is known to set.
#[test]
fn a_stray_byte_behind_a_reply_makes_no_other_reply_of_it() {
    let id = MotorId::new(2).unwrap();
    let reply = frame("02 02 03 79 00 0A 74 57 00 ED");
    let query = frame("02 74 00 00 00 00 00 00 00 F1");
    let mut receiver = after(reply.bytes());
    receiver.push(&[0x85]);
    let Found::At(offset) = receiver.find(id, Layout::Query, &query, true) else {
        panic!("no reply");
    };
    let (found, _) = receiver.take(offset, &query).unwrap();
    assert_eq!(found.frame, reply);
}

/// Seed 304647: as before, but with fault bits that a motor may set. One byte of an echo before a reply with that fault
/// looks the same.
#[test]
fn a_stray_byte_that_makes_a_reply_with_a_known_fault_makes_the_reply_unclear() {
    let id = MotorId::new(3).unwrap();
    let reply = frame("03 03 01 6C 00 00 1C CA 00 11");
    let query = frame("03 74 00 00 00 00 00 00 00 55");
    let mut receiver = after(reply.bytes());
    receiver.push(&[0x4B]);
    assert_eq!(
        receiver.find(id, Layout::Query, &query, true),
        Found::Nothing
    );
}

/// The id and the loop of the motor in bytes 6 and 7 of its reply: another reply may begin there.
#[test]
fn a_reply_in_which_another_may_begin_is_found_once_the_other_could_be_complete() {
    let query = frame(QUERY);
    let reply = Frame::with_crc([1, 2, 0, 10, 0, 0, 1, 2, 0]);
    let mut receiver = after(reply.bytes());
    receiver.push(&[0; 5]);
    let found = |receiver: &Receiver, settled| receiver.find(ID, Layout::Query, &query, settled);
    assert_eq!(found(&receiver, false), Found::Ambiguous);
    assert_eq!(found(&receiver, true), Found::At(0));
    receiver.push(&[0]);
    assert_eq!(found(&receiver, false), Found::At(0));
}
