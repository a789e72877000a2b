//! `/odom` and `/cmd_vel`: the motion of a rover, from the replies of its wheels and from their setpoints, in the shapes
//! and the axes of ROS: x ahead, y to the left, turns to the left are positive.

use std::{fmt::Write, time::Duration};

use motorlink_bus::{CommandedValue, LineEvent, commanded};
use motorlink_messages::experiments::{
    number::sin_cos,
    odometry::{Link, Odometer, Report, Step},
    vehicle::{Geometry, Motion, Vehicle},
};
use motorlink_protocol::{Instant, MotorId, Reply, family::Model};
use motorlink_recorder::Commands;

/// At most 50 commands a second, as many as the steps of the odometry.
const COMMAND_EVERY: Duration = Duration::from_millis(20);

/// The rover, and the messages of it that are not yet written.
#[derive(Debug)]
pub(crate) struct Rover {
    vehicle: Vehicle,
    geometry: Geometry,
    odometer: Odometer,
    commands: Commands,
    commanded: Option<Instant>,
    /// The wheels that have replied since the line was opened.
    replied: Vec<MotorId>,
    ready: Vec<Moved>,
}

/// What a message tells.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Moved {
    /// `/odom`.
    Odometry(Step),
    /// `/cmd_vel`.
    Command(Instant, Motion),
}

impl Rover {
    /// The rover that [`Vehicle::to_json`] describes.
    pub(crate) fn from_json(text: &str) -> Option<Self> {
        let (vehicle, geometry) = Vehicle::from_json(text)?;
        Some(Self {
            odometer: Odometer::new(&vehicle, geometry),
            vehicle,
            geometry,
            commands: Commands::default(),
            commanded: None,
            replied: Vec::new(),
            ready: Vec::new(),
        })
    }

    /// The line was opened or closed: how the wheels have turned meanwhile is unknown.
    pub(crate) fn cut_off(&mut self) {
        self.replied.clear();
        self.commands = Commands::default();
    }

    /// Takes an event of a line of this model.
    pub(crate) fn add_event(&mut self, model: Model, event: &LineEvent) {
        let at = event.at;
        self.commands.add_event(model, event);
        let is_due = self
            .commanded
            .is_none_or(|last| at.since(last) >= COMMAND_EVERY);
        if !is_due || commanded(model, &event.kind).is_none() {
            return;
        }
        let wheels = self.vehicle.wheels().iter().map(|wheel| {
            let commanded = self.commands.at(wheel.id.get(), at)?;
            match commanded.value(model) {
                CommandedValue::Speed(speed) => Some(f64::from(speed.rpm()) * wheel.forward_sign()),
                _ => None,
            }
        });
        let rpm: Vec<_> = wheels.collect();
        if let Some(motion) = Motion::of(&self.vehicle, self.geometry, &rpm) {
            self.commanded = Some(at);
            self.ready.push(Moved::Command(at, motion));
        }
    }

    /// Takes a reply.
    pub(crate) fn add_reply(&mut self, at: Instant, reply: &Reply) {
        let mut wheels = self.vehicle.wheels().iter();
        let place = wheels.position(|wheel| wheel.id == reply.id);
        let (Some(place), Some(speed)) = (place, reply.speed) else {
            return;
        };
        let is_cut_off = !self.replied.contains(&reply.id);
        if is_cut_off {
            self.replied.push(reply.id);
        }
        let report = Report::new(at, speed, reply.detail.into(), is_cut_off);
        self.odometer.report(place, report);
        let ready = &mut self.ready;
        self.odometer.advance(|step| {
            if step.link != Link::Unknown {
                ready.push(Moved::Odometry(step));
            }
        });
    }

    /// The messages that are ready.
    pub(crate) fn take(&mut self) -> Vec<Moved> {
        std::mem::take(&mut self.ready)
    }
}

impl Moved {
    pub(crate) const fn at(&self) -> Instant {
        match self {
            Self::Odometry(step) => step.until,
            Self::Command(at, _) => *at,
        }
    }

    /// The message; `ns` is its time since 1970.
    pub(crate) fn json(&self, ns: u64) -> String {
        let (sec, nanosec) = (ns / 1_000_000_000, ns % 1_000_000_000);
        let frame = match self {
            Self::Odometry(_) => "odom",
            Self::Command(..) => "base_link",
        };
        // ROS 2 calls it nanosec, Foxglove nsec.
        let mut out = format!(
            r#"{{"header":{{"stamp":{{"sec":{sec},"nanosec":{nanosec},"nsec":{nanosec}}},"frame_id":"{frame}"}}"#
        );
        // Writing to a string cannot fail.
        let _ = match self {
            Self::Odometry(step) => {
                let pose = step.pose;
                let (sin, cos) = sin_cos(pose.heading_deg / -2.0);
                let twist = twist(step.motion);
                write!(
                    out,
                    r#","child_frame_id":"base_link","pose":{{"pose":{{"position":{{"x":{:.6},"y":{:.6},"z":0}},"orientation":{{"x":0,"y":0,"z":{sin:.6},"w":{cos:.6}}}}},"covariance":[{COVARIANCE}]}},"twist":{{"twist":{twist},"covariance":[{COVARIANCE}]}}}}"#,
                    pose.y / 1e3,
                    pose.x / -1e3,
                )
            }
            Self::Command(_, motion) => write!(out, r#","twist":{}}}"#, twist(*motion)),
        };
        out
    }
}

/// Six by six: unknown.
const COVARIANCE: &str = "0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0";

fn twist(motion: Motion) -> String {
    let metres_per_s = motion.forward_mm_per_s / 1e3;
    let radians_per_s = -motion.turn_deg_per_s.to_radians();
    format!(
        r#"{{"linear":{{"x":{metres_per_s:.6},"y":0,"z":0}},"angular":{{"x":0,"y":0,"z":{radians_per_s:.6}}}}}"#
    )
}
