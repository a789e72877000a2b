//! The faults of every motor over the whole session.

use motorlink_bus::Sample;
use motorlink_messages::{Update, sessions::FaultChange};
use motorlink_protocol::{Faults, Instant, MotorId};

use crate::record::SILENT_AFTER;

/// Changes that are kept: the newest. A replay shows 20 faults of each motor.
pub(super) const CHANGES_MAX: usize = 4_096;

/// Every change of the faults that motors report.
///
/// The page takes the replies that the bus took. Those are in the states of a file; without states, frames tell them.
#[derive(Clone, Debug, Default)]
pub(super) struct FaultChanges {
    changes: Vec<FaultChange>,
    /// What each motor reported last, and when. It is not stored.
    last: Vec<(MotorId, Instant, Faults)>,
    has_states: bool,
}

impl FaultChanges {
    pub(super) fn stored(changes: Vec<FaultChange>) -> Self {
        Self {
            changes,
            ..Self::default()
        }
    }

    pub(super) fn all(&self) -> &[FaultChange] {
        &self.changes
    }

    /// Takes a reply that a frame tells.
    pub(super) fn frame(&mut self, sample: &Sample) {
        if !self.has_states {
            self.replied(sample);
        }
    }

    /// Takes a request without a reply.
    pub(super) fn silence(&mut self, at: Instant, id: MotorId) {
        let known = self.last.iter().find(|(of, ..)| *of == id);
        if !self.has_states && known.is_some_and(|(_, last, _)| at.since(*last) >= SILENT_AFTER) {
            self.note(at, id, None);
        }
    }

    /// No record comes from this time on. Without states the last replies hold.
    pub(super) fn gap(&mut self, at: Instant) {
        if self.has_states {
            self.end_all(at);
        }
    }

    /// Takes what the page showed.
    pub(super) fn state(&mut self, update: &Update) {
        self.has_states = true;
        for sample in &update.samples {
            self.replied(sample);
        }
        for motor in update.motors.iter().filter(|motor| motor.is_silent()) {
            self.note(update.now, motor.id, None);
        }
        if update.motors.is_empty() {
            self.end_all(update.now);
        }
    }

    /// No motor answers any more.
    pub(super) fn end_all(&mut self, at: Instant) {
        for place in 0..self.last.len() {
            if let Some((id, ..)) = self.last.get(place) {
                self.note(at, *id, None);
            }
        }
    }

    fn replied(&mut self, Sample { at, reply }: &Sample) {
        self.note(*at, reply.id, Some(reply.faults));
    }

    fn note(&mut self, at: Instant, id: MotorId, faults: Option<Faults>) {
        let known = self.last.iter_mut().find(|(of, ..)| *of == id);
        let now = faults.unwrap_or(Faults::NONE);
        let before = match known {
            // The first state has replies that frames have told already.
            Some((_, last, _)) if at < *last => return,
            Some((_, last, before)) => {
                *last = at;
                std::mem::replace(before, now)
            }
            None => {
                self.last.push((id, at, now));
                Faults::NONE
            }
        };
        if before == now || before.is_none() && now.is_none() {
            return;
        }
        if self.changes.len() == CHANGES_MAX {
            self.changes.remove(0);
        }
        self.changes.push(FaultChange { at, id, faults });
    }
}
