//! `cargo xtask`: builds, serves, tests and measures MotorLink.
//!
//! Not a library and not shipped: it runs the tools that turn the workspace into the site in
//! `dist/`, its checks and its tests.

mod again;
mod bench;
mod bindgen;
mod browser;
mod cargo;
mod check;
mod claims;
mod command_line;
mod content_hash;
mod dependencies;
mod experiments;
mod failure;
mod fleet;
mod invariants;
mod layers;
mod lines;
mod minify;
mod mutants;
mod npm;
mod other_command;
mod other_hosts;
mod page_tests;
mod parts;
mod process;
mod programs;
mod python;
mod reliability;
mod ros;
mod sabotage;
mod scenarios;
mod serve;
mod service_worker;
mod short_names;
mod site;
mod site_file;
mod size;
mod style;
mod suite;
mod tables;
mod template;
mod test;
mod tools;
mod translations;
mod used_types;
mod workspace;

use std::process::ExitCode;

use anyhow::Result;
use clap::Parser;

use command_line::{Command, CommandLine};
use site_file::Profile;
use workspace::Workspace;

fn main() -> ExitCode {
    match run(CommandLine::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => failure::report(&error),
    }
}

/// Runs the command of the command line.
fn run(command: Command) -> Result<()> {
    let workspace = Workspace::find()?;
    match command {
        Command::Build { dev } => {
            let profile = if dev { Profile::Dev } else { Profile::Release };
            site::build(&workspace, profile).map(|_| ())
        }
        Command::Run {
            release,
            port,
            no_open,
        } => {
            let profile = if release {
                Profile::Release
            } else {
                Profile::Dev
            };
            // Before the build: a taken port should not cost minutes to be found.
            let listener = serve::listen(port)?;
            let dir = site::build(&workspace, profile)?;
            serve::serve(&dir, listener, !no_open)
        }
        Command::Serve { dir, port } => {
            let dir = dir.unwrap_or_else(|| workspace.dist());
            serve::serve(&dir, serve::listen(port)?, false)
        }
        Command::Test(selection) => test::SUITE.run(&workspace, &selection),
        Command::Check(selection) => check::SUITE.run(&workspace, &selection),
        Command::Bench { args } => bench::figures(&workspace, &args),
        Command::Reliability {
            part,
            seconds,
            worlds,
            rule,
        } => reliability::show(
            &workspace,
            part.as_deref(),
            seconds,
            worlds,
            rule.as_deref(),
        ),
        Command::Experiments => experiments::show(&workspace),
        Command::Mutants { set, jobs } => mutants::show(&workspace, set, jobs),
        Command::Translations { check } => translations::update(&workspace, check),
        Command::Soak { args } => bench::soak(&workspace, &args),
        Command::Lines => lines::show(&workspace),
        Command::Screenshots { args } => bench::screenshots(&workspace, &args),
    }
}
