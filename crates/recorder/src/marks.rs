//! What is known of a motor, where a recording has only its replies.

use std::time::Duration;

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_protocol::{Instant, Mode, MotorId, family::Model};

use crate::recording::Sample;

/// A mark is repeated after this time: a reader that begins in the middle needs it.
const HOLDS_FOR: Duration = Duration::from_secs(1);

/// What the marks between samples say so far. A mark is a line event that nothing on the line belongs to.
#[derive(Debug, Default)]
pub(crate) struct Marks {
    model: Model,
    motors: Vec<(MotorId, Instant, Known)>,
}

/// The loop of a motor, and the value that it was told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Known {
    mode: Mode,
    value: Option<[u8; 2]>,
}

impl Marks {
    /// The mark before records of this model, where the records so far have another one.
    pub(crate) fn model(&mut self, at: Instant, model: Model) -> Option<LineEvent> {
        if self.model == model {
            return None;
        }
        let motors = Vec::new();
        *self = Self { model, motors };
        let kind = LineEventKind::ModelSelected(model);
        Some(LineEvent { at, kind })
    }

    /// The mark before this sample, where the marks so far do not say its command, or the loop in which it is read.
    pub(crate) fn sample(&mut self, sample: &Sample) -> Option<LineEvent> {
        let Sample { at, commanded, .. } = *sample;
        let id = MotorId::new(sample.address()).ok()?;
        // In combined frames the reply names its loop.
        let names_loop = !sample.model.has_separate_frames();
        let known = match commanded.filter(|told| names_loop || told.mode == sample.mode) {
            Some(told) => Known {
                mode: told.mode,
                value: Some(told.value),
            },
            None => Known {
                mode: sample.mode,
                value: None,
            },
        };
        let says_nothing = names_loop && known.value.is_none();
        match self.motors.iter_mut().find(|(motor, ..)| *motor == id) {
            Some((_, _, before)) if says_nothing && before.value.is_none() => return None,
            Some((_, said, before)) if *before == known && at.since(*said) < HOLDS_FOR => {
                return None;
            }
            Some((_, said, before)) => (*said, *before) = (at, known),
            None if says_nothing => return None,
            None => self.motors.push((id, at, known)),
        }
        let Known { mode, value } = known;
        let kind = LineEventKind::Known { id, mode, value };
        Some(LineEvent { at, kind })
    }

    /// Nothing is known any more.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }
}
