//! Repeats the ID query while no motor has answered: a motor may get its power after the port was opened.

use std::time::Duration;

use motorlink_bus::{Bus, Command, IdQueryOutcome, Refusal};
use motorlink_protocol::Instant;

/// The first pause, which doubles.
const PAUSE: Duration = Duration::from_secs(1);
/// The longest pause: a person who has just switched the supply on waits for it.
const PAUSE_MAX: Duration = Duration::from_secs(4);

/// When it is repeated next.
#[derive(Debug, Default)]
pub(crate) struct AsksAgain {
    at: Option<Instant>,
    pause: Option<Duration>,
}

impl AsksAgain {
    /// The ID query has ended so. Returns whether to tell the page: it may know already that nothing answers.
    pub(crate) fn ended(&mut self, now: Instant, outcome: IdQueryOutcome) -> bool {
        if outcome != IdQueryOutcome::NoReply {
            *self = Self::default();
            return true;
        }
        let is_first = self.pause.is_none();
        let pause = self.pause.map_or(PAUSE, |pause| (pause * 2).min(PAUSE_MAX));
        self.pause = Some(pause);
        self.at = Some(now + pause);
        is_first
    }

    /// Asks if it is time, and no motor has answered meanwhile. Returns when to call it again.
    pub(crate) fn turn(&mut self, now: Instant, bus: &mut Bus) -> Option<Instant> {
        let at = self.at?;
        if now < at {
            return Some(at);
        }
        if bus.hears_text(now) {
            // No motor sends text: the device is left alone.
            self.at = Some(now + PAUSE_MAX);
            return self.at;
        }
        self.at = None;
        if bus.motors(now).any(|motor| motor.last.is_some()) {
            *self = Self::default();
            return None;
        }
        // Refused while a job or a raw frame has the line: then it is asked later.
        let asked: Result<(), Refusal> = bus.command(now, Command::IdQuery);
        self.at = asked.is_err().then(|| now + PAUSE_MAX);
        self.at
    }
}
