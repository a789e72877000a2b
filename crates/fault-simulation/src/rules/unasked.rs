//! Whether a motor that moves, though nothing here drives it, is said to, and no other is.

use std::collections::{BTreeMap, BTreeSet};

use motorlink_bus::{Activity, Bus, Sample};
use motorlink_protocol::{Frame, Instant, MotorId};

use super::said::may_obey;
use crate::rule::{Rule, Violation, broken};

/// A motor moves that reports this speed or more.
const MOVES_RPM: u16 = 10;
/// Or a greater current than that of a wheel that turns freely: 0.25 A.
const MOVES_RAW: u16 = 1_024;
/// Reports in a row that tell no motion, and end it.
const CALM_REPORTS: u32 = 3;

/// What the motors have reported while nothing drove them.
#[derive(Debug, Default)]
pub(super) struct Unasked {
    /// Reports of each motor since the last one that told motion. A motor has none whose last reports came while it was
    /// driven or stopped, until they do not matter any more.
    calm: BTreeMap<MotorId, u32>,
    /// Motors that nothing drove or stopped at the moment before.
    were_idle: BTreeSet<MotorId>,
    /// Motors that a frame of a person may have moved since their last stop.
    by_hand: BTreeSet<MotorId>,
    /// Reports of this moment. They count when all events of it are out.
    reports: Vec<Sample>,
}

impl Unasked {
    /// A person sends this frame, which may move a wheel.
    pub(super) fn sent_by_hand(&mut self, frame: &Frame, bus: &Bus, now: Instant) {
        let motors = bus.motors(now).map(|status| status.id);
        self.by_hand
            .extend(motors.filter(|id| may_obey(frame, *id)));
        let [first, ..] = *frame.bytes();
        self.by_hand.extend(MotorId::new(first));
    }

    /// The bus reports a sample.
    pub(super) fn reported(&mut self, sample: Sample) {
        self.reports.push(sample);
    }

    /// All events of this moment are out. Returns how many motors were judged that have told motion.
    pub(super) fn settled(&mut self, now: Instant, bus: &Bus) -> Result<u64, Violation> {
        let mut judged = 0;
        let reports = std::mem::take(&mut self.reports);
        let mut idle = BTreeSet::new();
        for status in bus.motors(now) {
            let id = status.id;
            if let Activity::Stopping { .. } = status.activity {
                self.by_hand.remove(&id);
            }
            if status.activity != Activity::Idle || self.by_hand.contains(&id) {
                continue;
            }
            idle.insert(id);
            if !self.were_idle.contains(&id) {
                self.calm.remove(&id);
                continue;
            }
            let own = reports.iter().filter(|sample| sample.reply.id == id);
            for moves in own.filter_map(tells_motion) {
                if moves {
                    self.calm.insert(id, 0);
                    judged += 1;
                } else if let Some(calm) = self.calm.get_mut(&id) {
                    *calm += 1;
                }
            }
            if !status.turns_unasked {
                self.calm.entry(id).or_insert(CALM_REPORTS);
            }
            let calm = self.calm.get(&id).copied();
            if calm.is_some_and(|calm| (calm < CALM_REPORTS) != status.turns_unasked) {
                let what = format!(
                    "{id} is said to turn unasked: {}, and its last report is {:?}",
                    status.turns_unasked, status.last
                );
                return broken(Rule::UnaskedIsSaid, now, what);
            }
        }
        self.calm.retain(|id, _| idle.contains(id));
        self.were_idle = idle;
        Ok(judged)
    }
}

/// Whether a report tells motion; `None` if it tells neither speed nor current.
fn tells_motion(sample: &Sample) -> Option<bool> {
    let speed = sample
        .reply
        .speed
        .map(|speed| speed.magnitude() >= MOVES_RPM);
    let current = sample.reply.current;
    let current = current.map(|current| current.raw().unsigned_abs() > MOVES_RAW);
    match (speed, current) {
        (None, None) => None,
        (speed, current) => Some(speed == Some(true) || current == Some(true)),
    }
}
