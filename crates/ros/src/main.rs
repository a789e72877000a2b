//! `motorlink-ros`.

use std::process::ExitCode;

use clap::Parser as _;
use motorlink_ros::{arguments::Arguments, run::run};

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}
