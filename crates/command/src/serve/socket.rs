//! The socket for a controller on this computer.

use std::{io, path::Path};

use motorlink_remote_server::Viewers;
#[cfg(unix)]
use motorlink_remote_server::{ControlSocket, RunningSocket};

use crate::failure::Failure;

/// The socket of `--socket`, before its start.
pub struct Socket(#[cfg(unix)] ControlSocket);

/// The socket while the server runs.
pub struct Running(
    #[cfg(unix)]
    #[expect(dead_code, reason = "its end ends the socket")]
    RunningSocket,
);

#[cfg(unix)]
impl Socket {
    /// Listens at this path.
    ///
    /// # Errors
    /// Another program listens there, or the path cannot be used.
    pub fn prepare(path: &Path) -> Result<Self, Failure> {
        let socket = ControlSocket::bind(path).map_err(|why| {
            let path = path.display();
            Failure::Usage(format!("--socket {path}: {why}"))
        })?;
        Ok(Self(socket))
    }

    /// Lets clients in.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn start(self, viewers: Viewers) -> io::Result<Running> {
        self.0.start(viewers).map(Running)
    }
}

#[cfg(not(unix))]
impl Socket {
    /// There is none on this system.
    ///
    /// # Errors
    /// Always.
    pub fn prepare(path: &Path) -> Result<Self, Failure> {
        let path = path.display();
        let text = format!("--socket {path}: this system has no Unix sockets for it; leave it out");
        Err(Failure::Usage(text))
    }

    /// Lets clients in.
    ///
    /// # Errors
    /// Never: there is no such socket.
    pub fn start(self, _viewers: Viewers) -> io::Result<Running> {
        Ok(Running())
    }
}
