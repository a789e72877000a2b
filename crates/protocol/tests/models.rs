//! Golden vectors of every model, by its published frames.

use motorlink_protocol::{
    AssignableId, Celsius, Frame, MotorId, Position, ReplyError, Setpoint, SpeedTarget,
    family::{
        DriveReading, Faults, Layout, Mode, ModeReading, Model, NotOfModel, Odometry, Reading,
        ReadingError, Request, Speed,
    },
};

const ID: MotorId = MotorId::FIRST;
const SEPARATE: [Model; 2] = [Model::Ddsm210, Model::Ddsm400];

fn frame(text: &str) -> Frame {
    text.parse().unwrap()
}

fn drive(setpoint: Setpoint) -> Request {
    Request::drive(Model::Ddsm210, ID, setpoint)
}

fn speed(rpm: i32) -> Request {
    drive(Setpoint::velocity(SpeedTarget::new(rpm).unwrap()))
}

fn switch(mode: Mode) -> Request {
    Request::SwitchMode { id: ID, mode }
}

fn set_id(address: u8) -> Request {
    let id = AssignableId::new(MotorId::new(address).unwrap()).unwrap();
    Request::SetId { id }
}

/// The vendor's library and wikis, with the CRC recomputed.
#[test]
fn published_frames_of_ddsm210_and_ddsm400_are_written_and_read() {
    for (text, request) in [
        ("01 64 01 F4 00 00 00 00 00 C3", speed(50)),
        ("01 64 FE 0C 00 00 00 00 00 16", speed(-50)),
        ("01 64 03 E8 00 00 00 00 00 9F", speed(100)),
        ("01 64 FC 18 00 00 00 00 00 EB", speed(-100)),
        ("01 64 00 00 00 00 00 FF 00 D1", drive(Setpoint::Brake)),
        ("01 74 00 00 00 00 00 00 00 04", Request::Query { id: ID }),
        (
            "01 75 00 00 00 00 00 00 00 47",
            Request::ModeQuery { id: ID },
        ),
        ("01 A0 00 00 00 00 00 00 00 9E", switch(Mode::OpenLoop)),
        ("01 A0 02 00 00 00 00 00 00 E4", switch(Mode::Velocity)),
        ("01 A0 03 00 00 00 00 00 00 D9", switch(Mode::Position)),
        ("AA 55 53 01 00 00 00 00 00 CB", set_id(1)),
        ("AA 55 53 02 00 00 00 00 00 92", set_id(2)),
        ("C8 64 00 00 00 00 00 00 00 DE", Request::IdQuery),
    ] {
        for model in SEPARATE {
            assert_eq!(request.frame(model), Ok(frame(text)), "{model}");
            assert_eq!(
                Request::parse(model, &frame(text)),
                Ok(request),
                "{model} {text}"
            );
        }
    }
}

/// A DDSM400 alone has a current loop, and needs enabling.
#[test]
fn published_frames_of_a_ddsm400_are_written_and_read_and_others_refuse_them() {
    let enable = |on| Request::Enable { id: ID, on };
    for (text, request) in [
        ("01 A0 01 00 00 00 00 00 00 A3", switch(Mode::Current)),
        ("01 A0 08 00 00 00 00 00 00 6F", enable(true)),
        ("01 A0 09 00 00 00 00 00 00 52", enable(false)),
    ] {
        let (own, other) = (Model::Ddsm400, Model::Ddsm210);
        assert_eq!(request.frame(own), Ok(frame(text)));
        assert_eq!(Request::parse(own, &frame(text)), Ok(request));
        assert!(request.frame(other).is_err());
        assert!(Request::parse(other, &frame(text)).is_err(), "{text}");
    }
    let error = Request::parse(Model::Ddsm210, &frame("01 A0 08 00 00 00 00 00 00 6F"));
    assert_eq!(
        error.unwrap_err().to_string(),
        "mode byte is 08; a DDSM210 has 00 (open loop), 02 (velocity loop), 03 (position loop)"
    );
}

/// A wiki prints other last bytes for these; they are no CRC.
#[test]
fn misprinted_frames_are_no_requests() {
    for text in [
        "01 64 FC 18 00 00 00 00 00 E8",
        "01 A0 08 00 00 00 00 00 00 E4",
        "01 A0 09 00 00 00 00 00 00 E4",
        "01 75 00 00 00 00 00 00 00 48",
    ] {
        let error = Request::parse(Model::Ddsm400, &frame(text)).unwrap_err();
        assert!(error.to_string().starts_with("CRC "), "{text}: {error}");
    }
}

