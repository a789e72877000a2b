//! Starts the ID query and the full scan.

use motorlink_protocol::{Instant, MotorId};

use crate::{bus::Bus, job::state::Job, refusal::Refusal, scan::state::Scan};

impl Bus {
    pub(crate) fn begin_id_query(&mut self, now: Instant) -> Result<(), Refusal> {
        if self.job.is_some() {
            return Err(Refusal::JobRunning);
        }
        self.stop_for_job(now);
        self.id_query_wanted = true;
        Ok(())
    }

    pub(crate) fn begin_scan(&mut self, now: Instant) -> Result<(), Refusal> {
        self.check_not_stopping_first()?;
        self.check_no_job()?;
        self.stop_for_job(now);
        self.proved_alone = None;
        let heard = self.motors.iter().filter(|motor| motor.has_answered());
        let known: Vec<MotorId> = heard.map(|motor| motor.id).collect();
        // Earlier losses may come from a motor without power. Exchanges without any loss prove a
        // good line.
        let histories = self.motors.iter().map(|motor| motor.loss.known());
        let clean_exchanges = histories
            .filter(|(_, lost)| *lost == 0)
            .map(|(seen, _)| seen)
            .sum();
        let scan = Scan::begin(now, &known, self.round_trip.clone(), clean_exchanges);
        self.job = Some(Job::Scan(Box::new(scan)));
        Ok(())
    }
}
