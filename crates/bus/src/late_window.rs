//! The reply window that late replies have shown to be needed.
//!
//! Round trips are measured only where no reply was lost shortly before (Karn's algorithm). If an adapter becomes
//! slower than the windows and several motors share it, that is never the case, so late replies widen the windows
//! themselves.

use std::time::Duration;

use motorlink_protocol::Instant;

use crate::timing::{LATE_FORGOTTEN, MIN_WINDOW};

/// Each late reply counts for [`LATE_FORGOTTEN`]. By then the round trips have been measured.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LateWindow {
    until: Instant,
    window: Duration,
}

impl LateWindow {
    /// A late reply has arrived. `sent` is the last request that it may answer.
    pub(crate) fn widen(&mut self, heard: Instant, sent: Instant) {
        let shown = heard.since(sent) + MIN_WINDOW / 2;
        self.window = shown.max(self.at(heard));
        self.until = heard + LATE_FORGOTTEN;
    }

    /// The window; zero if no late reply is remembered.
    pub(crate) fn at(&self, now: Instant) -> Duration {
        if now <= self.until {
            self.window
        } else {
            Duration::ZERO
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(ms: u64) -> Instant {
        Instant::ZERO + Duration::from_millis(ms)
    }

    #[test]
    fn late_replies_widen_the_window_to_the_latest_for_a_second() {
        let mut late = LateWindow::default();
        assert_eq!(late.at(at(0)), Duration::ZERO);
        late.widen(at(118), at(100));
        assert_eq!(late.at(at(1_118)), Duration::from_millis(21));
        assert_eq!(late.at(at(1_119)), Duration::ZERO);
        late.widen(at(1_000), at(990));
        assert_eq!(late.at(at(2_000)), Duration::from_millis(21));
        late.widen(at(2_001), at(1_991));
        assert_eq!(late.at(at(2_001)), Duration::from_millis(13));
    }
}
