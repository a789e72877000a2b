//! The study of current by speed.

use motorlink_protocol::MotorId;

use super::{
    Parameter,
    spans::{hold_rpm, ramp_rpm, spans},
};
use crate::{
    analysis::{Friction, SpeedLevel, Trace, friction},
    runner::Record,
    sequence::{RunLimits, Sequence},
};

/// From one direction to the other in this time.
const TURN_S: f64 = 2.0;

/// A staircase of speeds in both directions.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionStudy {
    /// The motor.
    pub motor: MotorId,
    /// The highest speed, in rpm.
    pub highest_rpm: f64,
    /// Speeds in each direction.
    pub speeds: u32,
    /// How long each speed is held. The first half of it is not measured.
    pub hold_s: f64,
}

/// The figures of a staircase.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionFindings {
    /// The fit; `None` for fewer than three speeds.
    pub friction: Option<Friction>,
    /// The mean of each measured speed.
    pub levels: Vec<SpeedLevel>,
    /// Speeds that were paused or aborted.
    pub left_out: usize,
}

impl FrictionStudy {
    /// Six speeds up to 120 rpm in each direction.
    #[must_use]
    pub const fn of(motor: MotorId) -> Self {
        Self {
            motor,
            highest_rpm: 120.0,
            speeds: 6,
            hold_s: 4.0,
        }
    }

    pub(super) fn parameters(&mut self) -> Vec<Parameter<'_>> {
        vec![
            Parameter::real("highest_rpm", &mut self.highest_rpm, 20.0, 330.0),
            Parameter::whole("speeds", &mut self.speeds, 2, 30),
            Parameter::real("hold_s", &mut self.hold_s, 1.0, 60.0),
        ]
    }

    /// The speed of each row; `None` for the ramps.
    fn rows(&self) -> Vec<Option<f64>> {
        let count = self.speeds.max(1);
        let speed = |number: u32| self.highest_rpm * f64::from(number) / f64::from(count);
        let up = || (1..=count).map(speed);
        let forward = up().map(Some).chain([None]);
        let back = up().map(|rpm| Some(-rpm)).chain([None]);
        forward.chain(back).collect()
    }

    pub(super) fn sequence(&self) -> Sequence {
        let step = |row: Option<f64>| match row {
            Some(rpm) => hold_rpm(self.motor, rpm, self.hold_s),
            None => ramp_rpm(self.motor, 0.0, TURN_S),
        };
        Sequence {
            name: "Friction".to_owned(),
            limits: RunLimits::default(),
            steps: self.rows().into_iter().map(step).collect(),
        }
    }

    pub(super) fn evaluate(&self, record: &Record) -> FrictionFindings {
        let trace = Trace::of(record, self.motor);
        let rows = self.rows();
        let mut levels = Vec::new();
        let mut left_out = 0;
        for span in spans(record) {
            if span.is_running || !matches!(rows.get(span.step), Some(Some(_))) {
                continue;
            }
            if !span.lasted(self.hold_s) {
                left_out += 1;
                continue;
            }
            let rpm = Trace::between(&trace.rpm, span.from_s, span.to_s);
            let amps = Trace::between(&trace.amps, span.from_s, span.to_s);
            levels.extend(SpeedLevel::of(rpm, amps, self.hold_s / 2.0));
        }
        FrictionFindings {
            friction: friction(&levels),
            levels,
            left_out,
        }
    }
}
