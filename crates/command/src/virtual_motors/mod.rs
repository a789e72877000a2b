//! `motorlink virtual`: virtual hub motors on a pseudo-terminal, for any serial program.
//!
//! The world of `motorlink-simulator` in real time: what a program writes to the terminal is heard
//! by the motors, and what they answer comes back when it would on a real wire.

mod clock;
mod command;
mod flags;
mod lines;
mod link;
mod pty;
mod serve;
mod terminal;
mod wire_log;

use std::{io::Write as _, path::Path};

use motorlink_protocol::family::Model;

use crate::failure::Failure;
pub use flags::VirtualMotors;

/// Shows motors of this model until a signal ends the program.
///
/// # Errors
/// The flags cannot be obeyed, or the terminal or the log fails.
pub fn run(flags: VirtualMotors, model: Model) -> Result<(), Failure> {
    let flags = flags.check(model)?;
    let signals = serve::Signals::register()?;
    let log = flags.log.as_deref().map(wire_log::WireLog::create);
    let log = log.transpose()?;
    // Last, so that nothing that may fail leaves a link behind.
    let terminal = terminal::Terminal::open(flags.world.baud, flags.link.as_deref())?;
    let path = terminal.pty().map(pty::Pty::slave_path);
    let path = path.unwrap_or(Path::new(""));
    writeln!(std::io::stdout(), "ready {}", path.display()).map_err(Failure::output)?;
    serve::Server::new(flags.world, flags.json, terminal, log, signals).run()
}
