//! Every model of the family: its figures as data, its frames as types.
//!
//! The types of the crate root are those of a DDSM115, which the bus and the page drive. The types here
//! have the same names and hold for every model; most functions take a [`Model`]. Setpoints are the same.
//!
//! | to | see |
//! |---|---|
//! | know what differs between models, and what is uncertain | [`Model::spec`], [`Model::uncertain`] |
//! | ask a motor | [`Request`], [`Request::frame`] |
//! | say what it is to do | [`Setpoint`](crate::Setpoint), in units that every model has; [`Request::drive`] |
//! | read what it answered | [`Reading::decode`] with the [`Layout`] of [`Request::reply_layout`] |
//! | play a motor | [`Request::parse`], [`Reading::frame`] |

mod current;
mod reading;
mod request;
mod speed;

pub use crate::{
    fault::Fault,
    faults::Faults,
    mode::Mode,
    model::{CurrentScale, FrameSet, Model, Nominal, Spec, UnknownModel, Wiring},
    target::OpenLoopTarget,
};
pub use current::Current;
pub use reading::{DriveReading, Layout, ModeReading, Odometry, Reading, ReadingError};
pub use request::{NotOfModel, Request, RequestError};
pub use speed::Speed;
