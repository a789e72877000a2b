//! A frame in words.

use core::fmt;

use crate::{Detail, Drive, Frame, Layout, Mode, Reply, ReplyError, Request, RequestError};

/// A frame in words: what a host asked, what a motor answered, or why it is neither.
///
/// Displays as `drive +100 rpm, accel 1`, as `+100 rpm, +0.175 A, 66.96°`, or as what is
/// wrong: `CRC 5B, expected 1B`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Explained {
    /// What a host asked.
    Sent {
        /// The request, or why it is none.
        request: Result<Request, RequestError>,
        /// The loop in which the value of a drive frame is to be read.
        mode: Option<Mode>,
    },
    /// What a motor answered, or why it is no answer.
    Received(Result<Reply, ReplyError>),
}

/// Says what a host's frame asks. The value of a drive frame is read in `mode`, the loop that the
/// motor is in; without it, the value stays a raw number.
#[must_use]
pub fn explain_sent(frame: &Frame, mode: Option<Mode>) -> Explained {
    Explained::Sent {
        request: Request::parse(frame),
        mode,
    }
}

/// Says what a motor's frame reports, read by what was asked.
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
            Self::Received(Ok(reply)) => heard(f, reply),
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
        Some(Mode::Velocity) => write!(f, "drive {}", crate::Rpm::new(drive.signed()))?,
        Some(Mode::Current) => write!(f, "drive {}", crate::Current::from_raw(drive.signed()))?,
        Some(Mode::Position) => {
            write!(
                f,
                "drive to {}",
                crate::Position::from_raw(drive.unsigned())
            )?;
        }
    }
    match (mode, drive.acceleration.byte()) {
        (Some(Mode::Velocity) | None, units @ 1..) => write!(f, ", accel {units}"),
        _ => Ok(()),
    }
}

fn heard(f: &mut fmt::Formatter<'_>, reply: &Reply) -> fmt::Result {
    match reply.detail {
        Detail::Drive { position } => write!(f, "{}, {}, {position}", reply.speed, reply.current)?,
        Detail::Query {
            temperature,
            position,
        } => {
            write!(
                f,
                "{}, {}, {temperature}, {position}",
                reply.speed, reply.current
            )?;
        }
        Detail::Undetermined(_) => write!(f, "{}, {}", reply.speed, reply.current)?,
    }
    if reply.mode != Mode::Velocity {
        write!(f, ", {}", reply.mode)?;
    }
    if !reply.faults.is_none() {
        write!(f, ", fault: {}", reply.faults)?;
    }
    Ok(())
}
