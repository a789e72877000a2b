//! What motors report, by the recorded events of their line alone.

use motorlink_protocol::{
    Frame, Instant, Layout, Mode, MotorId,
    family::{Current, Model, Reading, Request},
};

use crate::{
    line_event::{LineEvent, LineEventKind},
    model::separate::Separate,
    sample::Sample,
    timing::{DRIVEN_SILENCE_MAX, DRIVEN_UNANSWERED_MAX},
};

/// Reads the samples of a line from its events, as its bus did.
///
/// A reply in separate frames does not name the loop of its motor, and an odometry reply has no speed of its own. Both
/// follow from the events before it.
///
/// ```
/// use motorlink_bus::{LineEvent, LineEventKind, LineSamples};
/// use motorlink_protocol::{Instant, Rpm, family::Model};
///
/// let mut samples = LineSamples::of(Model::Ddsm210);
/// let mut read = |text: &str| {
///     let (at, frame, asked) = (Instant::ZERO, text.parse().unwrap(), None);
///     samples.add_event(&LineEvent { at, kind: LineEventKind::Received { frame, asked } })
/// };
/// // Before the motor has named its loop, its frames do not tell a speed.
/// assert_eq!(read("01 64 01 F4 00 00 00 1F 00 37"), None);
/// assert_eq!(read("01 75 02 00 00 00 00 00 00 3D"), None);
/// let sample = read("01 64 01 F4 00 00 00 1F 00 37").unwrap();
/// assert_eq!(sample.reply.speed, Some(Rpm::new(50)));
/// ```
#[derive(Clone, Debug, Default)]
pub struct LineSamples {
    model: Model,
    /// The motor that was asked last, and when, until it answers.
    asked: Option<(MotorId, Instant)>,
    /// Whether any request was recorded. A recording of replies alone has none.
    has_requests: bool,
    /// Those with separate frames.
    motors: Vec<Motor>,
}

#[derive(Clone, Copy, Debug)]
struct Motor {
    id: MotorId,
    separate: Separate,
    heard: Instant,
    /// Requests in a row without an answer.
    unanswered: u32,
}

impl LineSamples {
    /// A line of this model.
    #[must_use]
    pub const fn of(model: Model) -> Self {
        Self {
            model,
            asked: None,
            has_requests: false,
            motors: Vec::new(),
        }
    }

    /// The model of the line.
    #[must_use]
    pub const fn model(&self) -> Model {
        self.model
    }

    /// Takes the next event. Returns the sample of a reply.
    pub fn add_event(&mut self, event: &LineEvent) -> Option<Sample> {
        match event.kind {
            LineEventKind::Received { frame, asked } => self.received(event.at, &frame, asked),
            LineEventKind::Sent { frame, mode }
            | LineEventKind::SentByHand { frame, mode }
            | LineEventKind::RepeatedByHand { frame, mode } => {
                self.sent(event.at, &frame, mode);
                None
            }
            LineEventKind::Silence { id, .. } => {
                self.silence(event.at, id);
                None
            }
            LineEventKind::ModelSelected(model) => {
                *self = Self::of(model);
                None
            }
            LineEventKind::Known { id, mode, .. } => {
                self.reads_in(event.at, id, mode);
                None
            }
            LineEventKind::Junk(_) | LineEventKind::NotSent { .. } => None,
        }
    }

    /// Reads a frame that was kept alone, with the model and the loop in which it was read.
    pub fn read(
        &mut self,
        at: Instant,
        (model, mode): (Model, Mode),
        frame: &Frame,
        asked: Option<Layout>,
    ) -> Option<Sample> {
        if self.model != model {
            *self = Self::of(model);
        }
        let [address, ..] = *frame.bytes();
        if let Ok(id) = MotorId::new(address) {
            self.reads_in(at, id, mode);
        }
        self.received(at, frame, asked)
    }

    fn received(&mut self, at: Instant, frame: &Frame, asked: Option<Layout>) -> Option<Sample> {
        let reading = Reading::decode(self.model, frame, asked.map(Into::into)).ok()?;
        let id = reading.id();
        let asked = self.asked.take_if(|(asked, _)| *asked == id);
        let has_requests = self.has_requests;
        let reply = if let Reading::Combined(reply) = reading {
            reply
        } else {
            let model = self.model;
            let motor = self.motor(at, id);
            let unanswered = std::mem::take(&mut motor.unanswered);
            motor.heard = at;
            // Otherwise it may answer an earlier request.
            let sent = asked.filter(|_| unanswered == 0).map(|(_, sent)| sent);
            let measured = if has_requests { sent } else { Some(at) };
            motor.separate.record(at, measured, model, &reading)?
        };
        Some(Sample { at, reply })
    }

    fn sent(&mut self, at: Instant, frame: &Frame, mode: Option<Mode>) {
        let request = Request::parse(self.model, frame).ok();
        let addressee = request.and_then(|request| request.addressee());
        self.asked = addressee.map(|id| (id, at));
        self.has_requests = true;
        // What a motor has named itself goes before: at a stop the bus is ahead of it.
        if let (Some(Request::Drive { id, .. }), Some(mode)) = (request, mode)
            && self.model.has_separate_frames()
            && self.motor(at, id).separate.loop_known.last().is_none()
        {
            self.reads_in(at, id, mode);
        }
    }

    /// The motor is in this loop.
    fn reads_in(&mut self, at: Instant, id: MotorId, mode: Mode) {
        if self.model.has_separate_frames() {
            let known = &mut self.motor(at, id).separate.loop_known;
            if known.last() != Some(mode) {
                known.reported(at, mode);
            }
        }
    }

    /// A motor that may have lost its power may be in another loop afterwards.
    fn silence(&mut self, at: Instant, id: MotorId) {
        self.asked = None;
        if self.model.has_separate_frames() {
            let motor = self.motor(at, id);
            motor.unanswered = motor.unanswered.saturating_add(1);
            let may_be_off = motor.unanswered >= DRIVEN_UNANSWERED_MAX
                && at.since(motor.heard) >= DRIVEN_SILENCE_MAX;
            motor.separate.unanswered(may_be_off);
        }
    }

    fn motor(&mut self, at: Instant, id: MotorId) -> &mut Motor {
        let known = self.motors.iter().position(|motor| motor.id == id);
        let place = known.unwrap_or_else(|| {
            self.motors.push(Motor {
                id,
                separate: Separate::default(),
                heard: at,
                unanswered: 0,
            });
            self.motors.len() - 1
        });
        #[allow(
            clippy::indexing_slicing,
            reason = "the place was found or made just above"
        )]
        &mut self.motors[place]
    }
}

/// The current that a reply of this model reports, as it is on the wire.
#[must_use]
pub fn reported_current(model: Model, frame: &Frame) -> Option<Current> {
    match Reading::decode(model, frame, None).ok()? {
        Reading::Combined(reply) => reply
            .current
            .map(|current| model.current_of_raw(current.raw())),
        Reading::Drive(reading) => Some(reading.current),
        Reading::Odometry(_) | Reading::Mode(_) => None,
    }
}
