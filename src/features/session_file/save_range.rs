//! The choice of how much is saved.

use std::time::Duration;

use motorlink_messages::sessions::SaveRange;

pub(super) const RANGES: [(SaveRange, &str); 4] = [
    (SaveRange::Line, "line"),
    (SaveRange::Last(Duration::from_secs(600)), "ten-minutes"),
    (SaveRange::Recording, "recording"),
    (SaveRange::LineBefore, "line-before"),
];
