//! Parses requests like the motor's controller.

use motorlink_protocol::{
    Frame, Request, RequestError,
    family::{self, Model},
};

/// Reads a frame as the controller does: the values of reserved bytes do not matter to it.
///
/// The article's `m0601_operations.py` sends its acceleration in byte 4 of a drive frame, which is
/// reserved, and the motor is driven by it. Set-ID frames are matched whole, as the maker prints them:
/// nothing is published of others, and they change the flash of every motor.
pub(crate) fn parse_request(frame: &Frame) -> Result<Request, RequestError> {
    let parsed = Request::parse(frame);
    // The parser has found the CRC right where the frame has one.
    let Err(RequestError::NotZero { .. }) = parsed else {
        return parsed;
    };
    let &[id, command, b2, b3, _, _, b6, b7, _, last] = frame.bytes();
    match command {
        0x64 => Request::parse(&Frame::with_crc([id, command, b2, b3, 0, 0, b6, b7, 0])),
        0x74 => Request::parse(&Frame::with_crc([id, command, 0, 0, 0, 0, 0, 0, 0])),
        0xA0 => Request::parse(&Frame::new([id, command, 0, 0, 0, 0, 0, 0, 0, last])),
        _ => parsed,
    }
}

/// The same of a model with separate frames. That reserved bytes do not matter to it is **assumed**.
pub(crate) fn parse_separate(
    model: Model,
    frame: &Frame,
) -> Result<family::Request, family::RequestError> {
    let parsed = family::Request::parse(model, frame);
    // The parser has found the CRC right.
    let Err(family::RequestError::Frame(RequestError::NotZero { .. })) = parsed else {
        return parsed;
    };
    let &[id, command, b2, b3, _, _, b6, b7, _, _] = frame.bytes();
    let plain = match command {
        0x64 => [id, command, b2, b3, 0, 0, b6, b7, 0],
        0x74 | 0x75 => [id, command, 0, 0, 0, 0, 0, 0, 0],
        0xA0 => [id, command, b2, 0, 0, 0, 0, 0, 0],
        _ => return parsed,
    };
    family::Request::parse(model, &Frame::with_crc(plain))
}
