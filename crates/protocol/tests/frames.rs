//! Frames that are read, refused and explained: what a request asks for, and the texts of errors.

use motorlink_protocol::{
    Acceleration, AssignableId, Celsius, CoarsePosition, Current, CurrentTarget, Detail, Fault,
    Faults, Frame, Layout, Mode, MotorId, MotorIdError, Position, PositionTarget, Reply,
    ReplyError, Request, RequestError, Rpm, Setpoint, SpeedTarget, UnknownMode, explain_received,
    explain_sent,
};

const ID: MotorId = MotorId::FIRST;
/// A frame without its last byte; that byte if it is not a CRC; the places that must be zero.
type Kind = ([u8; 9], Option<u8>, &'static [usize]);

const QUERY: &str = "01 74 00 00 00 00 00 00 00 04";

fn frame(text: &str) -> Frame {
    text.parse().unwrap()
}

#[test]
fn a_captured_frame_has_its_crc_and_a_changed_one_does_not() {
    let query = frame(QUERY);
    assert_eq!((query.crc_found(), query.crc_expected()), (4, 4));
    assert!(query.crc_holds());
    let wrong = frame("01 74 00 00 00 00 00 00 00 05");
    assert_eq!((wrong.crc_found(), wrong.crc_expected()), (5, 4));
    assert!(!wrong.crc_holds());
    assert_eq!(format!("{query:?}"), format!("[{QUERY}]"));
}

#[test]
fn a_text_is_a_frame_only_with_ten_words_of_two_hex_digits() {
    let refused = |text: &str| text.parse::<Frame>().unwrap_err().to_string();
    for word in ["+1", "1", "001", "0G", "−1"] {
        let text = format!("01 {word} 00 00 00 00 00 00 00 04");
        assert!(text.parse::<Frame>().is_err(), "{text}");
    }
    assert_eq!(
        refused("01 +1"),
        "byte 1 is not two hex digits, such as 0A or FF"
    );
    assert_eq!(refused("01 74"), "a frame has 10 bytes, this has 2");
    let eleven = format!("{QUERY} 00");
    assert_eq!(refused(&eleven), "a frame has 10 bytes, this has 11");
}

#[test]
fn a_byte_that_must_be_zero_is_named_by_its_place() {
    let with_crc = |body| *Frame::with_crc(body).bytes();
    let kinds: [Kind; 4] = [
        ([1, 0x64, 0, 100, 0, 0, 0, 0, 0], None, &[4, 5, 8]),
        ([1, 0x74, 0, 0, 0, 0, 0, 0, 0], None, &[2, 3, 4, 5, 6, 7, 8]),
        (
            [1, 0xA0, 0, 0, 0, 0, 0, 0, 0],
            Some(2),
            &[2, 3, 4, 5, 6, 7, 8],
        ),
        (
            [0xAA, 0x55, 0x53, 1, 0, 0, 0, 0, 0],
            Some(0),
            &[4, 5, 6, 7, 8],
        ),
    ];
    for (body, last, places) in kinds {
        for place in places.iter().copied() {
            let mut body = body;
            body[place] = 1;
            let mut bytes = with_crc(body);
            bytes[9] = last.unwrap_or(bytes[9]);
            let parsed = Request::parse(&Frame::new(bytes));
            assert_eq!(
                parsed,
                Err(RequestError::NotZero { place }),
                "{}",
                Frame::new(bytes)
            );
        }
    }
}

/// Every kind of request, whom it addresses and the layout of its reply.
#[test]
fn a_request_knows_its_motor_and_the_layout_of_its_reply() {
    let set_id = Request::SetId {
        id: AssignableId::new(ID).unwrap(),
    };
    let mode = Mode::Current;
    for (request, addressee, layout) in [
        (
            Request::drive(ID, Setpoint::Brake),
            Some(ID),
            Some(Layout::Drive),
        ),
        (Request::Query { id: ID }, Some(ID), Some(Layout::Query)),
        (Request::SwitchMode { id: ID, mode }, Some(ID), None),
        (Request::IdQuery, None, Some(Layout::Drive)),
        (set_id, None, None),
    ] {
        assert_eq!(request.addressee(), addressee, "{request:?}");
        assert_eq!(request.reply_layout(), layout, "{request:?}");
        let raw = Request::Raw(request.frame());
        assert_eq!(raw.addressee(), None);
        assert_eq!(raw.reply_layout(), layout, "{request:?} as a raw frame");
    }
}

#[test]
fn a_setpoint_belongs_to_one_loop() {
    let speed = Setpoint::velocity(SpeedTarget::ZERO);
    let current = Setpoint::Current(CurrentTarget::ZERO);
    let position = Setpoint::Position(PositionTarget::default());
    let modes = [speed, Setpoint::Brake, current, position].map(Setpoint::mode);
    assert_eq!(
        modes,
        [
            Mode::Velocity,
            Mode::Velocity,
            Mode::Current,
            Mode::Position
        ]
    );
}

#[test]
fn the_last_two_bytes_of_a_reply_are_read_in_any_layout_later() {
    let query = frame("01 02 00 0A 00 00 20 F6 00 4A");
    let as_query = Detail::Query {
        temperature: Celsius::new(0x20),
        position: CoarsePosition::from_raw(0xF6),
    };
    let as_drive = Detail::Drive {
        position: Position::from_raw(0x20F6),
    };
    let unknown = Detail::Undetermined([0x20, 0xF6]);
    let layouts = [
        (None, unknown),
        (Some(Layout::Query), as_query),
        (Some(Layout::Drive), as_drive),
    ];
    for (first, detail) in layouts {
        let reply = Reply::decode(&query, first).unwrap();
        assert_eq!(reply.detail, detail);
        assert_eq!(reply.undetermined().detail, unknown);
        for (later, detail) in layouts {
            let reread = reply.in_layout(later);
            assert_eq!(reread, Reply { detail, ..reply });
            assert_eq!(reread.frame(), query);
        }
    }
}

#[test]
fn a_refused_request_says_what_is_wrong() {
    let refused = |text| Request::parse(&frame(text)).unwrap_err().to_string();
    assert_eq!(
        refused("01 74 00 00 00 00 00 00 00 05"),
        "CRC 05, expected 04"
    );
    assert_eq!(
        refused("01 A0 00 00 00 00 00 00 00 04"),
        "mode byte is 04; expected 01 (current), 02 (velocity) or 03 (position)"
    );
    assert_eq!(
        refused("00 A0 00 00 00 00 00 00 00 01"),
        "0 is not a valid ID: use 1 to 254"
    );
    assert_eq!(
        refused("01 A0 00 00 00 00 00 00 01 01"),
        "byte 8 must be 00 in this frame"
    );
    assert_eq!(
        refused("01 65 00 00 00 00 00 00 00 00"),
        "byte 1 is 65; expected 64 (drive), 74 (query) or A0 (mode)"
    );
    assert_eq!(
        refused("AA 55 53 C8 00 00 00 00 00 00"),
        "200 (0xC8) is reserved for the ID query: use another ID"
    );
}

#[test]
fn a_refused_reply_says_what_is_wrong() {
    let refused = |body| Reply::decode(&Frame::with_crc(body), None).unwrap_err();
    let no_motor = refused([0, 2, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(no_motor, ReplyError::BadId(MotorIdError::Zero));
    assert_eq!(no_motor.to_string(), "0 is not a valid ID: use 1 to 254");
    let echo = Reply::decode(&frame(QUERY), None).unwrap_err();
    assert_eq!(echo, ReplyError::BadMode(UnknownMode(0x74)));
    assert_eq!(
        echo.to_string(),
        "mode byte is 74; expected 01 (current), 02 (velocity) or 03 (position)"
    );
}

#[test]
fn a_speed_is_sent_with_its_acceleration() {
    let setpoint = Setpoint::Velocity {
        speed: SpeedTarget::clamped(100),
        acceleration: Acceleration::new(5),
    };
    let [.., acceleration, brake, last, _crc] = *Request::drive(ID, setpoint).frame().bytes();
    assert_eq!((acceleration, brake, last), (5, 0, 0));
}

/// The acceleration does something in the velocity loop only, and 0 is the default.
#[test]
fn an_acceleration_is_explained_where_it_has_an_effect() {
    let gentle = Frame::with_crc([1, 0x64, 0, 100, 0, 0, 5, 0, 0]);
    let explained = |mode| explain_sent(&gentle, mode).to_string();
    assert_eq!(explained(Some(Mode::Velocity)), "drive +100 rpm, accel 5");
    assert_eq!(explained(None), "drive, value 100, accel 5");
    assert_eq!(explained(Some(Mode::Current)), "drive +0.024 A");
    assert_eq!(explained(Some(Mode::Position)), "drive to 1.10°");
}

/// The maker's samples end it with 00, the article's table with the CRC; another program may end it with DE, the last
/// byte of the ID query.
#[test]
fn a_new_id_is_explained_with_each_ending_that_is_in_use() {
    let explained = |ending: u8| {
        let text = format!("AA 55 53 07 00 00 00 00 00 {ending:02X}");
        explain_sent(&frame(&text), None).to_string()
    };
    let crc = frame("AA 55 53 07 00 00 00 00 00 00").crc_expected();
    for ending in [0, crc, 0xde] {
        assert_eq!(explained(ending), "set ID 0x07 on all motors");
    }
    let wrong = explained(crc + 1);
    assert!(wrong.starts_with("CRC "), "{wrong}");
}

#[test]
fn a_reply_is_explained_with_its_loop_and_its_faults() {
    let reply = Reply {
        id: ID,
        mode: Mode::Position,
        current: Some(Current::from_raw(0)),
        speed: Some(Rpm::new(0)),
        detail: Detail::Undetermined([0, 0]),
        faults: Faults::NONE.with(Fault::Stall),
    };
    assert_eq!(
        explain_received(&reply.frame(), None).to_string(),
        "+0 rpm, +0.000 A, position loop, fault: stall"
    );
}
