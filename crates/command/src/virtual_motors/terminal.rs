//! The terminal as an adapter that can be pulled out, while its motors go on.

use std::path::{Path, PathBuf};

use crate::{
    failure::Failure,
    virtual_motors::{link::Link, pty::Pty},
};

/// The pseudo-terminal with its link, or nothing while the adapter is pulled out.
#[derive(Debug)]
pub(crate) struct Terminal {
    baud: u32,
    link: Option<PathBuf>,
    plugged: Option<(Pty, Option<Link>)>,
}

impl Terminal {
    /// A plugged terminal, with a link at this path.
    ///
    /// # Errors
    /// The system has no terminal to give, or the link cannot be made.
    pub(crate) fn open(baud: u32, link: Option<&Path>) -> Result<Self, Failure> {
        let mut terminal = Self {
            baud,
            link: link.map(Path::to_owned),
            plugged: None,
        };
        terminal.try_plug()?;
        Ok(terminal)
    }

    pub(crate) const fn pty(&self) -> Option<&Pty> {
        match &self.plugged {
            Some((pty, _)) => Some(pty),
            None => None,
        }
    }

    fn try_plug(&mut self) -> Result<(), Failure> {
        let pty = Pty::open(self.baud)?;
        let link = match self.link.as_deref() {
            Some(path) => Some(Link::create(path, pty.slave_path())?),
            None => None,
        };
        self.plugged = Some((pty, link));
        Ok(())
    }

    /// Plugs it again, as another terminal.
    ///
    /// # Errors
    /// It is plugged, or the system gives none.
    pub(crate) fn plug(&mut self) -> Result<(), String> {
        if self.plugged.is_some() {
            return Err("it is plugged".to_owned());
        }
        self.try_plug().map_err(|failure| failure.to_string())
    }

    /// Pulls it out: the program that has it open loses it.
    ///
    /// # Errors
    /// It is pulled out already.
    pub(crate) fn unplug(&mut self) -> Result<(), String> {
        match self.plugged.take() {
            Some(_) => Ok(()),
            None => Err("it is not plugged".to_owned()),
        }
    }
}
