//! Starts an ID change.

use motorlink_protocol::{AssignableId, Instant, MotorId};

use crate::{
    bus::Bus, id_change::outcome::SetIdFrames, id_change::state::IdChange, job::state::Job,
    refusal::Refusal, timing::PROOF_LIFETIME,
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
        self.job = Some(Job::IdChange(IdChange::begin(now, from, to, frames)));
        Ok(())
    }

    /// Takes the proof of the only motor on the bus. A proof is used once.
    pub(crate) fn take_proof(&mut self, now: Instant) -> Result<MotorId, Refusal> {
        let proof = self.proved_alone.take();
        let fresh = proof.filter(|proof| now <= proof.at + PROOF_LIFETIME);
        fresh.map(|proof| proof.id).ok_or(Refusal::NotProvedAlone)
    }
}
