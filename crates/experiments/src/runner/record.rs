//! The sent setpoints and the telemetry of a run.

use motorlink_protocol::{Current, Instant, MotorId, Setpoint};

use super::{End, Telemetry};

/// Maximal number of samples: 33 minutes at 200 Hz, 16 MB. Beyond it every second one of the longest stream is dropped, so
/// that the record of a day stays complete, at a lower rate.
const SAMPLES_MAX: usize = 400_000;
/// Maximal number of changes of setpoints.
const SENT_MAX: usize = 400_000;
/// Maximal number of starts of steps.
const MARKS_MAX: usize = 100_000;

/// One reply of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sample {
    /// Which motor.
    pub id: MotorId,
    /// When its last byte was received.
    pub at: Instant,
    /// Speed in rpm; `None` if the reply does not tell it.
    pub rpm: Option<i16>,
    /// Torque current; `None` if the reply does not tell it.
    pub current: Option<Current>,
    /// Angle in degrees.
    pub degrees: Option<f32>,
    /// Temperature in deg C.
    pub celsius: Option<u8>,
}

/// A setpoint that differs from the one before.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SentSetpoint {
    /// Which motor.
    pub id: MotorId,
    /// When its frame was sent.
    pub at: Instant,
    /// What was sent.
    pub setpoint: Setpoint,
}

/// The start of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Mark {
    /// When it started in the plan.
    pub at: Instant,
    /// The instruction of the plan: see [`Plan::place`](crate::plan::Plan::place).
    pub step: usize,
}

/// New entries of a record.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RecordPart {
    /// Replies, in order of time.
    pub samples: Vec<Sample>,
    /// Changes of setpoints, in order of time.
    pub sent: Vec<SentSetpoint>,
    /// Starts of steps, in order of time.
    pub marks: Vec<Mark>,
}

/// The sent setpoints and the telemetry of a run, with bounds.
#[derive(Clone, Debug, Default)]
pub struct Record {
    began: Option<Instant>,
    end: Option<End>,
    samples: Vec<Sample>,
    sent: Vec<SentSetpoint>,
    /// The last setpoint of each motor.
    last: Vec<(MotorId, Setpoint)>,
    marks: Vec<Mark>,
    streams: Vec<Stream>,
    left_out: bool,
}

/// The replies of one motor of one kind. They are thinned apart: replies with a temperature are few, and motors reply in
/// turn, so a common count would drop all of one of them.
#[derive(Clone, Debug)]
struct Stream {
    of: (MotorId, Kind),
    received: u64,
    kept: usize,
    /// Base-2 logarithm of the decimation.
    halved: u32,
}

/// What a reply has beside the speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Angle,
    Temperature,
    Neither,
}

impl Sample {
    const fn stream(&self) -> (MotorId, Kind) {
        let kind = match (self.celsius, self.degrees) {
            (Some(_), _) => Kind::Temperature,
            (None, Some(_)) => Kind::Angle,
            (None, None) => Kind::Neither,
        };
        (self.id, kind)
    }
}

impl Record {
    /// When the run was started.
    #[must_use]
    pub const fn began_at(&self) -> Option<Instant> {
        self.began
    }

    /// How it ended.
    #[must_use]
    pub const fn end(&self) -> Option<End> {
        self.end
    }

    /// The replies, in order of time.
    #[must_use]
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// The changes of setpoints, in order of time.
    #[must_use]
    pub fn sent_setpoints(&self) -> &[SentSetpoint] {
        &self.sent
    }

    /// The starts of steps, in order of time.
    #[must_use]
    pub fn marks(&self) -> &[Mark] {
        &self.marks
    }

    /// Whether samples or other entries were dropped because a maximum was reached.
    #[must_use]
    pub fn is_thinned(&self) -> bool {
        self.left_out || self.streams.iter().any(|stream| stream.halved > 0)
    }

