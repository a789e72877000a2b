//! What a raw frame may do, judged by its bytes.

use motorlink_protocol::{AssignableId, Frame, MotorId, Request};

/// Whether a raw frame may move a wheel or change an ID: all except feedback queries and the ID
/// query. A motor may understand what this crate cannot read.
#[must_use]
pub fn is_hazardous(frame: &Frame) -> bool {
    !matches!(
        Request::parse(frame),
        Ok(Request::Query { .. } | Request::IdQuery)
    )
}

/// The ID of a set-ID frame, if no motor may have it. No scan queries 0x00 and 0xFF, so the motor
/// would never be found again; 0xC8 starts the ID query. Such a frame is never sent.
#[must_use]
pub fn unassignable_id(frame: &Frame) -> Option<u8> {
    let &[0xAA, 0x55, 0x53, new, ..] = frame.bytes() else {
        return None;
    };
    let assignable = MotorId::new(new).is_ok_and(|id| AssignableId::new(id).is_ok());
    (!assignable).then_some(new)
}
