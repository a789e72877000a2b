//! A frame in words.

use core::fmt;

use crate::{
    frame::Frame,
    measured::{Current, Position, Rpm},
    mode::Mode,
    reply::{Detail, Layout, Reply, ReplyError},
    request::{Request, RequestError},
    setpoint::Drive,
    target::OpenLoopTarget,
};

/// A frame in words: the request, the reply, or why it is neither.
///
/// Displays as `drive +100 rpm, accel 1`, as `+100 rpm, +0.175 A, 66.96°`, or as the error:
/// `CRC 5B, expected 1B`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Explained {
    /// A frame of the host.
    Sent {
        /// The request, or why the frame is not one.
        request: Result<Request, RequestError>,
        /// The loop in which to read the value of a drive frame.
        mode: Option<Mode>,
    },
    /// A frame of a motor, or why it is not a reply.
    Received(Result<Reply, ReplyError>),
}

/// Explains a frame of the host. The value of a drive frame is read in `mode`, the motor's loop;
/// without it the value stays a raw number.
#[must_use]
pub fn explain_sent(frame: &Frame, mode: Option<Mode>) -> Explained {
    Explained::Sent {
        request: Request::parse(frame).or_else(|error| set_id(frame).ok_or(error)),
        mode,
    }
}

/// A set-ID frame, also with the ending of another program.
fn set_id(frame: &Frame) -> Option<Request> {
    Request::set_id_of(frame).map(|id| Request::SetId { id })
}

/// Explains a frame of a motor in the layout that was asked for.
#[must_use]
pub fn explain_received(frame: &Frame, asked: Option<Layout>) -> Explained {
    Explained::Received(Reply::decode(frame, asked))
}

impl fmt::Display for Explained {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sent {
                request: Ok(request),
                mode,
            } => sent(f, request, *mode),
            Self::Sent {
                request: Err(error),
                ..
            } => error.fmt(f),
            Self::Received(Ok(reply)) => received(f, reply),
            Self::Received(Err(error)) => error.fmt(f),
        }
    }
}

fn sent(f: &mut fmt::Formatter<'_>, request: &Request, mode: Option<Mode>) -> fmt::Result {
    match request {
        Request::Drive { drive, .. } => driven(f, *drive, mode),
        Request::Query { .. } => f.write_str("feedback query"),
        Request::SwitchMode { mode, .. } => write!(f, "switch to the {mode}"),
        Request::IdQuery => f.write_str("ID query to all motors"),
        Request::SetId { id } => write!(f, "set ID {} on all motors", id.id()),
        Request::Raw(frame) => write!(f, "{frame}"),
    }
}

fn driven(f: &mut fmt::Formatter<'_>, drive: Drive, mode: Option<Mode>) -> fmt::Result {
    match mode {
        None => write!(f, "drive, value {}", drive.signed())?,
        Some(Mode::Velocity) if drive.brakes() => f.write_str("drive, brake")?,
        Some(Mode::Velocity) => write!(f, "drive {}", Rpm::new(drive.signed()))?,
        Some(Mode::OpenLoop) => write!(f, "drive {}", OpenLoopTarget::nearest(drive.signed()))?,
        Some(Mode::Current) => write!(f, "drive {}", Current::from_raw(drive.signed()))?,
        Some(Mode::Position) => {
            write!(f, "drive to {}", Position::from_raw(drive.unsigned()))?;
        }
    }
    match (mode, drive.acceleration.byte()) {
        (Some(Mode::Velocity) | None, units @ 1..) => write!(f, ", accel {units}"),
        _ => Ok(()),
    }
}

fn received(f: &mut fmt::Formatter<'_>, reply: &Reply) -> fmt::Result {
    // What is unknown is left out.
    let mut separator = "";
    let mut part = |part: &dyn fmt::Display| {
        let written = write!(f, "{separator}{part}");
        separator = ", ";
        written
    };
    if let Some(speed) = reply.speed {
        part(&speed)?;
    }
    if let Some(current) = reply.current {
        part(&current)?;
    }
    if let Some(temperature) = reply.detail.temperature() {
        part(&temperature)?;
    }
    if let Detail::Odometry { turns, .. } = reply.detail {
        part(&format_args!("{turns} turns"))?;
    }
    if let Some(angle) = reply.detail.angle() {
        part(&angle)?;
    }
    if reply.mode != Mode::Velocity {
        write!(f, ", {}", reply.mode)?;
    }
    if !reply.faults.is_none() {
        write!(f, ", fault: {}", reply.faults)?;
    }
    Ok(())
}
