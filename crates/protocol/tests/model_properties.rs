//! What holds for any bytes and any request of every model.

use motorlink_protocol::{
    Acceleration, AssignableId, Celsius, Drive, Frame, MotorId, Position, Setpoint, SpeedTarget,
    family::{DriveReading, Faults, Layout, ModeReading, Model, Odometry, Reading, Request},
};
use proptest::prelude::*;

fn model() -> impl Strategy<Value = Model> {
    prop::sample::select(&Model::ALL[..])
}

fn motor_id() -> impl Strategy<Value = MotorId> {
    (1..=254_u8).prop_map(|address| MotorId::new(address).unwrap())
}

fn layout() -> impl Strategy<Value = Option<Layout>> {
    let layouts = [Layout::Drive, Layout::Query, Layout::Mode, Layout::Switch];
    prop::option::of(prop::sample::select(layouts.to_vec()))
}

/// Any request that a model has.
fn request() -> impl Strategy<Value = (Model, Request)> {
    let drive = (any::<[u8; 2]>(), any::<u8>(), any::<u8>());
    (model(), motor_id(), drive, 0..7_u8, any::<u8>()).prop_filter_map(
        "a request of the model",
        |(model, id, (value, acceleration, brake), kind, choice)| {
            let acceleration = Acceleration::new(acceleration);
            let modes = model.modes();
            let mode = modes[usize::from(choice) % modes.len()];
            let drive = Drive {
                value,
                acceleration,
                brake,
            };
            let request = match kind {
                0 => Request::Drive { id, drive },
                1 => Request::Query { id },
                2 => Request::SwitchMode { id, mode },
                3 => Request::IdQuery,
                4 => Request::SetId {
                    id: AssignableId::new(id).ok()?,
                },
                5 if model.has_separate_frames() => Request::ModeQuery { id },
                6 if model.spec().needs_enable => Request::Enable {
                    id,
                    on: choice < 128,
                },
                _ => return None,
            };
            // One pair of requests shares its bytes; the drive frame gives way.
            let is_zero_to_c8 = matches!(request, Request::Drive { id, drive }
                if id.get() == 0xC8 && drive.value == [0, 0] && drive.brake == 0
                    && drive.acceleration == Acceleration::DEFAULT);
            (!is_zero_to_c8).then_some((model, request))
        },
    )
}

/// Any reading that a model with separate frames sends; combined frames have their own tests.
fn reading() -> impl Strategy<Value = (Model, Reading)> {
    let body = (any::<i32>(), any::<i16>(), any::<[u8; 3]>(), 0..3_u8);
    let model = prop::sample::select(vec![Model::Ddsm210, Model::Ddsm400]);
    (model, motor_id(), body).prop_map(|(model, id, (turns, value, [one, two, byte], kind))| {
        let faults = Faults::of(model, byte);
        let reading = match kind {
            0 => Reading::Drive(DriveReading {
                id,
                value,
                current: model.current_of_raw(value.wrapping_mul(3)),
                acceleration: one,
                temperature: Celsius::new(two),
                faults,
            }),
            1 => Reading::Odometry(Odometry {
                id,
                turns,
                position: Position::from_raw(u16::from_be_bytes([one, two])),
                faults,
            }),
            _ => Reading::Mode(ModeReading {
                id,
                byte,
                switched: one < 128,
            }),
        };
        (model, reading)
    })
}

proptest! {
    #[test]
    fn every_request_of_every_model_round_trips((model, request) in request()) {
        let frame = request.frame(model).unwrap();
        prop_assert_eq!(Request::parse(model, &frame), Ok(request));
    }

    #[test]
    fn every_reading_round_trips((model, reading) in reading()) {
        let frame = reading.frame(model);
        prop_assert_eq!(Reading::decode(model, &frame, None), Ok(reading));
        prop_assert_eq!(reading.id().get(), frame.bytes()[0]);
    }

    #[test]
    fn any_ten_bytes_are_a_reading_or_a_named_error_of_every_model(
        bytes: [u8; 10], command: usize, good_crc: bool, model in model(), asked in layout()
    ) {
        let mut bytes = bytes;
        if good_crc {
            let commands = [1, 2, 3, 0x64, 0x65, 0x74, 0x75, 0x76, 0xA0, 0xA1];
            bytes[1] = commands[command % commands.len()];
            let [body @ .., _] = bytes;
            bytes = *Frame::with_crc(body).bytes();
        }
        let frame = Frame::new(bytes);
        match Reading::decode(model, &frame, asked) {
            Ok(reading) => {
                prop_assert!(frame.crc_expected() == bytes[9]);
                prop_assert_eq!(reading.id().get(), bytes[0]);
            }
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
        match Request::parse(model, &frame) {
            Ok(request) => prop_assert!(request.frame(model).is_ok()),
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }

    #[test]
    fn a_speed_on_the_wire_comes_back(rpm: i32, model in model()) {
        let target = SpeedTarget::clamped(rpm);
        let drive = Setpoint::velocity(target).drive(model);
        let read = model.speed_of_raw(drive.signed());
        prop_assert_eq!(read.tenths(), i32::from(target.rpm()) * 10);
    }
}
