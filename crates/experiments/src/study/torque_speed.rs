//! The study of speed by torque: a person loads the wheel while it turns.

use motorlink_protocol::MotorId;

use super::{
    Parameter,
    spans::{hold_rpm, ramp_rpm, spans},
};
use crate::{
    analysis::{Point, TorqueSpeed, Trace, torque_speed},
    runner::Record,
    sequence::{RunLimits, Sequence},
};

/// The speed is reached in this time. The replies of it are not measured.
const RISE_S: f64 = 3.0;
/// The person leaves the wheel free for this time, then loads it.
const FREE_S: f64 = 5.0;
/// A free wheel this close to the speed may hold it, and is not at the voltage limit.
const HOLDS_RPM: f64 = 3.0;
/// Maximal number of points of the chart.
const POINTS_MAX: usize = 2_000;

/// A speed that the motor cannot reach, so that the voltage limits it and its speed falls with the load.
#[derive(Clone, Debug, PartialEq)]
pub struct TorqueSpeedStudy {
    /// The motor.
    pub motor: MotorId,
    /// The speed, in rpm. Above the speed that the motor reaches without load.
    pub speed_rpm: f64,
    /// How long it is held, in seconds. The wheel is free for the first five, then the person loads it.
    pub for_s: f64,
}

/// The figures of speed by torque.
#[derive(Clone, Debug, PartialEq)]
pub struct TorqueSpeedFindings {
    /// The fit; `None` for too few replies, or if the wheel reached the speed.
    pub line: Option<TorqueSpeed>,
    /// Replies as current in A and speed in rpm, in the direction of the speed.
    pub points: Vec<(f64, f64)>,
}

impl TorqueSpeedStudy {
    /// 220 rpm for 30 s: more than the 200 rpm that a motor reaches at 18 V.
    #[must_use]
    pub const fn of(motor: MotorId) -> Self {
        Self {
            motor,
            speed_rpm: 220.0,
            for_s: 30.0,
        }
    }

    pub(super) fn parameters(&mut self) -> Vec<Parameter<'_>> {
        vec![
            Parameter::real("speed_rpm", &mut self.speed_rpm, -330.0, 330.0),
            Parameter::real("for_s", &mut self.for_s, 10.0, 600.0),
        ]
    }

    pub(super) fn sequence(&self) -> Sequence {
        Sequence {
            name: "Torque and speed".to_owned(),
            limits: RunLimits::default(),
            steps: vec![
                ramp_rpm(self.motor, self.speed_rpm, RISE_S),
                hold_rpm(self.motor, self.speed_rpm, self.for_s),
                ramp_rpm(self.motor, 0.0, 1.0),
            ],
        }
    }

    pub(super) fn evaluate(&self, record: &Record) -> TorqueSpeedFindings {
        let trace = Trace::of(record, self.motor);
        let loaded = spans(record)
            .into_iter()
            .filter(|span| span.step == 1 && !span.was_paused(self.for_s));
        let (mut free, mut all) = (Vec::new(), Vec::new());
        for span in loaded {
            let rpm = Trace::between(&trace.rpm, span.from_s, span.to_s);
            let amps = Trace::between(&trace.amps, span.from_s, span.to_s);
            let pair = |(rpm, amps): (&Point, &Point)| (rpm.value, amps.value);
            let until_s = rpm.first().map_or(0.0, |first| first.t_s) + FREE_S;
            let of_free = rpm.iter().take_while(|point| point.t_s < until_s);
            free.extend(of_free.zip(amps).map(pair));
            all.extend(rpm.iter().zip(amps).map(pair));
        }
        let every = all.len().div_ceil(POINTS_MAX).max(1);
        let shown = all.iter().step_by(every);
        let limited =
            |line: &TorqueSpeed| line.no_load_rpm.value < self.speed_rpm.abs() - HOLDS_RPM;
        TorqueSpeedFindings {
            points: shown
                .map(|(rpm, amps)| (amps * rpm.signum(), rpm.abs()))
                .collect(),
            line: torque_speed(&free, &all).filter(limited),
        }
    }
}
