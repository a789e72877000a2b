//! A vehicle on the wheels of hub motors: its measures, where its wheels are, and its motion from their speeds.
//!
//! It is a differential drive: its wheels roll and do not slip, and those of one side turn together.

mod stored;

use motorlink_protocol::MotorId;

/// Wheel radii in mm: half and ten times that of the smallest and the largest wheel in use, with room.
pub const RADIUS_MM: (u16, u16) = (10, 500);
/// Track widths in mm, from a toy to a car.
pub const TRACK_MM: (u16, u16) = (50, 3_000);

/// Axles are at least so many wheel diameters apart.
const AXLE_DISTANCE_DIAMETERS: f64 = 1.35;

/// Wheel radius and track width, in their ranges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Geometry {
    radius_mm: u16,
    track_mm: u16,
}

impl Default for Geometry {
    /// The wheel of an M0601 or DDSM115 has a diameter of 102 mm; the track is that of a small rover.
    fn default() -> Self {
        Self {
            radius_mm: 51,
            track_mm: 300,
        }
    }
}

impl Geometry {
    /// `None` for a measure that is out of its range.
    #[must_use]
    pub fn new(radius_mm: i32, track_mm: i32) -> Option<Self> {
        let within = |value: i32, (least, most): (u16, u16)| {
            let value = u16::try_from(value).ok()?;
            (least..=most).contains(&value).then_some(value)
        };
        Some(Self {
            radius_mm: within(radius_mm, RADIUS_MM)?,
            track_mm: within(track_mm, TRACK_MM)?,
        })
    }

    /// From the axle to the ground, in mm.
    #[must_use]
    pub fn radius_mm(self) -> f64 {
        self.radius_mm.into()
    }

    /// Between the middles of the left and the right wheels, in mm.
    #[must_use]
    pub fn track_mm(self) -> f64 {
        self.track_mm.into()
    }

    /// Across a tyre, in mm: 41 mm for a radius of 51 mm.
    #[must_use]
    pub fn tyre_mm(self) -> f64 {
        0.8 * self.radius_mm()
    }

    /// Both, as a person enters them.
    #[must_use]
    pub fn entered(self) -> [i32; 2] {
        [self.radius_mm.into(), self.track_mm.into()]
    }
}

/// A wheel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wheel {
    /// Its motor.
    pub id: MotorId,
    /// Which side it is on. A motor on the right is mounted mirrored.
    pub is_right: bool,
    /// Its name, empty if it has none.
    pub name: String,
}

impl Wheel {
    /// The sign of the speed on the wire that drives forward.
    #[must_use]
    pub const fn forward_sign(&self) -> f64 {
        if self.is_right { -1.0 } else { 1.0 }
    }
}

/// Wheels on both sides, each side from the front to the rear.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vehicle {
    wheels: Vec<Wheel>,
}

/// The centre of a wheel in mm, seen from above: `x` to the right of the middle, `y` behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// To the right.
    pub x: f64,
    /// Behind.
    pub y: f64,
}

impl Vehicle {
    /// Of these wheels, each side in the order from the front to the rear; `None` unless there is a wheel on either
    /// side.
    #[must_use]
    pub fn new(wheels: Vec<Wheel>) -> Option<Self> {
        let has = |right| wheels.iter().any(|wheel| wheel.is_right == right);
        (has(false) && has(true)).then_some(Self { wheels })
    }

    /// Every wheel.
    #[must_use]
    pub fn wheels(&self) -> &[Wheel] {
        &self.wheels
    }

    /// The wheels of one side, from the front to the rear.
    pub fn side(&self, right: bool) -> impl Iterator<Item = &Wheel> {
        self.wheels
            .iter()
            .filter(move |wheel| wheel.is_right == right)
    }

    /// From the first axle to the last, in mm.
    #[must_use]
    pub fn base_mm(&self, geometry: Geometry) -> f64 {
        let axles = self.side(false).count().max(self.side(true).count());
        let axles = u32::try_from(axles).unwrap_or(u32::MAX);
        let gaps = f64::from(axles.saturating_sub(1));
        let least = 2.0 * geometry.radius_mm() * AXLE_DISTANCE_DIAMETERS;
        // A vehicle about as long as it is wide.
        (least * gaps).max(if axles > 1 {
            0.9 * geometry.track_mm()
        } else {
            0.0
        })
    }

