//! The program `motorlink`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(motorlink_command::run(std::env::args_os()))
}
