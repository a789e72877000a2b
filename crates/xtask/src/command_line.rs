//! The commands and their flags.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{Args, Parser, Subcommand};

use crate::failure::BAD_INPUT_CODE;
use crate::reliability;

/// Builds, serves, tests and measures MotorLink.
#[derive(Debug, Parser)]
#[command(
    name = "cargo xtask",
    bin_name = "cargo xtask",
    disable_help_subcommand = true
)]
pub struct CommandLine {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Build the page into dist/, a static site that works at any path
    Build {
        /// Quick to build, slow to run; into target/site-dev
        #[arg(long)]
        dev: bool,
    },
    /// Build the page, serve it on this machine and open it
    Run {
        /// Build for speed: needed at high drive rates
        #[arg(long)]
        release: bool,
        /// Port to serve on [default: 8017, or the next free one]
        #[arg(long)]
        port: Option<u16>,
        /// Leave the browser alone
        #[arg(long)]
        no_open: bool,
    },
    /// Serve a page built before
    Serve {
        /// Directory to serve [default: dist]
        #[arg(long)]
        dir: Option<PathBuf>,
        /// Port to serve on [default: 8017, or the next free one]
        #[arg(long)]
        port: Option<u16>,
    },
    /// Run the tests, step by step, stopping at the first step that fails
    Test(Selection),
    /// Check format, lints, documentation, dependencies and translations, stopping at the first failure
    Check(Selection),
    /// Measure drive rate, stop time and first visit in a real browser
    Bench {
        /// Handed to the program that measures
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        args: Vec<String>,
    },
    /// Bring the files of translations, locales/*.po, up to date with the code
    Translations {
        /// Change nothing; fail where one is not up to date or lacks a translation
        #[arg(long)]
        check: bool,
    },
    /// Play worlds that fail, as many seeds as there is time for (`--seconds N`), or one (`--seed N`)
    Soak {
        /// Handed to the program that plays
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        args: Vec<String>,
    },
    /// Play 100,000 worlds, break each rule on purpose, fuzz, and play the stories under faults in a browser; into docs/reliability.md
    Reliability {
        /// Only this part of it
        #[arg(value_parser = reliability::PARTS)]
        part: Option<String>,
        /// How long each part that reads input is fuzzed
        #[arg(long, default_value_t = 600)]
        seconds: u64,
        /// How many worlds are played: 1,000 take 8 s on two cores
        #[arg(long, default_value_t = 100_000)]
        worlds: u64,
    },
    /// Change what keeps fingers whole, spot by spot, and fail where no test of the bus notices
    Mutants {
        /// How many changes are tried at once
        #[arg(long, default_value_t = 1)]
        jobs: u8,
    },
    /// Judge the built page with Lighthouse, as a desktop and as a phone load it
    Lighthouse,
    /// Make the README's moving picture (`docs`: that alone), the installer's, and one of every view
    Screenshots {
        /// Handed to the program that makes them
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        args: Vec<String>,
    },
}

/// Which steps of a suite to run.
#[derive(Debug, Args)]
pub struct Selection {
    /// Run one step, and those it needs
    #[arg(long, value_name = "STEP")]
    pub only: Option<String>,
    /// Print the names of the steps
    #[arg(long, conflicts_with = "only")]
    pub list: bool,
}

/// Says in one line what is wrong with the command line, or prints the help that was asked for.
pub fn explain(error: &clap::Error) -> ExitCode {
    if matches!(error.kind(), ErrorKind::DisplayHelp) {
        print!("{error}");
        return ExitCode::SUCCESS;
    }
    eprintln!("{} (see cargo xtask --help)", one_line(error));
    ExitCode::from(BAD_INPUT_CODE)
}

/// The first line of clap's message; what follows is usage and hints.
fn one_line(error: &clap::Error) -> String {
    if matches!(
        error.kind(),
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand | ErrorKind::MissingSubcommand
    ) {
        return "error: no command given".to_owned();
    }
    let text = error.to_string();
    text.lines().next().unwrap_or("error").to_owned()
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    fn refused(args: &[&str]) -> String {
        let line = std::iter::once("cargo xtask").chain(args.iter().copied());
        one_line(&CommandLine::try_parse_from(line).unwrap_err())
    }

    #[test]
    fn the_command_line_is_sound() {
        CommandLine::command().debug_assert();
    }

    #[test]
    fn bad_input_is_explained_in_one_line() {
        assert_eq!(refused(&[]), "error: no command given");
        assert_eq!(
            refused(&["build", "--fast"]),
            "error: unexpected argument '--fast' found"
        );
        assert_eq!(refused(&["fly"]), "error: unrecognized subcommand 'fly'");
        assert!(refused(&["run", "--port", "70000"]).contains("70000"));
    }

    #[test]
    fn the_bench_takes_any_flags() {
        let line = CommandLine::try_parse_from(["cargo xtask", "bench", "--seconds", "5"]);
        let Command::Bench { args } = line.unwrap().command else {
            panic!("not a bench");
        };
        assert_eq!(args, ["--seconds", "5"]);
    }
}
