//! The end of a scenario: everything stops on a good line, and stays so.

use std::time::Duration;

use motorlink_bus::{Command, StopReason};
use motorlink_protocol::MotorId;

use crate::action::{Action, LineFault};
use crate::rule::{Rule, Violation};

use super::Player;

/// After the last action everything is stopped, and stands within this time.
const LAST_STOP: Duration = Duration::from_secs(8);
/// After Release only queries are sent for this long.
const REST: Duration = Duration::from_secs(1);
/// Below this speed a wheel stands.
const STANDS_RPM: f32 = 1.0;

impl Player {
    /// Stops everything on a good line and checks that it stands and stays so.
    pub(super) fn end(&mut self) -> Result<(), Violation> {
        (self.refuses, self.cuts) = (0, None);
        self.apply(&Action::Line(LineFault::None))?;
        for motor in self.world.motors_mut() {
            self.rules.loaded(motor.id());
            motor.set_load_nm(0.0);
            motor.set_temperature_c(30.0);
            // A motor without supply would coast for too long.
            motor.power(true);
        }
        self.rules.heated(self.now);
        self.apply(&Action::PageHangs(false))?;
        self.apply(&Action::Replug)?;
        // A bus stops the motors that have answered.
        self.run(REST)?;
        self.command(self.now, Command::StopAll(StopReason::Operator))?;
        self.run(LAST_STOP)?;
        self.every_wheel_stands()?;
        self.command(self.now, Command::Release)?;
        self.acted = 0;
        self.run(REST)?;
        self.every_wheel_stands()?;
        if self.acted > 0 {
            return self.restless(format!("{} frames after a release", self.acted));
        }
        Ok(())
    }

    /// A motor may keep its last command: it must be one that moves nothing. A motor whose new ID the page has not learned,
    /// since the line hid the answer or another computer came, is out of its reach.
    pub(super) fn every_wheel_stands(&self) -> Result<(), Violation> {
        let bus = self.bus.iter();
        let known: Vec<MotorId> = bus
            .flat_map(|bus| bus.motors(self.now))
            .map(|it| it.id)
            .collect();
        let motors = self.world.motors();
        for motor in motors.filter(|motor| known.contains(&motor.id())) {
            let (speed_rpm, obeyed) = (motor.speed_rpm(), motor.obeyed());
            if speed_rpm.abs() >= STANDS_RPM {
                let what = format!("{} turns at {speed_rpm} rpm by {obeyed:?}", motor.id());
                return self.restless(what);
            }
        }
        Ok(())
    }

    pub(super) fn restless(&self, what: String) -> Result<(), Violation> {
        Err(Violation {
            rule: Rule::ComesToRest,
            at: self.now,
            what,
        })
    }
}
