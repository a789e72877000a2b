//! What the robot publishes.

use std::time::{Duration, Instant, SystemTime};

use super::Robot;
use crate::{
    diagnostics::{self, NodeStatus},
    network::Output,
    odometry::Moved,
    telemetry,
};

impl Robot {
    /// `joint_states`, `odom` and `/tf`.
    pub(super) fn publish(&mut self) {
        let Some((at, clock, state)) = &self.state else {
            return;
        };
        // A state is told once only.
        if self.published.replace(*at) == Some(*at) {
            return;
        }
        let joints = telemetry::joint_states(*clock, state, &self.rover, self.torque_constant);
        let moved: Option<Moved> = self.odometry.advance(*at, state, &self.rover);
        let stamp = telemetry::time(*clock, Duration::ZERO);
        let (has_transform, prefix) = (self.has_transform, &self.prefix);
        let moved = moved.map(|moved| {
            let transform = has_transform.then(|| telemetry::transform(stamp, &moved, prefix));
            Output::Moved(
                Box::new(telemetry::odometry(stamp, &moved, prefix)),
                transform,
            )
        });
        for output in joints.map(Output::Joints).into_iter().chain(moved) {
            // What the network does not take now is old later.
            let _ = self.outputs.try_send(output);
        }
    }

    /// The state for the fleet, when it is due.
    pub(super) fn report(&mut self, now: Instant) {
        let state = self.state.as_ref().map(|(at, _, state)| (*at, state));
        let report = self.reporter.report(now, state, &self.drive, &self.rover);
        if let Some(report) = report {
            // The next one is newer.
            let _ = self.outputs.try_send(Output::Fleet(Box::new(report)));
        }
    }

    /// Once a second.
    pub(super) fn diagnose(&mut self) {
        let of_node = NodeStatus {
            name: self.name.clone(),
            drives: self.drive.is_driving(),
            must_rest: self.drive.must_rest(),
            gaps: self.odometry.gaps(),
            late: std::mem::take(&mut self.late),
        };
        let state = self.state.as_ref().map(|(_, _, state)| state);
        let stamp = telemetry::time(SystemTime::now(), Duration::ZERO);
        let diagnostics = diagnostics::of(stamp, state, &self.rover, &of_node);
        let _ = self.outputs.try_send(Output::Diagnostics(diagnostics));
        let Some((_, clock, state)) = &self.state else {
            return;
        };
        for (index, wheel) in self.rover.wheels.iter().enumerate() {
            if let Some(message) = telemetry::temperature(*clock, wheel, state, &self.prefix) {
                let _ = self.outputs.try_send(Output::Temperature(index, message));
            }
        }
    }
}
