//! `motorlink-fleet`.

use std::process::ExitCode;

use clap::Parser as _;
use motorlink_ros::fleet::program::Fleet;

fn main() -> ExitCode {
    match Fleet::parse().run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}
