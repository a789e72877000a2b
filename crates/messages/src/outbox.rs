//! Updates to the page: at most one per frame of the screen, 20 a second for samples alone, and none while the page
//! hangs.

use std::time::Duration;

use motorlink_bus::{CommandKind, Event, PAGE_SILENCE_MAX, Sample};
use motorlink_protocol::{Faults, Instant, Mode};

use crate::{Notice, Update};

/// The period of a 60 Hz screen.
const FRAME: Duration = Duration::from_micros(16_600);
/// The page draws the graph 20 times a second, and figures 10 times. Each message costs time on both threads, and
/// the frames of the bus come from this one.
const SAMPLES_EVERY: Duration = Duration::from_millis(50);

/// Samples that wait while the page does not answer: 8 s at 500 Hz. Beyond that the oldest are dropped.
const SAMPLES_MAX: usize = 4096;
/// Notices that wait. They come at the pace of a person, so this is never reached.
const NOTICES_MAX: usize = 256;

/// What the next update contains besides the current state.
#[derive(Debug, Default)]
pub struct Outbox {
    samples: Vec<Sample>,
    notices: Vec<Notice>,
    /// Mode and faults in the last reply. Motors that differ have each reply posted in the next frame.
    last_state: Option<(Mode, Faults)>,
    /// Whether something other than samples has changed.
    changed: bool,
    last_sent: Instant,
    /// When the first ping was sent that has no answer yet.
    unanswered_since: Option<Instant>,
}

impl Outbox {
    /// Takes an event of the bus. The page shows each step of a stop at once. Line events are for the recorder alone.
    pub fn event(&mut self, event: Event, is_stopping: bool) {
        let notice = match event {
            Event::Telemetry(sample) => {
                self.sample(sample);
                self.changed |= is_stopping;
                return;
            }
            Event::PingPage | Event::Line(_) => return,
            Event::IdQueryEnded(outcome) => Notice::IdQueryEnded(outcome),
            Event::ScanEnded(report) => Notice::ScanEnded(report),
            Event::IdChangeEnded { from, to, outcome } => {
                Notice::IdChangeEnded { from, to, outcome }
            }
            Event::ModeSwitched { id, mode } => Notice::ModeSwitched { id, mode },
            Event::ModeSwitchFailed {
                id,
                asked,
                reported,
            } => Notice::ModeSwitchFailed {
                id,
                asked,
                reported,
            },
            Event::NotStarted { id, refusal } => Notice::Refused {
                command: CommandKind::Drive(id),
                refusal,
            },
            Event::Withdrawn { id, reason } => Notice::Withdrawn { id, reason },
            Event::OtherModel { expected, found } => Notice::OtherModel { expected, found },
            Event::SendsText { is_json } => Notice::SendsText { is_json },
            Event::MotorSilent { id, garbled } => Notice::MotorSilent { id, garbled },
            Event::MotorBack(id) => Notice::MotorBack(id),
            Event::StopBegan(reason) => Notice::StopBegan(reason),
            Event::StopEnded(report) => Notice::StopEnded(report),
        };
        self.notice(notice);
    }

    fn sample(&mut self, sample: Sample) {
        let reply = &sample.reply;
        let state = (reply.mode, reply.faults);
        // Another mode or fault does not wait as a reading does.
        self.changed |= self.last_state.replace(state) != Some(state);
        bounded_push(&mut self.samples, sample, SAMPLES_MAX);
    }

    /// Something that a person should know of.
    pub fn notice(&mut self, notice: Notice) {
        bounded_push(&mut self.notices, notice, NOTICES_MAX);
        self.changed = true;
    }

    /// The state has changed.
    pub const fn touch(&mut self) {
        self.changed = true;
    }

    /// The page was pinged.
    pub fn pinged(&mut self, now: Instant) {
        self.unanswered_since.get_or_insert(now);
        // On a dead line no reply changes anything, but the counters change.
        self.changed = true;
    }

    /// The page has answered a ping.
    pub const fn page_answered(&mut self) {
        self.unanswered_since = None;
    }

    /// When the next update is due; `None` while nothing has changed or the page hangs.
    #[must_use]
    pub fn due(&self, now: Instant) -> Option<Instant> {
        let hangs = self
            .unanswered_since
            .is_some_and(|since| now > since + PAGE_SILENCE_MAX);
        if hangs {
            None
        } else if self.changed {
            Some(self.last_sent + FRAME)
        } else {
            let waiting = !self.samples.is_empty();
            waiting.then(|| self.last_sent + SAMPLES_EVERY)
        }
    }

    /// Moves what has happened into the update, which is sent now and has the current state.
    pub fn fill(&mut self, update: &mut Update) {
        update.samples = std::mem::take(&mut self.samples);
        update.notices = std::mem::take(&mut self.notices);
        self.changed = false;
        self.last_sent = update.now;
    }
}

fn bounded_push<T>(items: &mut Vec<T>, item: T, most: usize) {
    if items.len() == most {
        items.remove(0);
    }
    items.push(item);
}
