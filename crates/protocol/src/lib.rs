#![doc = include_str!("../README.md")]
//!
//! # Where to begin
//!
//! | to | see |
//! |---|---|
//! | ask a motor | [`Request`], [`Request::frame`] |
//! | say what it is to do | [`Setpoint`], of [`SpeedTarget`], [`CurrentTarget`], [`PositionTarget`], [`Acceleration`] |
//! | read what it answered | [`Reply::decode`] with the [`Layout`] of [`Request::reply_layout`] |
//! | know what is wrong | [`Faults`], [`ReplyError`] |
//! | show any frame in words | [`explain_sent`], [`explain_received`] |
//! | play a motor | [`Request::parse`], [`Reply::frame`] |
//! | speak to another model | [`family`] |
#![no_std]

mod clock;
mod crc8;
mod explain;
pub mod family;
mod fault;
mod faults;
mod frame;
mod measured;
mod mode;
mod model;
mod motor_id;
mod reply;
mod request;
mod setpoint;
mod target;

pub use clock::Instant;
pub use crc8::crc8;
pub use explain::{Explained, explain_received, explain_sent};
pub use fault::Fault;
pub use faults::Faults;
pub use frame::{FRAME_AIRTIME, FRAME_LEN, Frame, FrameParseError};
pub use measured::{Angle, Celsius, CoarsePosition, Current, Position, Rpm, Scaled};
pub use mode::{Mode, UnknownMode};
pub use motor_id::{AssignableId, MotorId, MotorIdError, NotAssignable};
pub use reply::{Detail, Layout, Reply, ReplyError};
pub use request::{Request, RequestError};
pub use setpoint::{Drive, Setpoint};
pub use target::{
    Acceleration, CurrentTarget, OpenLoopTarget, OutOfRange, PositionTarget, SpeedTarget,
};
