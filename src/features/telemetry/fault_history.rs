//! The history of faults, kept until the user marks them as seen.

use motorlink_i18n::{terms, tr};
use motorlink_messages::{
    protocol::{Fault, Faults, MotorId},
    sessions::FaultChange,
};

/// One occurrence of a fault. Times are milliseconds of the wall clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Occurrence {
    /// Its bit in the fault byte.
    bit: u8,
    /// What the bit means, if it has a name.
    fault: Option<Fault>,
    pub(crate) came_ms: f64,
    pub(crate) end: End,
    /// Whether the user has marked it as seen.
    seen: bool,
}

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum End {
    /// It is still active.
    Active,
    /// A reply at this time no longer reported it.
    Gone(f64),
    /// Unknown: the motor stopped answering.
    Unknown,
}

/// The faults of every motor, from every single reply, also those that last for a single reply.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct FaultHistory {
    /// Motors that have reported a fault.
    motors: Vec<Record>,
}

#[derive(Clone, Debug, PartialEq)]
struct Record {
    id: MotorId,
    /// Oldest first.
    kept: Vec<Occurrence>,
    /// Number of dropped older ones.
    dropped: usize,
}

impl Occurrence {
    /// `stall`, or `bit 0x20` for a fault without a name.
    pub(crate) fn name(&self) -> String {
        self.fault.map_or_else(
            || tr!("bit {byte}", byte = format!("0x{:02X}", self.bit)),
            |fault| terms::fault(fault).to_owned(),
        )
    }
}

impl FaultHistory {
    /// Maximal occurrences per motor. A stalled wheel that is started repeatedly reaches it in minutes, with the
    /// same fault each time.
    pub(crate) const KEPT_MAX: usize = 20;

    /// Records the faults that a motor reports. Returns whether any began or ended.
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

    /// Records a change in a recording.
    pub(crate) fn on_change(&mut self, change: &FaultChange, at_ms: f64) {
        match change.faults {
            Some(faults) => self.on_report(change.id, faults, at_ms),
            None => self.end_unknown(Some(change.id)),
        };
    }

    /// Ends the active faults of a motor that stopped answering, or of every motor with `None`: whether they are
    /// still active is unknown. Returns whether anything changed.
    pub(crate) fn end_unknown(&mut self, id: Option<MotorId>) -> bool {
        let mut changed = false;
        for record in &mut self.motors {
            if id.is_none_or(|id| id == record.id) {
                changed |= record.end(0xFF, End::Unknown);
            }
        }
        changed
    }

    /// Marks all as seen: ended faults are removed, active ones when they end. Returns whether anything changed.
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

    /// The occurrences of one motor: active ones first, then the newest.
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

    /// Number of its dropped occurrences.
    pub(crate) fn dropped(&self, id: MotorId) -> usize {
        self.record(id).map_or(0, |record| record.dropped)
    }

    /// Whether any occurrence is not marked as seen.
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
                    fault: faults.iter().find(|fault| fault.mask() == bit),
                    came_ms: at_ms,
                    end: End::Active,
                    seen: false,
                });
            }
        }
        // Eight bits give at most eight active ones, so others have ended.
        while self.kept.len() > FaultHistory::KEPT_MAX {
            let ended = self.kept.iter().position(|kept| kept.end != End::Active);
            self.kept.remove(ended.unwrap_or(0));
            self.dropped += 1;
        }
        changed
    }

    /// Ends the active ones among these bits. Returns whether there were any.
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
