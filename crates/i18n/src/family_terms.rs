//! The explanation of a frame of any model, in the current language.

use motorlink_protocol::{
    Drive, Frame, Layout, Mode, OpenLoopTarget, Position,
    family::{
        DriveReading, ModeReading, Model, Odometry, Reading, ReadingError, Request, RequestError,
    },
};

use crate::{
    terms::{self, in_language},
    tr,
};

/// What a frame asks of motors of this model. `mode` is the loop in which the motor reads a drive value, if known.
#[must_use]
pub fn sent(model: Model, frame: &Frame, mode: Option<Mode>) -> String {
    let request = Request::parse(model, frame).or_else(|error| {
        let id = motorlink_protocol::Request::set_id_of(frame).ok_or(error)?;
        Ok(Request::SetId { id })
    });
    match request {
        Ok(Request::Drive { drive, .. }) => driven(model, drive, mode),
        Ok(Request::Query { .. }) if model.has_separate_frames() => {
            tr!("odometry query").to_owned()
        }
        Ok(Request::Query { .. }) => tr!("feedback query").to_owned(),
        Ok(Request::ModeQuery { .. }) => tr!("mode query").to_owned(),
        Ok(Request::SwitchMode { mode, .. }) => {
            tr!("switch to the {mode}", mode = terms::mode(mode))
        }
        Ok(Request::Enable { on: true, .. }) => tr!("enable").to_owned(),
        Ok(Request::Enable { on: false, .. }) => tr!("disable").to_owned(),
        Ok(Request::IdQuery) => tr!("ID query to all motors").to_owned(),
        Ok(Request::SetId { id }) => tr!("set ID {id} on all motors", id = id.id()),
        Err(RequestError::Frame(error)) => terms::no_request(error),
        Err(RequestError::Mode { model, byte }) => {
            tr!("a {model} has no mode {byte}", model, byte)
        }
    }
}

fn driven(model: Model, drive: Drive, mode: Option<Mode>) -> String {
    let value = drive.signed();
    let units = drive.acceleration.byte();
    let accelerated = |driven: String| {
        if units == 0 {
            driven
        } else {
            tr!("{driven}, accel {units}", driven, units)
        }
    };
    let goal = match mode {
        None => return accelerated(tr!("drive, value {value}", value)),
        Some(Mode::Velocity) => {
            return accelerated(if drive.brakes() {
                tr!("drive, brake").to_owned()
            } else {
                tr!("drive {goal}", goal = speed(model, value))
            });
        }
        Some(Mode::OpenLoop) => OpenLoopTarget::nearest(value).to_string(),
        Some(Mode::Current) => model.current_of_raw(value).to_string(),
        Some(Mode::Position) => {
            let goal = in_language(Position::from_raw(drive.unsigned()).to_string());
            return tr!("drive to {goal}", goal);
        }
    };
    tr!("drive {goal}", goal = in_language(goal))
}

/// `+50.1 rpm`, in the unit of the language.
fn speed(model: Model, value: i16) -> String {
    let speed = model.speed_of_raw(value).to_string();
    in_language(speed.replace("rpm", terms::rpm()))
}

/// What a motor of this model has answered. `asked` is the layout of a combined reply, if it is certain.
#[must_use]
pub fn received(model: Model, frame: &Frame, asked: Option<Layout>) -> String {
    let (said, faults) = match Reading::decode(model, frame, asked.map(Into::into)) {
        Ok(Reading::Combined(reply)) => return terms::received(&reply),
        Ok(Reading::Drive(reading)) => (drive_reply(model, reading), reading.faults),
        Ok(Reading::Odometry(odometry)) => (odometry_reply(odometry), odometry.faults),
        Ok(Reading::Mode(reading)) => return mode_reply(model, reading),
        Err(ReadingError::Frame(error)) => return terms::no_reply(error),
        Err(ReadingError::NoReply { model, byte }) => {
            return tr!(
                "byte 1 is {byte}: no reply of a {model}",
                byte = format!("{byte:02X}"),
                model
            );
        }
    };
    if faults.is_none() {
        return said;
    }
    tr!(
        "{said}, fault: {faults}",
        said,
        faults = terms::faults(faults)
    )
}

