//! The commands and their flags.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::{mutants, reliability};

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
    /// Build the page into dist/, a static site that works at any path of a host
    Build {
        /// Build quickly, without optimisation, into target/site-dev
        #[arg(long)]
        dev: bool,
    },
    /// Build the page, serve it on this machine and open it
    Run {
        /// Build with optimisation, as high drive rates need it
        #[arg(long)]
        release: bool,
        /// Port to serve on [default: 8017, or the next free one]
        #[arg(long)]
        port: Option<u16>,
        /// Do not open a browser
        #[arg(long)]
        no_open: bool,
    },
    /// Serve a page that was built before
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
    /// Measure drive rates, stop times and the first visit in a real browser; update docs/performance.md
    Bench {
        /// Arguments of the program that measures
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        args: Vec<String>,
    },
    /// Update the translation files, locales/*.po, from the code
    Translations {
        /// Change nothing; fail if a file is out of date or a translation is missing
        #[arg(long)]
        check: bool,
    },
    /// Run the fault simulation, for a time (`--seconds N`) or for one seed (`--seed N`)
    Soak {
        /// Arguments of the fault simulation
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        args: Vec<String>,
    },
    /// Run 100,000 seeds of the fault simulation, break each rule on purpose, fuzz, and run the scenarios with faults in a browser; update docs/reliability.md
    Reliability {
        /// Run this part only
        #[arg(value_parser = reliability::PARTS)]
        part: Option<String>,
        /// Fuzzing time of each target, in seconds
        #[arg(long, default_value_t = 600)]
        seconds: u64,
        /// Number of simulated worlds; 1,000 take 8 s on two cores
        #[arg(long, default_value_t = 100_000)]
        worlds: u64,
        /// Of the part `sabotage`, only what breaks this rule
        #[arg(long, value_name = "RULE")]
        rule: Option<String>,
    },
    /// Measure the figures of crates/experiments on virtual motors, run the generated programs, check the files of a robot
    Experiments,
    /// Run mutation tests on the protocol, the safety code of the bus and the decoder of saved sessions; fail if a mutant survives without a reason
    Mutants {
        /// Run one set [default: all]
        set: Option<mutants::Set>,
        /// Number of mutants tested at the same time
        #[arg(long, default_value_t = 1)]
        jobs: u8,
    },
    /// Count the product code of src and of each crate: lines without tests, blanks and comments
    Lines,
    /// Make screenshots of every screen, window, theme and language in `target/screenshots`; `docs` and `public`
    /// renew the README's moving picture and the installer's pictures, `terminal` those of the command
    Screenshots {
        /// Arguments of the program that makes them
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
    /// Run this step too, which a whole run leaves out
    #[arg(long, value_name = "STEP", conflicts_with = "only")]
    pub with: Option<String>,
    /// Print the names of the steps
    #[arg(long, conflicts_with = "only")]
    pub list: bool,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_sound() {
        CommandLine::command().debug_assert();
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
