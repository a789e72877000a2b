//! Virtual hub motors on a pseudo-terminal, for any serial program.
//!
//! The world of `motorlink-simulator` in real time: what a program writes to the terminal is heard
//! by the motors, and what they answer comes back when it would on a real wire.

mod arguments;
mod clock;
mod command;
mod failure;
mod lines;
mod link;
mod pty;
mod serve;
mod terminal;
mod wire_log;

use std::{io::Write as _, path::Path, process::ExitCode};

use arguments::{Arguments, Asked};
use failure::Failure;

fn main() -> ExitCode {
    let done = match arguments::read() {
        Ok(Asked::Motors(arguments)) => run(*arguments),
        Ok(Asked::Help(text)) => {
            print!("{text}");
            Ok(())
        }
        Err(failure) => Err(failure),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("virtual-motor: {failure}");
            failure.exit_code()
        }
    }
}

fn run(arguments: Arguments) -> Result<(), Failure> {
    let signals = serve::Signals::register()?;
    let log = arguments.log.as_deref().map(wire_log::WireLog::create);
    let log = log.transpose()?;
    // Last, so that nothing that may fail leaves a link behind.
    let terminal = terminal::Terminal::open(arguments.world.baud, arguments.link.as_deref())?;
    let path = terminal.pty().map(pty::Pty::slave_path);
    let path = path.unwrap_or(Path::new(""));
    writeln!(std::io::stdout(), "ready {}", path.display())
        .map_err(Failure::system("cannot write to standard output"))?;
    serve::Server::new(arguments.world, arguments.json, terminal, log, signals).run()
}