#[test]
fn a_value_in_a_byte_that_is_always_zero_is_named_by_its_place() {
    for (body, place) in [
        ([1, 0x75, 1, 0, 0, 0, 0, 0, 0], 2),
        ([1, 0x75, 0, 0, 0, 0, 0, 0, 1], 8),
        ([1, 0xA0, 2, 1, 0, 0, 0, 0, 0], 3),
        ([1, 0xA0, 2, 0, 0, 0, 0, 0, 1], 8),
        ([1, 0x74, 1, 0, 0, 0, 0, 0, 0], 2),
    ] {
        let error = Request::parse(Model::Ddsm400, &Frame::with_crc(body)).unwrap_err();
        assert_eq!(
            error.to_string(),
            format!("byte {place} must be 00 in this frame")
        );
    }
}

/// The maker's tester ends a set-ID frame with 00, the vendor's library with its CRC.
#[test]
fn both_published_ends_of_a_set_id_frame_are_read() {
    let zero = frame("AA 55 53 01 00 00 00 00 00 00");
    let crc = frame("AA 55 53 01 00 00 00 00 00 CB");
    for model in Model::ALL {
        assert_eq!(Request::parse(model, &zero), Ok(set_id(1)), "{model}");
        assert_eq!(Request::parse(model, &crc), Ok(set_id(1)), "{model}");
        let own = if model.has_separate_frames() {
            crc
        } else {
            zero
        };
        assert_eq!(set_id(1).frame(model), Ok(own), "{model}");
    }
}

/// The maker's samples: `01 A0 .. 03` without CRC, and the frames of the crate root.
#[test]
fn ddsm115_and_ddsm315_have_the_combined_frames() {
    for model in [Model::Ddsm115, Model::Ddsm315] {
        for (text, request) in [
            ("01 A0 00 00 00 00 00 00 00 03", switch(Mode::Position)),
            ("01 64 00 00 00 00 00 FF 00 D1", drive(Setpoint::Brake)),
            ("01 74 00 00 00 00 00 00 00 04", Request::Query { id: ID }),
            ("C8 64 00 00 00 00 00 00 00 DE", Request::IdQuery),
        ] {
            assert_eq!(request.frame(model), Ok(frame(text)), "{model}");
            assert_eq!(Request::parse(model, &frame(text)), Ok(request));
        }
        let rpm_100 = Setpoint::velocity(SpeedTarget::new(100).unwrap());
        let request = Request::drive(model, ID, rpm_100);
        let text = "01 64 00 64 00 00 00 00 00 4F";
        assert_eq!(request.frame(model), Ok(frame(text)));
        let name = "mode query";
        assert_eq!(
            Request::ModeQuery { id: ID }.frame(model),
            Err(NotOfModel::Request { model, name })
        );
        let mode = Mode::OpenLoop;
        assert_eq!(
            switch(mode).frame(model),
            Err(NotOfModel::Mode { model, mode })
        );
        let other = frame("01 75 00 00 00 00 00 00 00 47");
        assert!(Request::parse(model, &other).is_err());
    }
    // A captured reply of a DDSM115.
    let heard = frame("01 02 02 CD 00 64 17 CF 00 8F");
    let asked = Some(Layout::Drive);
    let reply = motorlink_protocol::Reply::decode(&heard, Some(motorlink_protocol::Layout::Drive));
    assert_eq!(
        Reading::decode(Model::Ddsm315, &heard, asked),
        Ok(Reading::Combined(reply.unwrap()))
    );
}

/// `ID 64 spdH spdL curH curL acc temp fault`, of a DDSM400 with `65` (the vendor's library, a client).
#[test]
fn a_drive_reply_has_speed_current_temperature_and_fault() {
    for (model, byte_1) in [(Model::Ddsm210, 0x64), (Model::Ddsm400, 0x65)] {
        let reading = DriveReading {
            id: ID,
            value: 500,
            current: model.current_of_raw(-2),
            acceleration: 3,
            temperature: Celsius::new(31),
            faults: Faults::of(model, 0x10),
        };
        let heard = Frame::with_crc([1, byte_1, 0x01, 0xF4, 0xFF, 0xFE, 3, 31, 0x10]);
        assert_eq!(
            Reading::decode(model, &heard, None),
            Ok(Reading::Drive(reading))
        );
        assert_eq!(Reading::Drive(reading).frame(model), heard);
        for mode in [Mode::OpenLoop, Mode::Current, Mode::Velocity] {
            let speed = reading.speed(model, mode).unwrap();
            assert_eq!(speed, Speed::from_tenths(500));
            assert_eq!(speed.to_string(), "+50 rpm");
        }
        // One source has the position in bytes 2-3 there.
        assert_eq!(reading.speed(model, Mode::Position), None);
    }
}