    /// The centre of each wheel, in the order of [`wheels`](Self::wheels).
    #[must_use]
    pub fn places(&self, geometry: Geometry) -> Vec<Place> {
        let base = self.base_mm(geometry);
        let mut next = [0_u32; 2];
        let counts = [self.side(false).count(), self.side(true).count()];
        let place = |wheel: &Wheel| {
            let side = usize::from(wheel.is_right);
            let gaps = counts.get(side).map_or(1, |count| count.saturating_sub(1));
            let row = next.get_mut(side).map_or(0, |next| {
                *next += 1;
                *next - 1
            });
            let part = if gaps == 0 {
                0.0
            } else {
                f64::from(row) / f64::from(u32::try_from(gaps).unwrap_or(1)) - 0.5
            };
            let half = geometry.track_mm() / 2.0;
            Place {
                x: if wheel.is_right { half } else { -half },
                y: base * part,
            }
        };
        self.wheels.iter().map(place).collect()
    }
}

/// The motion of the vehicle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Ahead.
    pub forward_mm_per_s: f64,
    /// Clockwise, which is to the right.
    pub turn_deg_per_s: f64,
}

impl Motion {
    /// From the speed of each wheel, + is forward, in the order of the vehicle's wheels; `None` unless a wheel of each
    /// side has a speed.
    #[must_use]
    pub fn of(vehicle: &Vehicle, geometry: Geometry, rpm: &[Option<f64>]) -> Option<Self> {
        let side = |right: bool| {
            let wheels = vehicle.wheels().iter().zip(rpm);
            let (mut sum, mut count) = (0.0, 0.0);
            for (_, rpm) in wheels.filter(|(wheel, _)| wheel.is_right == right) {
                if let Some(rpm) = rpm {
                    sum += rpm;
                    count += 1.0;
                }
            }
            let mm_a_turn = std::f64::consts::TAU * geometry.radius_mm();
            (count > 0.0).then(|| sum / count / 60.0 * mm_a_turn)
        };
        let (left, right) = (side(false)?, side(true)?);
        Some(Self {
            forward_mm_per_s: f64::midpoint(left, right),
            turn_deg_per_s: ((left - right) / geometry.track_mm()).to_degrees(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Odd IDs are left wheels, even ones right wheels.
    fn vehicle(count: u8) -> Vehicle {
        let wheel = |number: u8| Wheel {
            id: MotorId::new(number).unwrap(),
            is_right: number.is_multiple_of(2),
            name: String::new(),
        };
        Vehicle::new((1..=count).map(wheel).collect()).unwrap()
    }

    #[test]
    fn wheels_are_placed_from_the_front_to_the_rear_and_the_track_apart() {
        let geometry = Geometry::new(50, 300).unwrap();
        let places = |count| vehicle(count).places(geometry);
        let [left, right] = places(2)[..] else {
            panic!("two wheels")
        };
        assert_eq!((left.x, left.y), (-150.0, 0.0));
        assert_eq!((right.x, right.y), (150.0, 0.0));
        let four = places(4);
        assert_eq!((four[0].x, four[0].y), (-150.0, -135.0), "front left");
        assert_eq!((four[3].x, four[3].y), (150.0, 135.0), "rear right");
        let eight = places(8);
        let gap = eight[2].y - eight[0].y;
        assert!(gap > 100.0, "wheels of 100 mm do not touch: {gap}");
        // A side with fewer wheels spreads them over the same length.
        let five = places(5);
        assert_eq!((five[1].y, five[3].y), (five[0].y, five[4].y));
    }

    fn motion(rpm: &[Option<f64>]) -> Option<Motion> {
        let count = u8::try_from(rpm.len()).unwrap();
        Motion::of(&vehicle(count), Geometry::new(50, 300).unwrap(), rpm)
    }

    #[test]
    fn both_sides_ahead_is_ahead_and_the_left_one_alone_turns_to_the_right() {
        let ahead = motion(&[Some(60.0), Some(60.0)]).unwrap();
        assert!((ahead.forward_mm_per_s - 314.159).abs() < 0.001);
        assert!(ahead.turn_deg_per_s.abs() < 1e-9);
        let to_the_right = motion(&[Some(60.0), Some(-60.0)]).unwrap();
        assert!(to_the_right.forward_mm_per_s.abs() < 1e-9);
        assert!((to_the_right.turn_deg_per_s - 120.0).abs() < 1e-9);
    }

    #[test]
    fn a_side_without_a_speed_leaves_the_motion_unknown() {
        assert_eq!(motion(&[Some(60.0), None]), None);
        let of_three = motion(&[Some(60.0), Some(-60.0), None, Some(-60.0)]);
        assert_eq!(of_three, motion(&[Some(60.0), Some(-60.0)]));
    }
}
