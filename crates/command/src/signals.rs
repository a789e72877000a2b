//! Signals that would suspend or abort the program while a motor runs: it ends instead, and stops the motor.

use std::{
    io::{self, Read},
    os::unix::net::UnixStream,
    thread,
};

use motorlink_driver::Ender;
use signal_hook::{
    consts::{SIGQUIT, SIGTSTP},
    low_level::pipe,
};

/// From now on Ctrl-Z and Ctrl-\\ end the driver.
///
/// # Errors
/// The system refuses a handler.
pub fn end_instead(ender: &Ender) -> io::Result<()> {
    let (mut noted, note) = UnixStream::pair()?;
    for signal in [SIGQUIT, SIGTSTP] {
        pipe::register(signal, note.try_clone()?)?;
    }
    let ender = ender.clone();
    let wait = move || {
        if noted.read_exact(&mut [0]).is_ok() {
            ender.end();
        }
    };
    thread::Builder::new()
        .name("motorlink signals".to_owned())
        .spawn(wait)?;
    Ok(())
}
