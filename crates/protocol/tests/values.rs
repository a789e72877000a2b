//! Addresses, targets and reported values: their ranges, their conversions and their texts.

use motorlink_protocol::{
    Acceleration, AssignableId, Celsius, CoarsePosition, Current, CurrentTarget, Detail, Drive,
    Mode, MotorId, MotorIdError, Position, PositionTarget, Rpm, Setpoint, SpeedTarget,
    family::OpenLoopTarget,
};

#[test]
fn an_address_is_written_in_hex_and_comes_back_as_its_number() {
    let id = MotorId::new(200).unwrap();
    assert_eq!((id.get(), u8::from(id)), (200, 200));
    assert_eq!(MotorId::try_from(200), Ok(id));
    assert_eq!(id.to_string(), "0xC8");
    assert_eq!(format!("{:?}", MotorId::FIRST), "motor 0x01");
    let first = AssignableId::new(MotorId::FIRST).unwrap();
    assert_eq!(MotorId::from(first), MotorId::FIRST);
}

#[test]
fn a_refused_address_says_which_ones_are_valid() {
    let text = |address| MotorId::new(address).unwrap_err().to_string();
    assert_eq!(text(0), "0 is not a valid ID: use 1 to 254");
    assert_eq!(text(255), MotorIdError::TooLarge.to_string());
    assert_eq!(
        text(255),
        "not a valid ID: use a whole number from 1 to 254"
    );
    let reserved = AssignableId::try_from(MotorId::new(200).unwrap());
    assert_eq!(
        reserved.unwrap_err().to_string(),
        "200 (0xC8) is reserved for the ID query: use another ID"
    );
}

/// A drive reply tells the angle finely, a query reply coarsely.
#[test]
fn an_angle_is_as_fine_as_its_reply() {
    let position = Position::from_raw(8_192);
    let drive = Detail::Drive { position };
    assert_eq!(drive.fine(), Some(position));
    let query = Detail::Query {
        temperature: Celsius::new(20),
        position: CoarsePosition::from_raw(64),
    };
    assert_eq!(query.fine(), None);
    let degrees = |detail: Detail| detail.angle().unwrap().degrees();
    assert!((degrees(drive) - 90.0).abs() < 0.01);
    assert!((degrees(query) - 90.35).abs() < 0.01);
}

/// It turns the other way at the same setpoint; its angle and its brake are as before.
#[test]
fn the_setpoint_of_a_mirrored_motor_has_the_opposite_sign() {
    let speed = |rpm| Setpoint::Velocity {
        speed: SpeedTarget::clamped(rpm),
        acceleration: Acceleration::new(5),
    };
    let current = |raw| Setpoint::Current(CurrentTarget::new(raw).unwrap());
    let open = |raw| Setpoint::OpenLoop(OpenLoopTarget::new(raw).unwrap());
    let position = Setpoint::Position(PositionTarget::new(100).unwrap());
    assert_eq!(speed(100).reversed(), speed(-100));
    assert_eq!(current(-7).reversed(), current(7));
    assert_eq!(open(7).reversed(), open(-7));
    for same in [position, Setpoint::Brake] {
        assert_eq!(same.reversed(), same);
    }
}

#[test]
fn the_brake_byte_brakes_in_the_velocity_loop_at_speed_zero_only() {
    let read = |rpm: i16, brake, mode| {
        let drive = Drive {
            value: rpm.to_be_bytes(),
            acceleration: Acceleration::DEFAULT,
            brake,
        };
        drive.setpoint(mode)
    };
    let speed = |rpm| Setpoint::velocity(SpeedTarget::clamped(rpm));
    assert_eq!(read(0, Drive::BRAKE, Mode::Velocity), Setpoint::Brake);
    assert_eq!(read(0, 0, Mode::Velocity), speed(0));
    assert_eq!(read(7, Drive::BRAKE, Mode::Velocity), speed(7));
    let current = Setpoint::Current(CurrentTarget::ZERO);
    assert_eq!(read(0, Drive::BRAKE, Mode::Current), current);
}