/// `ID 74 turns(i32) posH posL fault`, of a DDSM400 with `75`.
#[test]
fn an_odometry_reply_has_turns_position_and_fault() {
    for (model, byte_1) in [(Model::Ddsm210, 0x74), (Model::Ddsm400, 0x75)] {
        let heard = Frame::with_crc([1, byte_1, 0xFF, 0xFF, 0xFF, 0xFE, 0x40, 0, 2]);
        let odometry = Reading::Odometry(Odometry {
            id: ID,
            turns: -2,
            position: Position::from_raw(0x4000),
            faults: Faults::of(model, 2),
        });
        assert_eq!(Reading::decode(model, &heard, None), Ok(odometry));
        assert_eq!(odometry.frame(model), heard);
    }
}

/// `ID 75 mode` and `ID A0 mode` of a DDSM210; `ID 76 mode` and `ID A1 mode` of a DDSM400.
#[test]
fn mode_replies_tell_the_loop_and_whether_they_answer_a_switch() {
    for (model, byte_1, byte, switched) in [
        (Model::Ddsm210, 0x75, 2, false),
        (Model::Ddsm210, 0xA0, 0, true),
        (Model::Ddsm400, 0x76, 2, false),
        (Model::Ddsm400, 0xA1, 8, true),
    ] {
        let heard = Frame::with_crc([1, byte_1, byte, 0, 0, 0, 0, 0, 0]);
        let id = ID;
        let reading = ModeReading { id, byte, switched };
        let decoded = Reading::decode(model, &heard, None);
        assert_eq!(decoded, Ok(Reading::Mode(reading)));
        assert_eq!(Reading::Mode(reading).frame(model), heard);
        let named = (byte < 4).then_some(byte);
        assert_eq!(reading.mode(model).map(Mode::byte), named);
        let names_loop = Reading::Mode(reading).names_loop(model);
        assert_eq!(names_loop.map(Mode::byte), named);
    }
}

/// Byte 1 of the answer to the ID query tells the family.
#[test]
fn a_reply_of_one_family_is_no_reply_of_another() {
    let ddsm210 = Frame::with_crc([1, 0x64, 0, 0, 0, 0, 0, 30, 0]);
    let ddsm115 = frame("01 02 02 CD 00 64 17 CF 00 8F");
    for (model, frame, byte) in [
        (Model::Ddsm400, ddsm210, 0x64),
        (Model::Ddsm210, ddsm115, 0x02),
        (Model::Ddsm400, ddsm115, 0x02),
    ] {
        let error = Reading::decode(model, &frame, None).unwrap_err();
        assert_eq!(error, ReadingError::NoReply { model, byte });
        let text = format!("byte 1 is {byte:02X}, which begins no reply of a {model}");
        assert_eq!(error.to_string(), text);
    }
    assert!(Reading::decode(Model::Ddsm115, &ddsm210, None).is_err());
    let wrong_crc = frame("01 64 00 00 00 00 00 1E 00 00");
    assert!(matches!(
        Reading::decode(Model::Ddsm210, &wrong_crc, None),
        Err(ReadingError::Frame(ReplyError::BadCrc { found: 0, .. }))
    ));
    let nobody = Frame::with_crc([0, 0x64, 0, 0, 0, 0, 0, 30, 0]);
    assert!(matches!(
        Reading::decode(Model::Ddsm210, &nobody, None),
        Err(ReadingError::Frame(ReplyError::BadId(_)))
    ));
}

/// The echo of a drive frame is a valid drive reply of a DDSM210, and no reply of a DDSM400.
#[test]
fn an_echo_looks_like_a_reply_where_the_model_says_so() {
    for model in Model::ALL {
        let looks = Reading::decode(model, &speed(50).frame(model).unwrap(), None).is_ok();
        assert_eq!(model.replies_look_like_requests(), looks, "{model}");
        assert_eq!(looks, model == Model::Ddsm210);
    }
}

#[test]
fn requests_say_whom_they_address_and_what_answers() {
    let (query, mode_query) = (Request::Query { id: ID }, Request::ModeQuery { id: ID });
    let enable = Request::Enable { id: ID, on: true };
    let loops = switch(Mode::Velocity);
    for (request, addressee, of_115, of_210) in [
        (speed(1), Some(ID), Some(Layout::Drive), Some(Layout::Drive)),
        (query, Some(ID), Some(Layout::Query), Some(Layout::Query)),
        (mode_query, Some(ID), Some(Layout::Mode), Some(Layout::Mode)),
        (loops, Some(ID), None, Some(Layout::Switch)),
        (enable, Some(ID), None, Some(Layout::Switch)),
        (
            Request::IdQuery,
            None,
            Some(Layout::Drive),
            Some(Layout::Drive),
        ),
        (set_id(3), None, None, None),
    ] {
        assert_eq!(request.addressee(), addressee);
        assert_eq!(request.reply_layout(Model::Ddsm115), of_115);
        assert_eq!(request.reply_layout(Model::Ddsm210), of_210);
    }
}
