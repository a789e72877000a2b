//! The bytes of the messages, as docs/socket.md has them.
#![cfg(test)]

use super::*;

/// ARM or SETPOINTS of motors 1 and 5 with 1.5 and -2 rad/s, number 7, challenge 0x0102030405060708.
fn order_bytes(kind: u8) -> [u8; FROM_CLIENT] {
    let mut bytes = [0; FROM_CLIENT];
    bytes[..4].copy_from_slice(&[kind, 2, 0, 0]);
    bytes[4..8].copy_from_slice(&[7, 0, 0, 0]);
    bytes[8..16].copy_from_slice(&[8, 7, 6, 5, 4, 3, 2, 1]);
    bytes[16..18].copy_from_slice(&[1, 5]);
    bytes[24..32].copy_from_slice(&[0, 0, 0xC0, 0x3F, 0, 0, 0, 0xC0]);
    bytes
}

fn id(address: u8) -> MotorId {
    MotorId::new(address).unwrap()
}

#[test]
fn a_hello_has_magic_version_and_size() {
    assert_eq!(server_hello(), [0x89, b'M', b'L', b'S', 1, 0, 0xA0, 1]);
    assert_eq!(check_hello(b"\x89MLS\x01\x00\x38\x00"), Ok(()));
    assert_eq!(client_hello(), b"\x89MLS\x01\x00\x38\x00");
    assert_eq!(check_server_hello(b"\x89MLS\x01\x00\xA0\x01"), Ok(()));
    assert!(check_server_hello(b"\x89MLS\x02\x00\xA0\x01").is_err());
    assert!(check_server_hello(b"HTTP/1.1").is_err());
    let of_another = check_hello(b"\x89MLS\x02\x01\x38\x00");
    assert_eq!(of_another, Err(Refusal::Version(258)));
    assert_eq!(check_hello(b"GET / HT"), Err(Refusal::Magic));
}

#[test]
fn the_messages_of_a_client_are_read() {
    let order = Setpoints {
        number: 7,
        challenge: 0x0102_0304_0506_0708,
        speeds: vec![(id(1), 1.5), (id(5), -2.0)],
    };
    let arm = decode_from_client(&order_bytes(1));
    assert_eq!(arm, Ok(FromClient::Arm(order.clone())));
    let setpoints = decode_from_client(&order_bytes(2));
    assert_eq!(setpoints, Ok(FromClient::Setpoints(order.clone())));
    assert_eq!(
        encode_from_client(&FromClient::Arm(order.clone())),
        order_bytes(1)
    );
    assert_eq!(
        encode_from_client(&FromClient::Setpoints(order)),
        order_bytes(2)
    );
    let mut disarm = [0; FROM_CLIENT];
    disarm[0] = 3;
    assert_eq!(decode_from_client(&disarm), Ok(FromClient::Disarm));
    assert_eq!(encode_from_client(&FromClient::Disarm), disarm);
}

#[test]
fn garbage_is_named() {
    let with = |place: usize, byte: u8| {
        let mut bytes = order_bytes(2);
        bytes[place] = byte;
        decode_from_client(&bytes)
    };
    assert_eq!(with(0, 0), Err(Refusal::Kind(0)));
    assert_eq!(with(0, 4), Err(Refusal::Kind(4)));
    assert_eq!(with(1, 0), Err(Refusal::Motors));
    assert_eq!(with(1, 9), Err(Refusal::Motors));
    assert_eq!(with(16, 0), Err(Refusal::Motors));
    assert_eq!(with(16, 255), Err(Refusal::Motors));
    // The same ID twice.
    assert_eq!(with(16, 5), Err(Refusal::Motors));
}

#[test]
fn a_state_has_416_bytes_and_what_is_unknown_is_no_number() {
    let state = State {
        is_halted: false,
        is_open: true,
        drive: DriveState::Driven,
        ended: EndReason::None,
        arm: (7, None),
        challenge: 0x0102_0304_0506_0708,
        sent_us: 1_000_000,
        holder: (Holder::You, 3),
        model: Some(Model::Ddsm210),
        motors: vec![Motor {
            id: 5,
            activity: Activity::Driven,
            may_turn: true,
            faults: Some(0x10),
            is_silent: false,
            turns_unasked: false,
            reply_age: Some(500),
            position: Some((-2.0, 500)),
            velocity: Some((1.5, 500)),
            current: None,
            temperature: Some((31.0, 70_000)),
        }],
    };
    let bytes = encode_state(&state);
    assert_eq!(bytes.len(), FROM_SERVER);
    let head = [
        1, 5, 2, 0, 7, 0, 0, 0, 8, 7, 6, 5, 4, 3, 2, 1, 0x40, 0x42, 0x0F, 0, 0, 0, 0, 0, 3, 0, 0,
        0, 3, 1, 0, 3,
    ];
    assert_eq!(bytes[..32], head);
    let motor = [
        5, 1, 10, 0x10, 0xF4, 1, 0, 0, // motor, age of the reply
        0, 0, 0, 0, 0, 0, 0, 0xC0, // -2 rad
        0, 0, 0xC0, 0x3F, // 1.5 rad/s
        0, 0, 0xC0, 0x7F, // no current
        0, 0, 0xF8, 0x41, // 31 degrees Celsius
        0xF4, 1, 0, 0, 0xF4, 1, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 0x70, 0x11, 1, 0, 0, 0, 0, 0,
    ];
    assert_eq!(bytes[32..80], motor);
    let read = decode_from_server(&bytes.clone().try_into().unwrap());
    assert_eq!(read, Some(FromServer::State(state.clone())));
    // A place without a motor.
    assert_eq!(bytes[80..88], [0, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF]);
    let refused = State {
        arm: (8, Some(NotArmed::PageHasControl)),
        holder: (Holder::Page, 2),
        model: None,
        ..state
    };
    let bytes = encode_state(&refused);
    assert_eq!(bytes[1], 4);
    assert_eq!(bytes[24..32], [2, 0, 0, 0, 1, 1, 1, 0]);
    let read = decode_from_server(&bytes.try_into().unwrap());
    assert_eq!(read, Some(FromServer::State(refused)));
}

#[test]
fn an_error_says_both_versions() {
    let bytes = encode_error(Refusal::Version(2));
    assert_eq!(bytes.len(), FROM_SERVER);
    assert_eq!(bytes[..2], [2, 1]);
    let length = usize::from(u16::from_le_bytes([bytes[2], bytes[3]]));
    let text = std::str::from_utf8(&bytes[4..4 + length]).unwrap();
    assert!(
        text.contains("version 2") && text.contains("version 1"),
        "{text}"
    );
    assert!(bytes[4 + length..].iter().all(|byte| *byte == 0));
    let read = decode_from_server(&bytes.clone().try_into().unwrap());
    assert_eq!(read, Some(FromServer::Closes(text.to_owned())));
}

#[test]
fn a_message_that_the_client_does_not_know_is_none() {
    let mut bytes: [u8; FROM_SERVER] = encode_state(&State::default()).try_into().unwrap();
    assert!(decode_from_server(&bytes).is_some());
    bytes[2] = 6;
    assert_eq!(decode_from_server(&bytes), None);
    bytes[0] = 3;
    assert_eq!(decode_from_server(&bytes), None);
}
