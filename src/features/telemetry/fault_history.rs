//! Which faults came and went, and when: kept until a person has seen them.

use motorlink_i18n::{terms, tr};
use motorlink_messages::protocol::{Fault, Faults, MotorId};

/// One time that a fault was there. Times are milliseconds of the wall clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Occurrence {
    /// Its bit in the fault byte.
    bit: u8,
    pub(crate) came_ms: f64,
    pub(crate) end: End,
    /// Whether a person has seen it come.
    seen: bool,
}

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum End {
    /// It has not.
    Active,
    /// At this time a reply came without it.
    Gone(f64),
    /// The motor fell silent.
    Unknown,
}

/// The faults of every motor, from every single reply: a fault that is there for one reply between
/// two frames of the screen is kept too.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct FaultHistory {
    /// Those that ever reported a fault.
    motors: Vec<Record>,
}

#[derive(Clone, Debug, PartialEq)]
struct Record {
    id: MotorId,
    /// Oldest first.
    kept: Vec<Occurrence>,
    /// How many gave way to newer ones.
    dropped: usize,
}

impl Occurrence {
    /// `stall`, or `bit 0x20` for one that has no name.
    pub(crate) fn name(&self) -> String {
        Fault::ALL
            .into_iter()
            .find(|fault| fault.mask() == self.bit)
            .map_or_else(
                || tr!("bit {byte}", byte = format!("0x{:02X}", self.bit)),
                |fault| terms::fault(fault).to_owned(),
            )
    }
}

impl FaultHistory {
    /// Of each motor. A stalled wheel that is started again and again fills it in minutes, and says
    /// the same with every line.
    pub(crate) const KEPT_MAX: usize = 20;

    /// Records the faults that a motor reports. Returns whether any came or went.
    pub(crate) fn on_report(&mut self, id: MotorId, faults: Faults, at_ms: f64) -> bool {
        if let Some(record) = self.motors.iter_mut().find(|record| record.id == id) {
            return record.update(faults, at_ms);
        }
        if faults.is_none() {
            return false;
        }
        let mut record = Record {
            id,
            kept: Vec::new(),
            dropped: 0,
        };
        record.update(faults, at_ms);
        self.motors.push(record);
        true
    }

    /// Ends the active faults of a motor that has fallen silent, or with `None` of every motor: whether
    /// they are still there is unknown. Returns whether anything changed.
    pub(crate) fn end_unknown(&mut self, id: Option<MotorId>) -> bool {
        let mut changed = false;
        for record in &mut self.motors {
            if id.is_none_or(|id| id == record.id) {
                changed |= record.end(0xFF, End::Unknown);
            }
        }
        changed
    }

    /// A person has seen them: what has ended is forgotten, and what has not when it ends. Whether
    /// that changed anything.
    pub(crate) fn mark_seen(&mut self, id: MotorId) -> bool {
        let Some(record) = self.motors.iter_mut().find(|record| record.id == id) else {
            return false;
        };
        let changed = record.kept.iter().any(|occurrence| !occurrence.seen);
        record
            .kept
            .retain(|occurrence| occurrence.end == End::Active);
        for occurrence in &mut record.kept {
            occurrence.seen = true;
        }
        record.dropped = 0;
        changed
    }

    /// What one motor reported: what is still there first, then the newest.
    pub(crate) fn of(&self, id: MotorId) -> Vec<Occurrence> {
        let newest_first = || {
            let kept = self.record(id).map(|record| record.kept.iter().rev());
            kept.into_iter().flatten().copied()
        };
        let there = |occurrence: &Occurrence| occurrence.end == End::Active;
        newest_first()
            .filter(there)
            .chain(newest_first().filter(|occurrence| !there(occurrence)))
            .collect()
    }

    /// How many of its occurrences gave way.
    pub(crate) fn dropped(&self, id: MotorId) -> usize {
        self.record(id).map_or(0, |record| record.dropped)
    }

    /// Whether there is anything that no person has marked as seen.
    pub(crate) fn has_unseen(&self, id: MotorId) -> bool {
        self.record(id)
            .is_some_and(|record| record.kept.iter().any(|occurrence| !occurrence.seen))
    }

    fn record(&self, id: MotorId) -> Option<&Record> {
        self.motors.iter().find(|record| record.id == id)
    }
}

impl Record {
    fn update(&mut self, faults: Faults, at_ms: f64) -> bool {
        let byte = faults.byte();
        let mut changed = self.end(!byte, End::Gone(at_ms));
        for bit in (0..8).map(|place| 1 << place).filter(|bit| byte & bit != 0) {
            let known = |kept: &Occurrence| kept.bit == bit && kept.end == End::Active;
            if !self.kept.iter().any(known) {
                changed = true;
                self.kept.push(Occurrence {
                    bit,
                    came_ms: at_ms,
                    end: End::Active,
                    seen: false,
                });
            }
        }
        // Eight bits are eight active ones at most, so there are some that have ended.
        while self.kept.len() > FaultHistory::KEPT_MAX {
            let ended = self.kept.iter().position(|kept| kept.end != End::Active);
            self.kept.remove(ended.unwrap_or(0));
            self.dropped += 1;
        }
        changed
    }

    /// Ends the active ones among these bits. Whether there were any.
    fn end(&mut self, bits: u8, end: End) -> bool {
        let mut ended = false;
        for kept in &mut self.kept {
            if kept.end == End::Active && kept.bit & bits != 0 {
                kept.end = end;
                ended = true;
            }
        }
        self.kept
            .retain(|kept| !(kept.seen && kept.end != End::Active));
        ended
    }
}

#[cfg(test)]
#[path = "fault_history_tests.rs"]
mod tests;
