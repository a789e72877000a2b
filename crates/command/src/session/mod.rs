//! The command `session`: prints, checks and converts session files.

pub mod arguments;
mod export;
pub mod file;
mod info;
mod runs;

pub use info::{exit_code, one_line};

use crate::{failure::Failure, output::say};
use arguments::SessionAction;
use file::Opened;

/// Does what was asked. Exit code 1 if something of the file is missing or damaged, 2 if it cannot be read at all.
pub fn run(action: SessionAction) -> u8 {
    match try_run(action) {
        Ok(code) => code,
        Err(failure) => {
            say(&failure);
            failure.exit_code()
        }
    }
}

fn try_run(action: SessionAction) -> Result<u8, Failure> {
    match action {
        SessionAction::Info { file } => info::info(&mut Opened::open(&file)?),
        SessionAction::Check { file } => info::check(&mut Opened::open(&file)?),
        SessionAction::Export { file, format, out } => {
            export::export(&mut Opened::open(&file)?, format, out.as_deref())
        }
        SessionAction::Runs { file, out } => runs::write(&mut Opened::open(&file)?, &out),
    }
}
