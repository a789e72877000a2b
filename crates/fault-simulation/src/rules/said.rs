//! What a frame says, and to whom.

use motorlink_protocol::{
    Detail, Frame, Mode, MotorId, Reply,
    family::{Model, Reading},
};

/// Most difference of a speed in rpm from tenths of it.
const ROUNDED_RPM: i32 = 1;

/// Whether a motor may obey a frame, by its first byte. 0xC8 addresses all.
pub(super) fn may_obey(frame: &Frame, id: MotorId) -> bool {
    let [first, ..] = *frame.bytes();
    first == id.get() || first == 0xC8
}

/// Whether this is the frame, or the last frame, from which the bus has made a reply.
pub(super) fn tells(model: Model, frame: &Frame, reply: &Reply) -> bool {
    if !model.has_separate_frames() {
        return *frame == reply.frame();
    }
    match (Reading::decode(model, frame, None), reply.detail) {
        (Ok(Reading::Drive(said)), Detail::Temperature(temperature)) => {
            let is_its = match (said.speed(model, reply.mode), reply.speed) {
                (Some(said), Some(told)) => {
                    (said.tenths() / 10 - i32::from(told.rpm())).abs() <= ROUNDED_RPM
                }
                (said, told) => said.is_none() && told.is_none(),
            };
            said.id == reply.id
                && said.temperature == temperature
                && said.faults.byte() == reply.faults.byte()
                && is_its
        }
        (Ok(Reading::Odometry(said)), Detail::Odometry { turns, position }) => {
            said.id == reply.id
                && said.turns == turns
                && said.position == position
                && said.faults.byte() == reply.faults.byte()
        }
        _ => false,
    }
}

/// The motor of this frame, and the loop that it reports, if the frame has one.
pub(super) fn loop_of(model: Model, frame: &Frame) -> Option<(MotorId, Option<Mode>)> {
    match Reading::decode(model, frame, None).ok()? {
        Reading::Combined(reply) => Some((reply.id, Some(reply.mode))),
        Reading::Drive(reading) => Some((reading.id, None)),
        Reading::Odometry(reading) => Some((reading.id, None)),
        Reading::Mode(reading) => Some((reading.id, reading.mode(model))),
    }
}
