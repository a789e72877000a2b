//! Where the robot is, from the positions of its wheels. They roll and do not slip.
//!
//! motorlink counts the turns of each wheel. It cannot count while a motor does not reply for over a second, and begins again at 0 when
//! it starts: the way of such a wheel is left out, and the count of gaps says that the pose is not true any more.

use std::time::Instant;

use motorlink_controller_messages::{Motor, State};
use motorlink_experiments::odometry::Pose;
use motorlink_protocol::family::Model;

use crate::{
    node::messages::Twist,
    rover::{Rover, Wheel},
};

/// A motor that has not replied for so long has lost turns, in µs.
const GAP_US: u32 = 1_000_000;
/// A wheel is followed by its speed for so long, in µs: motors reply one after the other.
const FOLLOWED_US: u32 = 100_000;

/// From what the way of a wheel is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum OdometrySource {
    /// Its position. DDSM115, M0601 and DDSM315.
    Position,
    /// Its speed. DDSM210 and DDSM400, which tell their position too rarely.
    Speed,
}

impl OdometrySource {
    /// What suits the model. While it is not known, positions: those of a later reply count, too.
    const fn of(model: Option<Model>) -> Self {
        match model {
            Some(Model::Ddsm210 | Model::Ddsm400) => Self::Speed,
            Some(Model::Ddsm115 | Model::Ddsm315) | None => Self::Position,
        }
    }
}

/// Adds up the way of the robot.
#[derive(Debug)]
pub struct Odometry {
    /// Chosen by a person, or by the model.
    from: Option<OdometrySource>,
    /// Ahead and to the right in mm, clockwise in degrees: see [`Pose`].
    pose: Pose,
    /// For each wheel of the rover: its position, ahead in rad, when the way was counted last.
    counted: Vec<Option<f64>>,
    counted_at: Option<Instant>,
    gaps: u32,
    is_in_gap: bool,
}

/// Where the robot is and how it moves, in axes of ROS.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moved {
    /// Ahead of where it began, in m.
    pub x: f64,
    /// To the left, in m.
    pub y: f64,
    /// To the left, in rad.
    pub heading: f64,
    /// How it moves.
    pub twist: Twist,
}

impl Odometry {
    /// The robot begins at 0. Without `from`, the model of its motors decides.
    #[must_use]
    pub fn new(from: Option<OdometrySource>) -> Self {
        Self {
            from,
            pose: Pose::default(),
            counted: Vec::new(),
            counted_at: None,
            gaps: 0,
            is_in_gap: false,
        }
    }

    /// How often the way of a side was not known.
    #[must_use]
    pub const fn gaps(&self) -> u32 {
        self.gaps
    }

    /// The connection is gone: what the wheels do meanwhile is not known.
    pub fn cut_off(&mut self) {
        if self.counted_at.take().is_some() {
            self.counted.clear();
            self.gaps += 1;
        }
    }

    /// Counts the way since the last call. `None` where a side has no wheel whose way is known.
    pub fn advance(&mut self, now: Instant, state: &State, rover: &Rover) -> Option<Moved> {
        let motors = rover.wheels.iter().map(|wheel| {
            let motor = state
                .motors
                .iter()
                .find(|motor| motor.id == wheel.id.get())?;
            motor.reply_age.filter(|age| *age < GAP_US).map(|_| motor)
        });
        let motors: Vec<Option<&Motor>> = motors.collect();
        let from = self.from.unwrap_or_else(|| OdometrySource::of(state.model));
        let seconds = self
            .counted_at
            .replace(now)
            .map(|at| now.duration_since(at).as_secs_f64());
        let places: Vec<Option<f64>> = rover
            .wheels
            .iter()
            .zip(&motors)
            .map(|(wheel, motor)| motor.and_then(place).map(|place| wheel.sign() * place))
            .collect();
        let before = std::mem::replace(&mut self.counted, places);
        let seconds = seconds?;
        if seconds > 1.0 {
            // This program was frozen: how the wheels have turned meanwhile is not known by their speed.
            self.gaps += 1;
            return None;
        }
        let side = |right: bool| {
            let (mut way, mut speed, mut count) = (0.0, 0.0, 0.0);
            let of_side = |(wheel, _): &(&Wheel, _)| wheel.is_right == right;
            let known = before.iter().zip(&self.counted).zip(&motors);
            for (wheel, ((before, counted), motor)) in
                rover.wheels.iter().zip(known).filter(of_side)
            {
                let Some((velocity, _)) = motor.and_then(|motor| motor.velocity) else {
                    continue;
                };
                let velocity = wheel.sign() * f64::from(velocity);
                let turned = match from {
                    OdometrySource::Position => {
                        counted.zip(*before).map(|(now, before)| now - before)
                    }
                    OdometrySource::Speed => Some(velocity * seconds),
                };
                if let Some(turned) = turned {
                    way += turned;
                    speed += velocity;
                    count += 1.0;
                }
            }
            (count > 0.0).then(|| (way / count, speed / count))
        };
        let (Some((left, left_speed)), Some((right, right_speed))) = (side(false), side(true))
        else {
            // Once for each gap.
            self.gaps += u32::from(!self.is_in_gap);
            self.is_in_gap = true;
            return None;
        };
        self.is_in_gap = false;
        let mm = rover.radius_m * 1e3;
        self.pose = self.pose.moved(left * mm, right * mm, rover.track_m * 1e3);
        Some(Moved {
            x: self.pose.y / 1e3,
            y: -self.pose.x / 1e3,
            heading: -self.pose.heading_deg.to_radians(),
            twist: rover.twist(left_speed, right_speed),
        })
    }
}

