//! The setpoints of the keys.

use motorlink_protocol::{Acceleration, CurrentTarget, PositionTarget, Setpoint, SpeedTarget};

use super::{
    arguments::{Control, Loop},
    keys::Drive,
};

/// Steps of the arrow keys.
const STEP_RPM: i32 = 10;
const STEP_A: f32 = 0.1;
const STEP_DEG: f32 = 10.0;
/// Steps of the keys 1 to 5.
const PRESET_RPM: i32 = 50;
const PRESET_A: f32 = 0.5;
/// Of the keys 1 to 4.
const PRESET_DEG: f32 = 90.0;

/// What the keys drive to.
#[derive(Clone, Copy, Debug)]
pub struct Targets {
    /// The loop that they drive in.
    pub chosen: Loop,
    rpm: i32,
    amps: f32,
    /// The angle; `None` is the present one.
    degrees: Option<f32>,
    acceleration: Acceleration,
}

impl Targets {
    pub fn new(how: &Control) -> Self {
        Self {
            chosen: how.mode,
            rpm: how.rpm,
            amps: how.amps,
            degrees: None,
            acceleration: Acceleration::new(how.accel),
        }
    }

    /// What a key drives to, where the wheel is at `angle`. `None` if it drives to nothing in this loop.
    pub fn setpoint(&mut self, key: Drive, angle: Option<f32>) -> Option<Setpoint> {
        Some(match (self.chosen, key) {
            (Loop::Velocity, Drive::Forward) => self.velocity(self.rpm),
            (Loop::Velocity, Drive::Backward) => self.velocity(-self.rpm),
            (Loop::Velocity, Drive::Preset(number)) => {
                self.velocity(PRESET_RPM * i32::from(number))
            }
            (Loop::Current, Drive::Forward) => current(self.amps),
            (Loop::Current, Drive::Backward) => current(-self.amps),
            (Loop::Current, Drive::Preset(number)) => current(PRESET_A * f32::from(number)),
            (Loop::Position, Drive::Preset(number @ 1..=4)) => {
                self.go_to(PRESET_DEG * f32::from(number - 1))
            }
            (Loop::Position, Drive::Forward) => self.go_to(self.degrees.or(angle)?),
            (Loop::Position, Drive::Backward | Drive::Preset(_)) => return None,
        })
    }

    /// Whether this key drives in the chosen loop.
    pub const fn have(&self, key: Drive) -> bool {
        let is_angle = matches!(key, Drive::Forward | Drive::Preset(1..=4));
        is_angle || !matches!(self.chosen, Loop::Position)
    }

    /// The next setpoint of a motor that is driven to this one: `by` steps further.
    pub fn further(&mut self, driven: Setpoint, by: i8) -> Option<Setpoint> {
        Some(match driven {
            Setpoint::Velocity { speed, .. } => {
                self.velocity(i32::from(speed.rpm()) + STEP_RPM * i32::from(by))
            }
            Setpoint::Current(target) => current(target.amps() + STEP_A * f32::from(by)),
            Setpoint::Position(target) => self.go_to(stepped(target.degrees(), by)),
            Setpoint::Brake | Setpoint::OpenLoop(_) => return None,
        })
    }

    /// Moves the target of a wheel at `angle` that is not driven. Only an angle is kept for the next drive.
    pub fn prepare(&mut self, by: i8, angle: Option<f32>) {
        if self.chosen == Loop::Position
            && let Some(degrees) = self.degrees.or(angle)
        {
            self.degrees = Some(stepped(degrees, by));
        }
    }

    /// Another motor, or another loop, begins at its present angle.
    pub const fn forget_angle(&mut self) {
        self.degrees = None;
    }

    /// The loop, its unit, and what the keys drive to.
    pub fn describe(&self) -> String {
        match (self.chosen, self.degrees) {
            (Loop::Velocity, _) => format!("velocity loop, F/B ±{} rpm", self.rpm.abs()),
            (Loop::Current, _) => format!("current loop, F/B ±{:.2} A", self.amps.abs()),
            (Loop::Position, Some(degrees)) => format!("position loop, F goes to {degrees:.0}°"),
            (Loop::Position, None) => "position loop, F holds the present angle in °".to_owned(),
        }
    }

