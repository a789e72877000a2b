//! Why a port cannot be opened.

use std::{fmt, fs, io};

use crate::holder::{Holder, holder_of};

/// Why a port cannot be opened. Its text is one line and says what to do.
#[derive(Debug)]
pub enum OpenFailure {
    /// There is no serial port.
    NoPort,
    /// There are several, and none was chosen.
    SeveralPorts(Vec<String>),
    /// No port has this name.
    NotFound(String),
    /// Something else has this name: a file or a folder.
    NotSerial(String),
    /// This user may not open it.
    Denied(String),
    /// Another program has it open.
    Busy {
        /// The port.
        path: String,
        /// The program, if the system tells.
        holder: Option<Holder>,
    },
    /// The system refuses it for another reason.
    Io(String, io::Error),
    /// The port was lost while it was opened.
    Lost,
    /// The program was told to end meanwhile.
    Ended,
}

impl fmt::Display for OpenFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPort => f.write_str(
                "no serial port found: plug the USB adapter in, name a port with --port, or use --virtual",
            ),
            Self::SeveralPorts(paths) => {
                write!(f, "several serial ports: choose one with --port ({})", paths.join(", "))
            }
            Self::NotFound(path) => {
                write!(f, "{path}: no such port; `motorlink ports` lists what is there")
            }
            Self::NotSerial(path) => {
                write!(f, "{path}: not a serial port; `motorlink ports` lists what is there")
            }
            Self::Denied(path) => write!(
                f,
                "{path}: no permission; add yourself to its group: sudo usermod -aG dialout $USER, then log in again"
            ),
            Self::Busy { path, holder } => match holder {
                Some(holder) => {
                    write!(f, "{path}: in use by {holder}; {}", holder.remedy())
                }
                None => write!(f, "{path}: in use by another program; close it, then try again"),
            },
            Self::Io(path, error) => write!(f, "{path}: {error}"),
            Self::Lost => f.write_str("the port was lost while it was opened: check the USB plug, then try again"),
            Self::Ended => f.write_str("ended before the port was open"),
        }
    }
}

impl std::error::Error for OpenFailure {}

impl OpenFailure {
    /// What the system said of this port.
    pub(crate) fn of(path: &str, error: &serialport::Error) -> Self {
        let path = path.to_owned();
        // A serial port is neither, on any system.
        if fs::metadata(&path).is_ok_and(|what| what.is_file() || what.is_dir()) {
            return Self::NotSerial(path);
        }
        match error.kind() {
            serialport::ErrorKind::NoDevice => {
                let holder = holder_of(&path);
                let is_there = holder.is_some() || std::path::Path::new(&path).exists();
                if is_there {
                    Self::Busy { path, holder }
                } else {
                    Self::NotFound(path)
                }
            }
            serialport::ErrorKind::Io(io::ErrorKind::PermissionDenied) => Self::Denied(path),
            serialport::ErrorKind::Io(io::ErrorKind::NotFound) => Self::NotFound(path),
            serialport::ErrorKind::Io(io::ErrorKind::ResourceBusy) => {
                let holder = holder_of(&path);
                Self::Busy { path, holder }
            }
            _ => {
                let error = io::Error::other(error.to_string());
                Self::Io(path, error)
            }
        }
    }
}