/// Full scale is 8 A, so 0.25 A is 1023.97.
#[test]
fn amps_become_the_nearest_raw_current() {
    for (amps, raw) in [
        (0.0, 0),
        (0.25, 1_024),
        (-0.25, -1_024),
        (0.000_1, 0),
        (-0.000_1, 0),
        (8.0, 32_767),
        (-8.0, -32_767),
        (9.0, i16::MAX),
        (f32::NAN, 0),
    ] {
        assert_eq!(Current::from_amps(amps).raw(), raw, "{amps}");
        assert_eq!(CurrentTarget::from_amps(amps).raw(), raw, "{amps}");
    }
    assert_eq!(Current::from_amps(-9.0).raw(), i16::MIN);
    assert_eq!(CurrentTarget::from_amps(-9.0).raw(), -i16::MAX);
    assert!((CurrentTarget::new(-1_024).unwrap().amps() + 0.25).abs() < 0.000_1);
}

#[test]
fn an_angle_outside_a_turn_becomes_the_nearer_end() {
    let raw = |degrees| PositionTarget::from_degrees(degrees).raw();
    assert_eq!((raw(90.0), raw(360.0)), (8_192, 32_767));
    assert_eq!((raw(-1.0), raw(361.0)), (0, 32_767));
    let target = |raw| PositionTarget::from(Position::from_raw(raw)).raw();
    assert_eq!((target(8_192), target(32_768)), (8_192, 32_767));
}

#[test]
fn a_target_takes_its_range_and_a_refusal_names_it() {
    assert!(SpeedTarget::try_from(380).is_ok() && SpeedTarget::try_from(-380).is_ok());
    assert!(CurrentTarget::try_from(32_767).is_ok() && CurrentTarget::try_from(-32_767).is_ok());
    assert!(PositionTarget::try_from(32_767).is_ok() && PositionTarget::try_from(0).is_ok());
    assert!(SpeedTarget::try_from(381).is_err());
    assert!(CurrentTarget::try_from(-32_768).is_err());
    assert!(CurrentTarget::try_from(32_768).is_err());
    assert_eq!(
        SpeedTarget::try_from(-381).unwrap_err().to_string(),
        "speed in rpm must be -380 to 380, not -381"
    );
    assert_eq!(
        PositionTarget::try_from(-1).unwrap_err().to_string(),
        "raw position must be 0 to 32767, not -1"
    );
}

#[test]
fn a_target_comes_back_as_its_number() {
    assert_eq!(i32::from(SpeedTarget::new(-7).unwrap()), -7);
    assert_eq!(i32::from(CurrentTarget::new(-7).unwrap()), -7);
    assert_eq!(i32::from(PositionTarget::new(7).unwrap()), 7);
    assert_eq!(Acceleration::new(7).byte(), 7);
}

#[test]
fn setpoints_are_written_with_sign_and_unit() {
    let current = CurrentTarget::new(-2_000).unwrap();
    let position = PositionTarget::new(8_192).unwrap();
    for (setpoint, text) in [
        (Setpoint::velocity(SpeedTarget::clamped(100)), "+100 rpm"),
        (Setpoint::Brake, "brake"),
        (Setpoint::Current(current), "−0.488 A"),
        (Setpoint::Position(position), "90.00°"),
    ] {
        assert_eq!(setpoint.to_string(), text);
    }
}

#[test]
fn reported_values_are_written_with_their_unit() {
    assert_eq!(Rpm::new(-100).to_string(), "−100 rpm");
    assert_eq!(format!("{:?}", Rpm::new(100)), "+100 rpm");
    assert_eq!(format!("{:?}", Current::from_raw(717)), "+0.175 A");
    assert_eq!(format!("{:?}", Position::from_raw(6_095)), "66.96°");
    assert_eq!(format!("{:?}", CoarsePosition::from_raw(246)), "347.3°");
    assert_eq!(format!("{:?}", Celsius::new(32)), "32 °C");
    assert_eq!(Rpm::new(i16::MIN).magnitude(), 32_768);
}