    /// What the keys do in this loop.
    pub const fn help(&self) -> &'static str {
        match self.chosen {
            Loop::Velocity => "F/B forward, back  1-5 50-250 rpm  ←/→ ±10 rpm",
            Loop::Current => "F/B forward, back  1-5 0.5-2.5 A  ←/→ ±0.1 A",
            Loop::Position => "F go  1-4 go to 0°-270°  ←/→ target ±10°",
        }
    }

    fn velocity(&self, rpm: i32) -> Setpoint {
        Setpoint::Velocity {
            speed: SpeedTarget::clamped(rpm),
            acceleration: self.acceleration,
        }
    }

    fn go_to(&mut self, degrees: f32) -> Setpoint {
        self.degrees = Some(degrees);
        Setpoint::Position(PositionTarget::from_degrees(degrees))
    }
}

fn current(amps: f32) -> Setpoint {
    Setpoint::Current(CurrentTarget::from_amps(amps))
}

/// A step further. It ends at 0° and 360°: beyond, the wheel would turn once round.
fn stepped(degrees: f32, by: i8) -> f32 {
    (degrees + STEP_DEG * f32::from(by))
        .round()
        .clamp(0.0, 360.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn targets(chosen: Loop) -> Targets {
        Targets::new(&Control {
            mode: chosen,
            rpm: 80,
            amps: 0.7,
            high_current: false,
            accel: 3,
            latch: false,
        })
    }

    #[test]
    fn keys_drive_in_the_chosen_loop() {
        let drives = |chosen, key| {
            let setpoint = targets(chosen).setpoint(key, Some(33.3));
            setpoint.map(|setpoint| setpoint.to_string())
        };
        for (chosen, key, is) in [
            (Loop::Velocity, Drive::Forward, Some("+80 rpm")),
            (Loop::Velocity, Drive::Backward, Some("−80 rpm")),
            (Loop::Velocity, Drive::Preset(5), Some("+250 rpm")),
            (Loop::Current, Drive::Backward, Some("−0.700 A")),
            (Loop::Current, Drive::Preset(4), Some("+2.000 A")),
            // The nearest one on the wire.
            (Loop::Position, Drive::Preset(3), Some("180.01°")),
            (Loop::Position, Drive::Preset(5), None),
            (Loop::Position, Drive::Backward, None),
        ] {
            assert_eq!(drives(chosen, key).as_deref(), is, "{chosen:?} {key:?}");
        }
        let held = drives(Loop::Position, Drive::Forward).unwrap();
        assert!(held.starts_with("33.3"), "the present angle: {held}");
        assert_eq!(targets(Loop::Position).setpoint(Drive::Forward, None), None);
    }

    #[test]
    fn arrows_move_what_is_driven_and_an_angle_that_is_not() {
        let mut position = targets(Loop::Position);
        position.prepare(1, Some(84.6));
        position.prepare(1, Some(84.6));
        assert!(position.describe().contains("105°"), "{position:?}");
        let driven = position.setpoint(Drive::Forward, None).unwrap();
        let moved = position.further(driven, -1).unwrap();
        assert_eq!(
            moved,
            Setpoint::Position(PositionTarget::from_degrees(95.0))
        );
        assert_eq!(stepped(355.0, 1).to_bits(), 360_f32.to_bits());
        assert_eq!(stepped(5.0, -1).to_bits(), 0_f32.to_bits());

        let mut current = targets(Loop::Current);
        current.prepare(1, None);
        let driven = current.setpoint(Drive::Forward, None).unwrap();
        let more = current.further(driven, 1).map(|more| more.to_string());
        assert_eq!(more.as_deref(), Some("+0.800 A"));
        assert_eq!(current.further(Setpoint::Brake, 1), None);
    }
}
