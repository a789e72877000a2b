//! The part of the command line that is about session files.

use std::path::PathBuf;

use clap::{Subcommand, ValueEnum};

/// What to do with a session file.
#[derive(Debug, Subcommand)]
pub enum SessionAction {
    /// Print what is in a file, by its index
    Info {
        /// The file
        file: PathBuf,
    },
    /// Read every record, and say what is missing or damaged. Exit code 1 if anything is
    Check {
        /// The file
        file: PathBuf,
    },
    /// Convert a file. Exit code 1 if something of it is missing or damaged
    Export {
        /// The file
        file: PathBuf,
        /// What to make of it
        #[arg(long, value_enum, default_value_t = Format::Plot)]
        format: Format,
        /// Where to write it; without it, to the standard output
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// Write each run of an experiment as JSON, and as CSV of its setpoints and samples. Exit code 1 if one is unreadable, or a part of the file is missing
    Runs {
        /// The file
        file: PathBuf,
        /// The folder to write to
        #[arg(long, default_value = ".")]
        out: PathBuf,
    },
}

/// What to make of a session file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// CSV for plotting, as in PlotJuggler: seconds, and a column for each motor and quantity
    Plot,
    /// CSV of telemetry, with the columns of the article's monitor script
    Telemetry,
    /// CSV of the packet log
    Log,
    /// What happened, as one HTML file
    Report,
    /// A session file, such as of a CSV file
    Mcap,
}
