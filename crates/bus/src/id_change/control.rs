//! Starts an ID change.

use motorlink_protocol::{AssignableId, Instant, MotorId};

use crate::{
    bus::Bus,
    id_change::{
        outcome::SetIdFrames,
        state::{IdChange, UNANSWERED_PAUSE},
    },
    job::state::Job,
    refusal::Refusal,
    timing::PROOF_LIFETIME,
};

impl Bus {
    pub(crate) fn begin_id_change(
        &mut self,
        now: Instant,
        from: MotorId,
        to: AssignableId,
        frames: SetIdFrames,
    ) -> Result<(), Refusal> {
        self.check_no_job()?;
        if from == to.id() {
            return Err(Refusal::SameId(from));
        }
        self.check_not_halted()?;
        if self.take_proof(now)? != from {
            return Err(Refusal::NotProvedAlone);
        }
        self.stop_for_job(now);
        // The last request may still wait in an adapter that stalls.
        let is_unanswered = self
            .motors
            .iter()
            .any(|motor| motor.unanswered_in_a_row > 0);
        let first_query = if is_unanswered {
            now + UNANSWERED_PAUSE
        } else {
            now
        };
        self.job = Some(Job::IdChange(IdChange::begin(
            first_query,
            from,
            to,
            frames,
        )));
        Ok(())
    }

    /// Takes the proof of the only motor on the bus. A proof is used once.
    pub(crate) fn take_proof(&mut self, now: Instant) -> Result<MotorId, Refusal> {
        let proof = self.proved_alone.take();
        let fresh = proof.filter(|proof| now <= proof.at + PROOF_LIFETIME);
        fresh.map(|proof| proof.id).ok_or(Refusal::NotProvedAlone)
    }
}
