//! What a bus knows of the port that was just opened.

use motorlink_protocol::{Instant, MotorId};

use crate::{
    bus::Bus,
    command::Command,
    refusal::Refusal,
    settings::BusSettings,
    timing::{FRESH_FOR, LISTEN_BEFORE_ENABLE},
};

impl Bus {
    /// A bus that starts halted, as after Stop all motors: nothing drives until Release.
    #[must_use]
    pub fn halted(now: Instant) -> Self {
        Self::new(now).into_halted()
    }

    /// This bus, halted.
    #[must_use]
    pub fn into_halted(self) -> Self {
        Self {
            halted: true,
            ..self
        }
    }

    /// Expects late replies to requests from before this bus: the adapter may still hold them. They are not read in the
    /// layout of a new request.
    #[must_use]
    pub fn after_another(mut self, now: Instant) -> Self {
        // Separate frames say which request they answer.
        if !self.model.has_separate_frames() {
            self.old_replies_until = Some(now + FRESH_FOR);
            for motor in &mut self.motors {
                motor.unknown_frame_unanswered(now);
            }
        }
        self
    }

    /// Applies these settings and watches these motors. If `asks_for_id`, the first request is the ID query, to which all
    /// motors of the line reply.
    #[must_use]
    pub fn prepared(
        mut self,
        now: Instant,
        settings: BusSettings,
        asks_for_id: bool,
        motors: impl IntoIterator<Item = MotorId>,
    ) -> Self {
        let id_query = asks_for_id.then_some(Command::IdQuery);
        let first = [Command::Configure(settings)].into_iter().chain(id_query);
        for command in first.chain(motors.into_iter().map(Command::Watch)) {
            // None of them is refused while nothing drives.
            let _: Result<(), Refusal> = self.command(now, command);
        }
        self
    }

    /// Puts the bus on trial until [`Bus::end_trial`]. The bus then enables no motor: the port may be the wrong one,
    /// and another host may drive its motors. In the velocity loop they would read that host's angles as speeds.
    #[must_use]
    pub fn on_trial(self) -> Self {
        Self {
            enables_from: None,
            ..self
        }
    }

    /// Ends the trial: the port is the wanted one.
    pub fn end_trial(&mut self, now: Instant) {
        self.enables_from.get_or_insert(now + LISTEN_BEFORE_ENABLE);
        // Text heard during the trial was not reported to the user.
        self.text.report_again();
    }
}
