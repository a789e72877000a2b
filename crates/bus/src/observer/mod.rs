//! The state of a line by its line events alone: for recordings.
//!
//! | file | what it holds |
//! |---|---|
//! | `requests` | frames that were sent |
//! | `answers` | replies, lost replies, invalid bytes |
//! | `passing` | what time alone changes |

mod answers;
mod passing;
mod requests;

use motorlink_protocol::{Instant, MotorId, family::Model};

use crate::{
    bus::{Bus, LastDrive},
    event::Event,
    line_event::{LineEvent, LineEventKind},
    line_use::LineStatus,
    motor_status::{Activity, MotorStatus},
    sample::Sample,
};

/// Follows a line by its events and reports the same status as the bus that made them.
///
/// It contains a bus that is never polled, so it sends nothing. What no event records stays unknown: limits, settings,
/// echoes, the goal behind a ramp, and commands that have not sent a frame.
///
/// ```
/// use motorlink_bus::{Activity, LineEvent, LineEventKind, Observer};
/// use motorlink_protocol::{Instant, Mode, MotorId, Request, Setpoint, SpeedTarget, family::Model};
///
/// let setpoint = Setpoint::velocity(SpeedTarget::new(100)?);
/// let frame = Request::drive(MotorId::FIRST, setpoint).frame();
/// let kind = LineEventKind::Sent { frame, mode: Some(Mode::Velocity) };
/// let mut observer = Observer::new(Instant::ZERO, Model::Ddsm115);
/// observer.add_event(&LineEvent { at: Instant::from_millis(20), kind }, &mut Vec::new());
/// let motor = observer.motors(Instant::from_millis(21)).next();
/// assert_eq!(motor.map(|motor| motor.activity), Some(Activity::Driven { setpoint }));
/// # Ok::<(), motorlink_protocol::OutOfRange>(())
/// ```
#[derive(Debug)]
pub struct Observer {
    bus: Bus,
    /// One per motor of the bus.
    heard: Vec<Heard>,
    /// Whether any request was recorded. A recording of replies alone has none.
    has_requests: bool,
    /// Invalid bytes of the exchange in flight: when, and how many. What follows tells whether it was answered.
    junk: Option<(Instant, usize)>,
    /// Invalid bytes of the exchange in flight that were followed by a late reply.
    junk_before: usize,
}

/// When a motor last got frames.
#[derive(Clone, Debug)]
struct Heard {
    id: MotorId,
    /// Any frame, or the last reading if no requests were recorded.
    asked: Instant,
    drove: Instant,
    /// The last drive frames, if they brake: when a stop is known to have begun, they belong to it.
    brakes: Vec<Instant>,
    /// Whether it was enabled for a mode switch: the loop follows.
    is_enabled: bool,
}

impl Observer {
    /// A line of this model without motors.
    #[must_use]
    pub fn new(now: Instant, model: Model) -> Self {
        let mut bus = Bus::with_model(now, model);
        bus.events.clear();
        Self {
            bus,
            heard: Vec::new(),
            has_requests: false,
            junk: None,
            junk_before: 0,
        }
    }

    /// Takes the next event. Adds the replies that it makes to `samples`. Times must not decrease.
    pub fn add_event(&mut self, event: &LineEvent, samples: &mut Vec<Sample>) {
        let at = event.at;
        let junk = self.junk.take();
        self.judge_junk(junk, event);
        self.advance(at);
        match event.kind {
            LineEventKind::Sent { frame, mode }
            | LineEventKind::SentByHand { frame, mode }
            | LineEventKind::RepeatedByHand { frame, mode } => self.sent(at, frame, mode),
            LineEventKind::NotSent { frame } => self.not_sent(at, frame),
            LineEventKind::Known { id, mode, value } => self.known(at, id, mode, value),
            LineEventKind::Received { frame, asked } => self.received(at, frame, asked),
            LineEventKind::Junk(junk) => self.junk_received(at, junk.bytes().len()),
            LineEventKind::Silence { id, waited_us } => self.silence(at, id, waited_us),
            LineEventKind::ModelSelected(model) => *self = Self::new(at, model),
        }
        if !matches!(
            event.kind,
            LineEventKind::Sent { .. } | LineEventKind::Silence { .. }
        ) {
            self.bus.last_drive = LastDrive::Carried;
        }
        let told = self.bus.events.drain(..).filter_map(|event| match event {
            Event::Telemetry(sample) => Some(sample),
            _ => None,
        });
        samples.extend(told);
    }

    /// Status of every motor that was sent a frame or has answered. `now` must not be before the last event.
    pub fn motors(&mut self, now: Instant) -> impl Iterator<Item = MotorStatus> {
        self.pass_to(now);
        self.bus.motors(now)
    }

    /// What every motor does, after the last event.
    pub fn activities(&self) -> impl Iterator<Item = (MotorId, Activity)> {
        self.bus.activities()
    }

    /// How the line is used. [`LineStatus::carries_hz`] is unknown, and `late_hz` has the late replies only.
    pub fn line_status(&mut self, now: Instant) -> LineStatus {
        self.pass_to(now);
        LineStatus {
            carries_hz: None,
            ..self.bus.line_status(now)
        }
    }

    /// The state of a motor, created if it is new.
    fn hear(&mut self, at: Instant, id: MotorId) -> &mut Heard {
        let known = self.heard.iter().position(|heard| heard.id == id);
        let place = known.unwrap_or_else(|| {
            self.bus.watch(at, id);
            self.heard.push(Heard {
                id,
                asked: at,
                drove: at,
                brakes: Vec::new(),
                is_enabled: false,
            });
            self.heard.len() - 1
        });
        #[allow(
            clippy::indexing_slicing,
            reason = "the place was found or made just above"
        )]
        let heard = &mut self.heard[place];
        heard.asked = at;
        heard
    }

    fn knows(&self, id: MotorId) -> bool {
        self.heard.iter().any(|heard| heard.id == id)
    }
}
