//! How an ID query and a full scan begin.

use motorlink_protocol::{Instant, MotorId};

use crate::{bus::Bus, command::Refusal, job::state::Survey, scan::state::Scan};

impl Bus {
    pub(crate) fn begin_id_query(&mut self, now: Instant) -> Result<(), Refusal> {
        if self.survey.is_some() {
            return Err(Refusal::Surveying);
        }
        self.make_way(now);
        self.id_query_wanted = true;
        Ok(())
    }

    pub(crate) fn begin_scan(&mut self, now: Instant) -> Result<(), Refusal> {
        self.check_no_survey()?;
        self.make_way(now);
        self.proved_alone = None;
        let heard = self.motors.iter().filter(|motor| motor.ever_heard());
        let known: Vec<MotorId> = heard.map(|motor| motor.id).collect();
        // What was lost before may have been a motor without power; what was not is good news.
        let histories = self.motors.iter().map(|motor| motor.loss.known());
        let clean_exchanges = histories
            .filter(|(_, lost)| *lost == 0)
            .map(|(seen, _)| seen)
            .sum();
        let scan = Scan::begin(now, &known, self.round_trip.clone(), clean_exchanges);
        self.survey = Some(Survey::Scan(Box::new(scan)));
        Ok(())
    }
}
