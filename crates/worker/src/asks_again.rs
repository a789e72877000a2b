//! Repeats the ID query while no motor has answered: a motor may get its power after the port was opened.

use std::{mem, time::Duration};

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
    /// Whether the query of the opened port has ended. The person asked those that follow.
    opened: bool,
}

impl AsksAgain {
    /// The ID query has ended so. Returns whether to tell the page: it may know already that nothing answers, and
    /// nobody asked the query that the first stop of a port cancels.
    pub(crate) fn ended(&mut self, now: Instant, outcome: IdQueryOutcome) -> bool {
        let is_of_opening = !mem::replace(&mut self.opened, true);
        if outcome == IdQueryOutcome::Cancelled && is_of_opening {
            self.at = Some(now + PAUSE);
            return false;
        }
        if outcome != IdQueryOutcome::NoReply {
            self.end();
            return true;
        }
        let is_first = self.pause.is_none();
        let pause = self.pause.map_or(PAUSE, |pause| (pause * 2).min(PAUSE_MAX));
        self.pause = Some(pause);
        self.at = Some(now + pause);
        is_first
    }

    /// A motor has answered, or another query has ended.
    fn end(&mut self) {
        *self = Self {
            opened: true,
            ..Self::default()
        };
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
            self.end();
            return None;
        }
        // Refused while a job or a raw frame has the line: then it is asked later.
        let asked: Result<(), Refusal> = bus.command(now, Command::IdQuery);
        self.at = asked.is_err().then(|| now + PAUSE_MAX);
        self.at
    }
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::MotorId;
    use wasm_bindgen_test::wasm_bindgen_test;

    use super::*;

    #[wasm_bindgen_test]
    fn a_query_that_the_first_stop_of_a_port_cancels_is_not_told_but_asked_again() {
        let now = Instant::ZERO;
        let mut asks_again = AsksAgain::default();
        assert!(!asks_again.ended(now, IdQueryOutcome::Cancelled));
        let mut bus = Bus::new(now);
        assert_eq!(asks_again.turn(now, &mut bus), Some(now + PAUSE));
        assert!(asks_again.turn(now + PAUSE, &mut bus).is_none());
        assert!(asks_again.ended(now, IdQueryOutcome::One(MotorId::FIRST)));
        assert!(
            asks_again.ended(now, IdQueryOutcome::Cancelled),
            "asked by the person"
        );
    }
}
