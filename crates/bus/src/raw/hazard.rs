//! What a raw frame may do, judged by its bytes.

use motorlink_protocol::{AssignableId, Frame, MotorId, Request};

/// Whether a frame that a person wrote may move a wheel or change an ID: all but feedback queries and
/// the ID query. What this crate cannot read, a motor perhaps can.
#[must_use]
pub fn is_hazardous(frame: &Frame) -> bool {
    !matches!(
        Request::parse(frame),
        Ok(Request::Query { .. } | Request::IdQuery)
    )
}

/// The ID that a set-ID frame would give to a motor, where no motor may have it: no scan asks for 0x00
/// and 0xFF, so the motor would never be found again, and 0xC8 starts the ID query that all motors hear.
/// Such a frame is never sent.
#[must_use]
pub fn unassignable_id(frame: &Frame) -> Option<u8> {
    let &[0xAA, 0x55, 0x53, new, ..] = frame.bytes() else {
        return None;
    };
    let assignable = MotorId::new(new).is_ok_and(|id| AssignableId::new(id).is_ok());
    (!assignable).then_some(new)
}