fn drive_reply(model: Model, reading: DriveReading) -> String {
    let speed = speed(model, reading.value);
    let rest = in_language(format!("{}, {}", reading.current, reading.temperature));
    format!("{speed}, {rest}")
}

fn odometry_reply(odometry: Odometry) -> String {
    tr!(
        "{turns} turns, {position}",
        turns = odometry.turns,
        position = in_language(odometry.position.to_string())
    )
}

fn mode_reply(model: Model, reading: ModeReading) -> String {
    match (reading.mode(model), reading.byte) {
        (Some(mode), _) => terms::mode(mode).to_owned(),
        (None, ModeReading::ENABLED) => tr!("enabled").to_owned(),
        (None, ModeReading::DISABLED) => tr!("disabled").to_owned(),
        (None, byte) => tr!("a {model} has no mode {byte}", model, byte),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(text: &str) -> Frame {
        text.parse().unwrap()
    }

    /// The vectors of the vendor's library and of clients; a wiki prints other check bytes for some.
    #[test]
    fn requests_of_a_ddsm210_are_said_in_its_units() {
        for (bytes, mode, words) in [
            (
                "01 64 01 F4 00 00 00 00 00 C3",
                Some(Mode::Velocity),
                "drive +50 rpm",
            ),
            ("01 64 01 F4 00 00 00 00 00 C3", None, "drive, value 500"),
            (
                "01 64 FE 0B 00 00 0A 00 00 F9",
                Some(Mode::Velocity),
                "drive \u{2212}50.1 rpm, accel 10",
            ),
            (
                "01 64 00 00 00 00 00 FF 00 D1",
                Some(Mode::Velocity),
                "drive, brake",
            ),
            ("01 74 00 00 00 00 00 00 00 04", None, "odometry query"),
            ("01 75 00 00 00 00 00 00 00 47", None, "mode query"),
            (
                "01 A0 00 00 00 00 00 00 00 9E",
                None,
                "switch to the open loop",
            ),
            (
                "01 A0 01 00 00 00 00 00 00 A3",
                None,
                "a DDSM210 has no mode 1",
            ),
            ("01 A0 02 00 00 00 00 00 00 E3", None, "CRC E3, expected E4"),
        ] {
            assert_eq!(sent(Model::Ddsm210, &frame(bytes), mode), words, "{bytes}");
        }
        let enable = frame("01 A0 08 00 00 00 00 00 00 6F");
        assert_eq!(sent(Model::Ddsm400, &enable, None), "enable");
    }

    #[test]
    fn replies_are_told_apart_by_byte_1() {
        let with_crc = |body| Frame::with_crc(body);
        let drive = [1, 0x64, 0x01, 0xF4, 0, 100, 0, 30, 2];
        let words = received(Model::Ddsm210, &with_crc(drive), None);
        assert_eq!(words, "+50 rpm, raw +100, 30 °C, fault: overcurrent");
        let drive = [1, 0x65, 0x01, 0xF4, 0x20, 0, 0, 30, 0];
        let words = received(Model::Ddsm400, &with_crc(drive), None);
        assert_eq!(words, "+50 rpm, +1.000 A, 30 °C");
        let odometry = [1, 0x74, 0, 0, 0, 3, 0x20, 0, 0];
        let words = received(Model::Ddsm210, &with_crc(odometry), None);
        assert_eq!(words, "3 turns, 90.00°");
        let mode = [1, 0xA1, 8, 0, 0, 0, 0, 0, 0];
        assert_eq!(received(Model::Ddsm400, &with_crc(mode), None), "enabled");
        let other = received(
            Model::Ddsm400,
            &with_crc([1, 0x64, 0, 0, 0, 0, 0, 0, 0]),
            None,
        );
        assert_eq!(other, "byte 1 is 64: no reply of a DDSM400");
    }

    #[test]
    fn combined_frames_are_explained_as_before() {
        let switch = frame("01 A0 00 00 00 00 00 00 00 02");
        assert_eq!(
            sent(Model::Ddsm315, &switch, None),
            "switch to the velocity loop"
        );
    }
}
