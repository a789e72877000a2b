//! The keys of the terminal.
//!
//! After a terminal is closed, crossterm reads it in an endless loop. So it is asked first whether it is there.

#[cfg(unix)]
use std::{
    fs::File,
    io::IsTerminal,
    os::fd::{AsFd, BorrowedFd},
};
use std::{io, time::Duration};

use ratatui::crossterm::event::{self, Event};

use crate::failure::Failure;

/// The keys of the terminal.
pub struct KeyInput {
    /// The terminal, if it is not the standard input.
    #[cfg(unix)]
    terminal: Option<File>,
}

impl KeyInput {
    /// Of the terminal that crossterm reads: the standard input, or else the one that controls this process.
    pub fn open() -> io::Result<Self> {
        Ok(Self {
            #[cfg(unix)]
            terminal: if io::stdin().is_terminal() {
                None
            } else {
                Some(File::open("/dev/tty")?)
            },
        })
    }

    /// The next key, or another event of the terminal, if one comes within this time.
    ///
    /// # Errors
    /// The terminal is gone.
    pub fn next(&self, wait: Duration) -> Result<Option<Event>, Failure> {
        let next = || {
            #[cfg(unix)]
            let wait = {
                let input = io::stdin();
                let terminal = self.terminal.as_ref().map(AsFd::as_fd);
                wait_for(terminal.unwrap_or(input.as_fd()), wait)?;
                Duration::ZERO
            };
            event::poll(wait)?.then(event::read).transpose()
        };
        next().map_err(Failure::output)
    }
}

/// Waits until the terminal has input, at most this long.
#[cfg(unix)]
fn wait_for(terminal: BorrowedFd<'_>, wait: Duration) -> io::Result<()> {
    use rustix::{
        event::{PollFd, PollFlags, Timespec, poll},
        io::Errno,
    };

    let wait = Timespec::try_from(wait).map_err(io::Error::other)?;
    let mut terminal = [PollFd::new(&terminal, PollFlags::IN)];
    match poll(&mut terminal, Some(&wait)) {
        // The window may have another size.
        Ok(_) | Err(Errno::INTR) => {}
        Err(error) => return Err(error.into()),
    }
    let [terminal] = terminal;
    if terminal
        .revents()
        .intersects(PollFlags::HUP | PollFlags::ERR)
    {
        return Err(io::Error::other("the terminal is gone"));
    }
    Ok(())
}
