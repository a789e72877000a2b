//! Every frame in `captures/` is a golden vector: what real motors said and published frames ask.

use motorlink_protocol::{
    Acceleration, AssignableId, Celsius, CoarsePosition, Current, CurrentTarget, Detail, Drive,
    Faults, Frame, Layout, Mode, MotorId, Position, PositionTarget, Reply, Request, Rpm, Setpoint,
    SpeedTarget, explain_received, explain_sent,
};

const COMMANDS: &str = include_str!("captures/commands.tsv");
const FRAMES: &str = include_str!("captures/frames.tsv");

const ID: MotorId = MotorId::FIRST;

fn rows(table: &str) -> impl Iterator<Item = Vec<&str>> {
    table
        .lines()
        .filter(|line| !line.starts_with('#') && !line.is_empty())
        .skip(1)
        .map(|line| line.split('\t').collect())
}

fn frame(text: &str) -> Frame {
    text.parse()
        .unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn speed(rpm: i32) -> Request {
    Request::drive(ID, Setpoint::velocity(SpeedTarget::new(rpm).unwrap()))
}

fn current(raw: i32) -> Request {
    Request::drive(ID, Setpoint::Current(CurrentTarget::new(raw).unwrap()))
}

fn position(raw: i32) -> Request {
    Request::drive(ID, Setpoint::Position(PositionTarget::new(raw).unwrap()))
}

/// What each published frame asks, written down by hand from its description.
fn published() -> Vec<(&'static str, Request)> {
    let set_id = Request::SetId {
        id: AssignableId::new(ID).unwrap(),
    };
    let switch = |mode| Request::SwitchMode { id: ID, mode };
    vec![
        ("C8 64 00 00 00 00 00 00 00 DE", Request::IdQuery),
        ("01 74 00 00 00 00 00 00 00 04", Request::Query { id: ID }),
        ("01 A0 00 00 00 00 00 00 00 01", switch(Mode::Current)),
        ("01 A0 00 00 00 00 00 00 00 02", switch(Mode::Velocity)),
        ("01 A0 00 00 00 00 00 00 00 03", switch(Mode::Position)),
        (
            "01 64 00 00 00 00 00 FF 00 D1",
            Request::drive(ID, Setpoint::Brake),
        ),
        ("01 64 00 00 00 00 00 00 00 50", speed(0)),
        ("01 64 FF 9C 00 00 00 00 00 9A", speed(-100)),
        ("01 64 FF CE 00 00 00 00 00 DA", speed(-50)),
        ("01 64 00 32 00 00 00 00 00 D3", speed(50)),
        ("01 64 00 64 00 00 00 00 00 4F", speed(100)),
        ("01 64 FF 6A 00 00 00 00 00 5A", speed(-150)),
        ("01 64 D8 F0 00 00 00 00 00 78", current(-10_000)),
        ("01 64 EC 78 00 00 00 00 00 D3", current(-5_000)),
        ("01 64 F8 30 00 00 00 00 00 08", current(-2_000)),
        ("01 64 07 D0 00 00 00 00 00 27", current(2_000)),
        ("01 64 13 88 00 00 00 00 00 A7", current(5_000)),
        ("01 64 27 10 00 00 00 00 00 57", current(10_000)),
        ("01 64 4E 20 00 00 00 00 00 5E", position(20_000)),
        ("01 64 75 30 00 00 00 00 00 A7", position(30_000)),
        ("01 64 20 00 00 00 00 00 00 BF", position(8_192)),
        ("AA 55 53 01 00 00 00 00 00 CB", set_id),
        ("AA 55 53 01 00 00 00 00 00 00", set_id),
    ]
}

#[test]
fn published_commands_are_read_as_described() {
    let published = published();
    let listed: Vec<&str> = rows(COMMANDS).map(|row| row[0]).collect();
    let known: Vec<&str> = published.iter().map(|(text, _)| *text).collect();
    assert_eq!(
        listed, known,
        "the table above has every capture, in its order"
    );
    for (text, request) in published {
        assert_eq!(Request::parse(&frame(text)), Ok(request), "{text}");
    }
}

#[test]
fn published_commands_are_written_to_the_byte() {
    for (text, request) in published() {
        // The tutorial's set ID ends with a CRC; the maker's, which we send, with 00.
        if text != "AA 55 53 01 00 00 00 00 00 CB" {
            assert_eq!(request.frame().to_string(), text);
        }
    }
}

/// The request that elicited a captured reply.
fn asked(elicited_by: &str) -> Layout {
    match elicited_by {
        "01 74 00 00 00 00 00 00 00 04" => Layout::Query,
        "C8 64 00 00 00 00 00 00 00 DE" | "drive +100 rpm" | "drive" => Layout::Drive,
        other => panic!("who asked? {other}"),
    }
}

#[test]
fn captured_replies_decode_and_encode_to_the_byte() {
    let mut seen = 0;
    for row in rows(FRAMES) {
        let (layout, heard) = (asked(row[1]), frame(row[2]));
        let reply = Reply::decode(&heard, Some(layout)).unwrap_or_else(|e| panic!("{heard}: {e}"));
        assert_eq!(
            (reply.id, reply.mode, reply.faults),
            (ID, Mode::Velocity, Faults::NONE)
        );
        assert_eq!(reply.frame(), heard);
        seen += 1;
    }
    assert_eq!(seen, 21);
}

fn drive_reply(text: &str) -> (i16, i16, u16) {
    let reply = Reply::decode(&frame(text), Some(Layout::Drive)).unwrap();
    let Detail::Drive { position } = reply.detail else {
        panic!("{reply:?}")
    };
    let (current, speed) = (reply.current.unwrap(), reply.speed.unwrap());
    (current.raw(), speed.rpm(), position.raw())
}

#[test]
fn captured_values_are_the_ones_their_capture_names() {
    assert_eq!(drive_reply("01 02 00 09 00 00 7B 6D 00 49"), (9, 0, 31_597));
    assert_eq!(
        drive_reply("01 02 02 CD 00 64 17 CF 00 8F"),
        (717, 100, 6_095)
    );
    assert_eq!(
        drive_reply("01 02 05 03 00 63 62 6C 00 57"),
        (1_283, 99, 25_196)
    );
    let query =
        Reply::decode(&frame("01 02 00 0A 00 00 20 F6 00 4A"), Some(Layout::Query)).unwrap();
    let detail = Detail::Query {
        temperature: Celsius::new(32),
        position: CoarsePosition::from_raw(246),
    };
    assert_eq!(query.detail, detail);
    assert!((Current::from_raw(717).amps() - 0.175).abs() < 0.0005);
    assert!((Position::from_raw(31_597).degrees() - 347.1).abs() < 0.05);
    assert!((CoarsePosition::from_raw(246).degrees() - 347.3).abs() < 0.05);
    // Two layouts of the same instant agree on the angle: 264.0 and 264.2 degrees.
    assert!((CoarsePosition::from_raw(187).degrees() - 264.0).abs() < 0.05);
    assert!((Position::from_raw(24_049).degrees() - 264.2).abs() < 0.05);
}

/// At +100 rpm the captured angle falls by 600 degrees a second.
#[test]
fn a_positive_speed_makes_the_angle_fall() {
    let (_, _, before) = drive_reply("01 02 02 CD 00 64 17 CF 00 8F");
    let (_, _, after) = drive_reply("01 02 02 00 00 64 0E 49 00 1B");
    let moved = Position::from_raw(after).degrees() - Position::from_raw(before).degrees();
    let seconds = 0.045; // 13:15:36.962 to 13:15:37.007
    let by_speed = Rpm::new(100).degrees_per_second() * seconds;
    assert!(moved < 0.0);
    assert!(
        (moved - by_speed).abs() < 0.05 * by_speed.abs(),
        "{moved} against {by_speed}"
    );
}

#[test]
fn frames_explain_themselves() {
    let sent = |text, mode| explain_sent(&frame(text), mode).to_string();
    let heard = |text, layout| explain_received(&frame(text), layout).to_string();
    let velocity = Some(Mode::Velocity);
    assert_eq!(
        sent("01 64 00 64 00 00 00 00 00 4F", velocity),
        "drive +100 rpm"
    );
    assert_eq!(
        sent("01 64 FF 9C 00 00 00 00 00 9A", velocity),
        "drive −100 rpm"
    );
    assert_eq!(
        sent("01 64 00 00 00 00 00 FF 00 D1", velocity),
        "drive, brake"
    );
    assert_eq!(
        sent("01 64 27 10 00 00 00 00 00 57", Some(Mode::Current)),
        "drive +2.441 A"
    );
    assert_eq!(
        sent("01 64 20 00 00 00 00 00 00 BF", Some(Mode::Position)),
        "drive to 90.00°"
    );
    assert_eq!(
        sent("01 64 20 00 00 00 00 00 00 BF", None),
        "drive, value 8192"
    );
    assert_eq!(
        sent("01 74 00 00 00 00 00 00 00 04", None),
        "feedback query"
    );
    assert_eq!(
        sent("01 A0 00 00 00 00 00 00 00 03", None),
        "switch to the position loop"
    );
    assert_eq!(
        sent("AA 55 53 01 00 00 00 00 00 00", None),
        "set ID 0x01 on all motors"
    );
    assert_eq!(
        sent("01 74 00 00 00 00 00 00 00 05", None),
        "CRC 05, expected 04"
    );
    assert_eq!(
        heard("01 02 02 CD 00 64 17 CF 00 8F", Some(Layout::Drive)),
        "+100 rpm, +0.175 A, 66.96°"
    );
    assert_eq!(
        heard("01 02 00 0A 00 00 20 F6 00 4A", Some(Layout::Query)),
        "+0 rpm, +0.002 A, 32 °C, 347.3°"
    );
    assert_eq!(
        heard("01 02 02 CD 00 64 17 CF 00 8F", None),
        "+100 rpm, +0.175 A"
    );
    assert_eq!(
        heard("01 02 05 8A 00 64 0E 49 00 1B", Some(Layout::Drive)),
        "CRC 1B, expected 8D"
    );
}

/// The bare zero frame to motor 0xC8 would be the ID query, which all motors answer.
#[test]
fn a_zero_drive_frame_to_motor_c8_is_not_the_id_query() {
    let id = MotorId::new(0xC8).unwrap();
    let request = Request::drive(id, Setpoint::velocity(SpeedTarget::ZERO));
    let sent = request.frame();
    assert_ne!(sent, Request::IdQuery.frame());
    let drive = Drive {
        value: [0, 0],
        acceleration: Acceleration::FASTEST,
        brake: 0,
    };
    assert_eq!(Request::parse(&sent), Ok(Request::Drive { id, drive }));
    assert!(AssignableId::new(id).is_err());
}
