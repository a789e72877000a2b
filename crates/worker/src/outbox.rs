//! Updates to the page: at most one per frame of the screen, 20 a second for samples alone, and none while the page
//! hangs.

use std::time::Duration;

use motorlink_bus::{JobStatus, LineStatus, MotorStatus, PAGE_SILENCE_MAX, RawStatus, Sample};
use motorlink_messages::{Connection, Notice, ToPage, Update};
use motorlink_protocol::{Faults, Instant, Mode};

use crate::scope::{post, posted};

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
pub(crate) struct Outbox {
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

/// The current state. Every update contains all of it.
pub(crate) struct CurrentState {
    pub(crate) connection: Connection,
    pub(crate) halted: bool,
    pub(crate) motors: Vec<MotorStatus>,
    pub(crate) job: Option<JobStatus>,
    pub(crate) raw: Option<RawStatus>,
    pub(crate) line: Option<LineStatus>,
}

impl Outbox {
    pub(crate) fn sample(&mut self, sample: Sample) {
        let reply = &sample.reply;
        let state = (reply.mode, reply.faults);
        // Another mode or fault does not wait as a reading does.
        self.changed |= self.last_state.replace(state) != Some(state);
        bounded_push(&mut self.samples, sample, SAMPLES_MAX);
    }

    pub(crate) fn notice(&mut self, notice: Notice) {
        bounded_push(&mut self.notices, notice, NOTICES_MAX);
        self.changed = true;
    }

    pub(crate) fn touch(&mut self) {
        self.changed = true;
    }

    pub(crate) fn ping(&mut self, now: Instant) {
        self.unanswered_since.get_or_insert(now);
        post(&ToPage::Ping);
        // On a dead line no reply changes anything, but the counters change.
        self.changed = true;
    }

    pub(crate) fn page_answered(&mut self) {
        self.unanswered_since = None;
    }

    /// When the next update is due; `None` while nothing has changed or the page hangs.
    pub(crate) fn due(&self, now: Instant) -> Option<Instant> {
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

    /// Posts an update. Returns its bytes, for the recorder.
    pub(crate) fn send(&mut self, now: Instant, current: CurrentState) -> Vec<u8> {
        let CurrentState {
            connection,
            halted,
            motors,
            job,
            raw,
            line,
        } = current;
        let message = posted(&ToPage::Update(Update {
            now,
            connection,
            halted,
            motors,
            job,
            raw,
            line,
            samples: std::mem::take(&mut self.samples),
            notices: std::mem::take(&mut self.notices),
        }));
        self.changed = false;
        self.last_sent = now;
        message
    }
}

fn bounded_push<T>(items: &mut Vec<T>, item: T, most: usize) {
    if items.len() == most {
        items.remove(0);
    }
    items.push(item);
}
