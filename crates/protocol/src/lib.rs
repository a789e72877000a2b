//! The RS485 frames of the DFRobot M0601 and Waveshare DDSM115 hub motors, as types.
//!
//! Both motors are one design: a direct-drive hub motor that closes velocity, current and position
//! loops itself and speaks fixed frames of ten bytes at 115200 baud 8N1, half duplex, multi-drop.
//! This crate turns requests into frames, and frames into replies, and does nothing else: no port,
//! no clock, no allocation, no `std`. When to send what is the business of `motorlink-bus`.
//!
//! # What a host sends
//!
//! | request | bytes 0-9 | answered in |
//! |---|---|---|
//! | [`Request::Drive`] | `ID 64 hi lo 00 00 accel brake 00 CRC` | [`Layout::Drive`] |
//! | [`Request::Query`] | `ID 74 00 00 00 00 00 00 00 CRC` | [`Layout::Query`] |
//! | [`Request::SwitchMode`] | `ID A0 00 00 00 00 00 00 00 mode`, no CRC | nothing |
//! | [`Request::IdQuery`] | `C8 64 00 00 00 00 00 00 00 DE` | [`Layout::Drive`], by every motor at once |
//! | [`Request::SetId`] | `AA 55 53 id 00 00 00 00 00 00`, no CRC | nothing |
//!
//! # What a motor answers
//!
//! Two layouts differ in bytes 6 and 7 and carry no mark that tells them apart, so a reply can only
//! be read by one who knows what was asked: see [`Reply::decode`].
//!
//! # Example
//!
//! ```
//! use motorlink_protocol::{Layout, MotorId, Reply, Request, Setpoint, SpeedTarget};
//!
//! let motor = MotorId::new(1)?;
//! let request = Request::drive(motor, Setpoint::velocity(SpeedTarget::new(100)?));
//! assert_eq!(request.frame().to_string(), "01 64 00 64 00 00 00 00 00 4F");
//!
//! let heard = "01 02 02 CD 00 64 17 CF 00 8F".parse()?;
//! let reply = Reply::decode(&heard, Some(Layout::Drive))?;
//! assert_eq!(reply.speed.rpm(), 100);
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
//!
//! Facts without another source come from frames captured on real motors (`tests/captures/`) and
//! the maker's manual.
#![no_std]

mod clock;
mod crc8;
mod explain;
mod faults;
mod frame;
mod measured;
mod mode;
mod motor_id;
mod reply;
mod request;
mod setpoint;
mod target;

pub use clock::Instant;
pub use crc8::crc8;
pub use explain::{Explained, explain_heard, explain_sent};
pub use faults::{Fault, Faults};
pub use frame::{FRAME_AIRTIME, FRAME_LEN, Frame, FrameParseError};
pub use measured::{Celsius, CoarsePosition, Current, Position, Rpm, Scaled};
pub use mode::{Mode, UnknownMode};
pub use motor_id::{AssignableId, MotorId, MotorIdError, NotAssignable};
pub use reply::{Detail, Layout, Reply, ReplyError};
pub use request::{Request, RequestError};
pub use setpoint::{Drive, Setpoint};
pub use target::{Acceleration, CurrentTarget, OutOfRange, PositionTarget, SpeedTarget};
