//! The part of the command line that is about replays.

use std::{path::PathBuf, time::Duration};

use clap::Args;
use motorlink_messages::sessions::PlaySpeed;

use crate::parsers::{play_speed, seconds};

/// What of a session file is shown, and how.
#[derive(Debug, Args)]
pub struct Replay {
    /// The session file (.mcap), or a CSV file of the page
    pub file: PathBuf,
    /// How many times faster than it was recorded, 0.1-100
    #[arg(long, default_value = "1", value_parser = play_speed, value_name = "FACTOR")]
    pub speed: PlaySpeed,
    /// Begin so many seconds after the first record
    #[arg(long, default_value = "0", value_parser = seconds, value_name = "SECS")]
    pub from: Duration,
    /// End so many seconds after the first record; without it, at the last one
    #[arg(long, value_parser = seconds, value_name = "SECS")]
    pub to: Option<Duration>,
    /// CSV of every reply, at once: to this file, or to the standard output
    #[arg(long, num_args = 0..=1, value_name = "FILE")]
    #[expect(clippy::option_option, reason = "absent, without a value, or with one")]
    pub csv: Option<Option<PathBuf>>,
    /// A line of JSON for every reply, at once
    #[arg(long, conflicts_with = "csv")]
    pub json: bool,
}
