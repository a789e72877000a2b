//! Names in a session file.

/// The profile of the container.
pub(crate) const PROFILE: &str = "motorlink";

/// The metadata record that marks the file as a session.
pub(crate) const METADATA: &str = "motorlink";

/// The version of the channels, in the metadata.
pub(crate) const VERSION_KEY: &str = "version";
pub(crate) const VERSION: u32 = 1;
pub(crate) const VERSION_TEXT: &str = "1";

/// The attachment with the overview.
pub(crate) const OVERVIEW: &str = "overview.json";

/// The rover in the metadata, as `Vehicle::to_json` of `motorlink_experiments` writes it.
pub(crate) const ROVER_KEY: &str = "rover";
