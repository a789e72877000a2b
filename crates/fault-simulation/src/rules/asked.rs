//! Whether every motor that is not known to be silent is asked in time.

use std::{collections::BTreeMap, mem, time::Duration};

use motorlink_bus::Bus;
use motorlink_protocol::{Frame, Instant, MotorId};

use super::said::may_obey;
use crate::rule::{Rule, Violation, broken};

/// A motor is asked at least so often, on every line: five query periods of a busy line.
const ASKED_WITHIN: Duration = Duration::from_secs(1);

/// When each motor was asked last.
#[derive(Debug, Default)]
pub(super) struct Asked {
    at: BTreeMap<MotorId, Instant>,
    /// Until then something else had the line: a scan, a stop, a port that refuses frames, a computer that is away.
    excused_until: Instant,
}

impl Asked {
    /// Something else had the line until now.
    pub(super) fn excused(&mut self, now: Instant) {
        self.excused_until = now;
    }

    /// A frame goes out.
    pub(super) fn sent(&mut self, now: Instant, frame: Frame, bus: &Bus) {
        for status in bus.motors(now).filter(|status| may_obey(&frame, status.id)) {
            self.at.insert(status.id, now);
        }
    }

    /// All events of this moment are out. Returns how many motors were judged.
    pub(super) fn settled(&mut self, now: Instant, bus: &Bus) -> Result<u64, Violation> {
        if bus.job().is_some() || bus.is_stopping() {
            self.excused(now);
        }
        // A motor that is renamed or silent has nothing to wait for. Its time begins when it is there again.
        let before = mem::take(&mut self.at);
        let mut judged = 0;
        for status in bus.motors(now) {
            let known = before.get(&status.id).filter(|_| !status.is_silent());
            let asked = known.copied().unwrap_or(now);
            self.at.insert(status.id, asked);
            if now.since(asked.max(self.excused_until)) > ASKED_WITHIN {
                let what = format!("{} was asked at {asked:?} and not since", status.id);
                return broken(Rule::AskedInTime, now, what).map(|()| judged);
            }
            judged += u64::from(!status.is_silent());
        }
        Ok(judged)
    }
}
