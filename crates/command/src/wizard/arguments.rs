//! The part of the command line that is about the wizard.

use clap::Args;
use motorlink_bus::GroupSetpoints;
use motorlink_protocol::AssignableId;

use crate::parsers::assignable;

/// Which IDs the motors get.
#[derive(Debug, Args)]
pub struct Wizard {
    /// So many motors get an ID; 0 only asks which wheel each motor turns. Without it, until you say that it was the last
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u8).range(0..=GroupSetpoints::MAX as i64))]
    pub count: Option<u8>,
    /// The ID of the first motor. The next ones get the free IDs after it
    #[arg(long, default_value = "1", value_name = "ID", value_parser = assignable)]
    pub first: AssignableId,
}
