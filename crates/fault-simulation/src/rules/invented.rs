//! Whether every value of a sample was in a reply of that age.

use std::{collections::VecDeque, time::Duration};

use motorlink_bus::Sample;
use motorlink_protocol::{
    Current, Detail, Frame, Instant, Mode, Rpm,
    family::{Model, Odometry, Reading, Speed},
};

use crate::rule::{Outcome, Rule, broken};

/// Largest age of a reply, unless nothing was read meanwhile.
const HELD_MAX: Duration = Duration::from_millis(250);
/// Two odometry replies further apart than this tell no speed.
const APART_MAX: Duration = Duration::from_secs(1);
/// A value is rounded by less than this.
const ROUNDED_RPM: f32 = 1.1;
const ROUNDED_A: f32 = 0.002;
/// How much later than its reply a sample may be, between two odometry replies: 5 % of 20 ms and more.
const SPEED_OFF_MAX: f32 = 0.5;
/// Replies kept: two seconds of a full line.
const SAID_MAX: usize = 1_024;

/// What the motors said.
#[derive(Debug, Default)]
pub(super) struct Invented {
    model: Model,
    said: VecDeque<(Instant, Frame)>,
    /// When the port opened, or the bus was last called after a while: what was said before may be of any age.
    absent_until: Option<Instant>,
}

impl Invented {
    pub(super) fn of(model: Model) -> Self {
        Self {
            model,
            ..Self::default()
        }
    }

    pub(super) fn on_absence(&mut self, now: Instant) {
        self.absent_until = Some(now);
    }

    /// A motor replies.
    pub(super) fn replied(&mut self, at: Instant, frame: Frame) {
        if self.said.len() >= SAID_MAX {
            self.said.pop_front();
        }
        self.said.push_back((at, frame));
    }

    /// The bus reports a sample.
    pub(super) fn reported(&self, now: Instant, sample: &Sample) -> Outcome {
        let held = |said: Instant| {
            now.since(said) <= HELD_MAX || self.absent_until.is_some_and(|until| said <= until)
        };
        let newest_first = self.said.iter().rev();
        let mut recent = newest_first.filter(|(at, _)| held(*at));
        if recent.any(|(at, frame)| self.tells_all(*at, frame, sample)) {
            return Ok(());
        }
        let what = format!("{:?}, of which no reply tells all", sample.reply);
        broken(Rule::NoInventedValue, now, what)
    }

    /// Whether this reply, said at that time, tells every value of the sample.
    fn tells_all(&self, at: Instant, frame: &Frame, sample: &Sample) -> bool {
        let reply = &sample.reply;
        if !self.model.has_separate_frames() {
            return *frame == reply.frame();
        }
        match (Reading::decode(self.model, frame, None), reply.detail) {
            (Ok(Reading::Drive(said)), Detail::Temperature(temperature)) => {
                said.id == reply.id
                    && said.temperature == temperature
                    && is_current(said.current.amps(), reply.current)
                    && match said.speed(self.model, reply.mode) {
                        Some(speed) => is_speed(speed, reply.speed),
                        None => reply.mode == Mode::Position && reply.speed.is_none(),
                    }
            }
            (Ok(Reading::Odometry(said)), Detail::Odometry { turns, position }) => {
                said.id == reply.id
                    && said.turns == turns
                    && said.position == position
                    && reply.current.is_none()
                    && reply
                        .speed
                        .is_none_or(|speed| self.moved_at(at, said, speed))
            }
            _ => false,
        }
    }

    /// Whether the motor has moved at this mean speed since an earlier odometry reply.
    fn moved_at(&self, at: Instant, said: Odometry, speed: Rpm) -> bool {
        let earlier = self.said.iter().filter(|(before, _)| *before < at);
        earlier
            .filter(|(before, _)| at.since(*before) <= APART_MAX + HELD_MAX)
            .any(|(before, frame)| {
                let Ok(Reading::Odometry(first)) = Reading::decode(self.model, frame, None) else {
                    return false;
                };
                let rpm = (turns(said) - turns(first)) / at.since(*before).as_secs_f64() * 60.0;
                let off = (rpm - f64::from(speed.rpm())).abs();
                first.id == said.id
                    && off <= f64::from(ROUNDED_RPM) + rpm.abs() * f64::from(SPEED_OFF_MAX)
            })
    }
}

fn turns(said: Odometry) -> f64 {
    f64::from(said.turns) + f64::from(said.position.raw()) / 32_768.0
}

fn is_current(said_a: f32, told: Option<Current>) -> bool {
    told.is_some_and(|told| (told.amps() - said_a).abs() <= ROUNDED_A)
}

fn is_speed(said: Speed, told: Option<Rpm>) -> bool {
    let off = |told: Rpm| said.tenths() - 10 * i32::from(told.rpm());
    told.is_some_and(|told| off(told).abs() < 10)
}
