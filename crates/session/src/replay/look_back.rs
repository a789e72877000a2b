//! How far before a place a replay reads.

use std::time::Duration;

/// How far before a place a replay reads, in order to know what the page shows there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LookBack {
    /// For the first picture. Default 3 s.
    pub picture: Duration,
    /// For the graph, and at least for the state and the packet log. Default 60 s.
    pub past: Duration,
    /// The state and the packet log look further back while the chunks of the file have no more bytes, decompressed.
    /// Default 12 MB: a minute at 500 exchanges a second, or half an hour at 10.
    pub bytes: u64,
}

impl Default for LookBack {
    fn default() -> Self {
        Self {
            picture: Duration::from_secs(3),
            past: Duration::from_secs(60),
            bytes: 12 << 20,
        }
    }
}