/// Where a motor is when the state is sent: its position, and what it has turned since by its speed.
fn place(motor: &Motor) -> Option<f64> {
    let (position, age) = motor.position?;
    let turned = motor.velocity.map_or(0.0, |(velocity, _)| {
        f64::from(velocity) * f64::from(age.min(FOLLOWED_US)) / 1e6
    });
    Some(position + turned)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::rover::tests::rover;

    struct Wheels {
        odometry: Odometry,
        now: Instant,
        /// Ahead, in rad.
        places: [f64; 2],
        reply_age: Option<u32>,
        model: Option<Model>,
        /// Whether the motors tell their positions.
        tells_positions: bool,
    }

    impl Wheels {
        fn new(from: Option<OdometrySource>) -> Self {
            Self {
                odometry: Odometry::new(from),
                now: Instant::now(),
                places: [3.0, -7.0],
                reply_age: Some(5_000),
                model: None,
                tells_positions: true,
            }
        }

        /// Turns for a second, at so many rad/s.
        fn turn(&mut self, speeds: [f64; 2]) -> Option<Moved> {
            let mut moved = None;
            for _ in 0..50 {
                self.now += Duration::from_millis(20);
                let mut motors = Vec::new();
                for (index, sign) in [1.0, -1.0].into_iter().enumerate() {
                    self.places[index] += 0.02 * speeds[index];
                    // Measured 5 ms ago.
                    let position = sign * (self.places[index] - 0.005 * speeds[index]);
                    motors.push(Motor {
                        id: u8::try_from(index + 1).unwrap(),
                        reply_age: self.reply_age,
                        position: self.tells_positions.then_some((position, 5_000)),
                        #[expect(clippy::cast_possible_truncation, reason = "as in a state")]
                        velocity: Some(((sign * speeds[index]) as f32, 5_000)),
                        ..Motor::default()
                    });
                }
                let state = State {
                    motors,
                    model: self.model,
                    ..State::default()
                };
                moved = self.odometry.advance(self.now, &state, &rover());
            }
            moved
        }
    }

    fn near(value: f64, expected: f64) -> bool {
        (value - expected).abs() < 1e-6
    }

    #[test]
    fn ahead_and_a_turn_to_the_left_have_the_signs_of_ros() {
        for from in [OdometrySource::Position, OdometrySource::Speed] {
            let mut wheels = Wheels::new(Some(from));
            wheels.turn([0.0, 0.0]);
            let moved = wheels.turn([10.0, 10.0]).unwrap();
            assert!(near(moved.x, 0.5) && near(moved.y, 0.0), "{moved:?}");
            assert!(near(moved.twist.linear.x, 0.5), "{moved:?}");
            // 0.3 m apart: the right wheel 0.3 m more, in 4 s, is a radian.
            for _ in 0..4 {
                wheels.turn([-0.75, 0.75]);
            }
            let moved = wheels.turn([10.0, 10.0]).unwrap();
            assert!(near(moved.heading, 1.0), "{moved:?}");
            assert!(near(moved.x, 0.5 + 0.5 * 1.0_f64.cos()), "{moved:?}");
            assert!(near(moved.y, 0.5 * 1.0_f64.sin()), "{moved:?}");
        }
    }

    #[test]
    fn the_model_decides_what_the_way_is_known_from() {
        for (model, is_known) in [
            (Some(Model::Ddsm210), true),
            (Some(Model::Ddsm400), true),
            (Some(Model::Ddsm115), false),
            (None, false),
        ] {
            let mut wheels = Wheels::new(None);
            (wheels.model, wheels.tells_positions) = (model, false);
            wheels.turn([0.0, 0.0]);
            let moved = wheels.turn([10.0, 10.0]);
            assert_eq!(
                moved.is_some_and(|moved| near(moved.x, 0.5)),
                is_known,
                "{model:?}"
            );
        }
    }

    #[test]
    fn what_was_not_counted_is_a_gap_and_no_way() {
        let mut wheels = Wheels::new(None);
        wheels.turn([10.0, 10.0]);
        wheels.reply_age = Some(1_200_000);
        assert_eq!(wheels.turn([10.0, 10.0]), None);
        assert_eq!(wheels.odometry.gaps(), 1);
        wheels.reply_age = Some(0);
        let moved = wheels.turn([0.0, 0.0]).unwrap();
        // The first 20 ms only give the place from which it counts.
        assert!(near(moved.x, 0.49), "{moved:?}");
        let gaps = wheels.odometry.gaps();
        wheels.odometry.cut_off();
        wheels.places = [0.0, 0.0];
        let moved = wheels.turn([0.0, 0.0]).unwrap();
        assert!(near(moved.x, 0.49), "{moved:?}");
        assert_eq!(wheels.odometry.gaps(), gaps + 1);
    }
}