    /// The replies and setpoints of each motor that has replied, in the order of their IDs.
    pub(crate) fn by_motor(&self) -> Vec<(MotorId, Self)> {
        let mut motors: Vec<(MotorId, Self)> = Vec::new();
        let empty = || Self {
            began: self.began,
            end: self.end,
            ..Self::default()
        };
        for sample in &self.samples {
            let place = motors.binary_search_by_key(&sample.id, |(id, _)| *id);
            let place = place.unwrap_or_else(|place| {
                motors.insert(place, (sample.id, empty()));
                place
            });
            if let Some((_, of_motor)) = motors.get_mut(place) {
                of_motor.samples.push(*sample);
            }
        }
        for sent in &self.sent {
            if let Some((_, of_motor)) = motors.iter_mut().find(|(id, _)| *id == sent.id) {
                of_motor.sent.push(*sent);
            }
        }
        motors
    }

    /// Takes the entries since the last call out of the record.
    pub fn take_part(&mut self) -> RecordPart {
        RecordPart {
            samples: std::mem::take(&mut self.samples),
            sent: std::mem::take(&mut self.sent),
            marks: std::mem::take(&mut self.marks),
        }
    }

    /// Adds entries that [`Record::take_part`] took out of another record.
    pub fn add_part(&mut self, part: RecordPart) {
        for sample in part.samples {
            self.add_sample(sample);
        }
        for sent in part.sent {
            self.sent(sent.at, sent.id, sent.setpoint);
        }
        for mark in part.marks {
            self.mark(mark);
        }
    }

    /// The run starts at this time.
    pub const fn began(&mut self, now: Instant) {
        self.began = Some(now);
    }

    /// The run has ended so.
    pub const fn ended(&mut self, end: End) {
        self.end = Some(end);
    }

    pub(super) fn mark(&mut self, mark: Mark) {
        if self.marks.len() < MARKS_MAX {
            self.marks.push(mark);
        } else {
            self.left_out = true;
        }
    }

    pub(super) fn sent(&mut self, at: Instant, id: MotorId, setpoint: Setpoint) {
        let place = self.last.iter().position(|(known, _)| *known == id);
        match place.and_then(|place| self.last.get_mut(place)) {
            Some((_, last)) if *last == setpoint => return,
            Some((_, last)) => *last = setpoint,
            None => self.last.push((id, setpoint)),
        }
        if self.sent.len() < SENT_MAX {
            self.sent.push(SentSetpoint { id, at, setpoint });
        } else {
            self.left_out = true;
        }
    }

    pub(super) fn sample(&mut self, reply: Telemetry) {
        self.add_sample(Sample {
            id: reply.id,
            at: reply.at,
            rpm: reply.rpm,
            current: reply.current,
            degrees: reply.degrees,
            celsius: reply.celsius,
        });
    }

    fn add_sample(&mut self, sample: Sample) {
        let of = sample.stream();
        let known = self.streams.iter().position(|stream| stream.of == of);
        let place = known.unwrap_or(self.streams.len());
        if known.is_none() {
            self.streams.push(Stream {
                of,
                received: 0,
                kept: 0,
                halved: 0,
            });
        }
        let Some(stream) = self.streams.get_mut(place) else {
            return;
        };
        let number = stream.received;
        stream.received += 1;
        if !number.is_multiple_of(1 << stream.halved) {
            return;
        }
        stream.kept += 1;
        if self.samples.len() >= SAMPLES_MAX {
            self.thin();
        }
        self.samples.push(sample);
    }

    /// Drops every second sample of the longest stream.
    fn thin(&mut self) {
        let Some(longest) = self.streams.iter_mut().max_by_key(|stream| stream.kept) else {
            return;
        };
        let of = longest.of;
        let (mut keep, mut dropped) = (false, 0);
        self.samples.retain(|sample| {
            keep ^= sample.stream() == of;
            let stays = keep || sample.stream() != of;
            dropped += usize::from(!stays);
            stays
        });
        longest.kept = longest.kept.saturating_sub(dropped);
        longest.halved = (longest.halved + 1).min(32);
    }
}
