//! The pseudo-terminal: its slave is the serial port that programs open.

use std::{
    ffi::OsStr,
    os::{fd::OwnedFd, unix::ffi::OsStrExt},
    path::{Path, PathBuf},
};

use rustix::{
    fs::{Mode, OFlags, fcntl_setfl, open},
    io::{self, Errno},
    pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt},
    termios::{OptionalActions, tcgetattr, tcsetattr},
};

use crate::failure::Failure;

/// Both ends of the pair.
#[derive(Debug)]
pub(crate) struct Pty {
    master: OwnedFd,
    /// Kept open, so that the terminal survives a host that closes it.
    _slave: OwnedFd,
    slave_path: PathBuf,
}

impl Pty {
    /// A new pair in raw mode: bytes pass as they are, and nothing is echoed by the terminal. A program
    /// that sets no baud has this one.
    ///
    /// # Errors
    /// The system has no terminal to give.
    pub(crate) fn open(baud: u32) -> Result<Self, Failure> {
        Self::try_open(baud).map_err(Failure::system("cannot open a pseudo-terminal"))
    }

    fn try_open(baud: u32) -> io::Result<Self> {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        grantpt(&master)?;
        unlockpt(&master)?;
        let name = ptsname(&master, Vec::new())?;
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let slave = open(name.as_c_str(), flags, Mode::empty())?;
        let mut settings = tcgetattr(&slave)?;
        settings.make_raw();
        settings.set_speed(baud)?;
        tcsetattr(&slave, OptionalActions::Now, &settings)?;
        fcntl_setfl(&master, OFlags::NONBLOCK)?;
        Ok(Self {
            master,
            _slave: slave,
            slave_path: PathBuf::from(OsStr::from_bytes(name.to_bytes())),
        })
    }

    pub(crate) fn slave_path(&self) -> &Path {
        &self.slave_path
    }

    /// The baud that the host has set. A terminal carries bytes at any; a motor hears only its own.
    ///
    /// # Errors
    /// The terminal is gone.
    pub(crate) fn baud(&self) -> Result<u32, Failure> {
        let settings =
            tcgetattr(&self.master).map_err(Failure::system("cannot ask the terminal"))?;
        Ok(settings.output_speed())
    }

    pub(crate) const fn master(&self) -> &OwnedFd {
        &self.master
    }

    /// What the host has written since the last call; empty if nothing.
    ///
    /// # Errors
    /// The terminal is gone.
    pub(crate) fn read<'a>(&self, buffer: &'a mut [u8]) -> Result<&'a [u8], Failure> {
        let count = match io::read(&self.master, &mut *buffer) {
            Ok(count) => count,
            Err(Errno::AGAIN | Errno::INTR) => 0,
            Err(error) => return Err(Failure::system("cannot read the terminal")(error)),
        };
        Ok(buffer.get(..count).unwrap_or_default())
    }

    /// Delivers bytes in one write. A host that does not read loses what its buffer cannot hold, as
    /// with a real port.
    ///
    /// # Errors
    /// The terminal is gone.
    pub(crate) fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        match io::write(&self.master, bytes) {
            Ok(_) | Err(Errno::AGAIN | Errno::INTR) => Ok(()),
            Err(error) => Err(Failure::system("cannot write the terminal")(error)),
        }
    }
}
