//! `cargo run -p session -- info|check|export|runs FILE`: prints, checks and converts session files.

mod command_line;
mod export;
mod file;
mod info;
mod runs;

use std::process::ExitCode;

use clap::Parser;

use command_line::{Action, CommandLine};
use file::{Failure, Opened};

fn main() -> ExitCode {
    match run(CommandLine::parse().action) {
        Ok(code) => code,
        Err(failure) => {
            eprintln!("{failure}");
            ExitCode::from(2)
        }
    }
}

fn run(action: Action) -> Result<ExitCode, Failure> {
    match action {
        Action::Info { file } => info::info(&mut Opened::open(&file)?),
        Action::Check { file } => info::check(&mut Opened::open(&file)?),
        Action::Export { file, format, out } => {
            export::export(&mut Opened::open(&file)?, format, out.as_deref())
        }
        Action::Runs { file, out } => runs::write(&mut Opened::open(&file)?, &out),
    }
}
