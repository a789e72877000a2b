//! The wheels of the vehicle: the motors of the group that have a side, and where each is.

use motorlink_messages::protocol::MotorId;

use crate::{
    features::rover::geometry::Geometry,
    model::{
        mirror::Mirror,
        names_and_sides::{NameAndSide, NamesAndSides, Side},
    },
};

/// Axles are at least so many wheel diameters apart.
const AXLE_DISTANCE_DIAMETERS: f64 = 1.35;

/// A wheel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Wheel {
    pub(crate) id: MotorId,
    pub(crate) is_right: bool,
    pub(crate) mirror: Mirror,
    pub(crate) name: String,
}

impl Wheel {
    /// The sign of the speed on the wire that drives forward.
    pub(crate) fn forward_sign(&self) -> f64 {
        if self.mirror.is_mirrored() { -1.0 } else { 1.0 }
    }
}

/// Wheels on both sides, each side in the order of IDs, from the front to the rear.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Vehicle {
    wheels: Vec<Wheel>,
}

/// The centre of a wheel in mm, seen from above: `x` to the right of the middle, `y` behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    pub(crate) x: f64,
    pub(crate) y: f64,
}

impl Vehicle {
    /// `None` unless the group has a wheel on either side.
    pub(crate) fn of(names: &NamesAndSides) -> Option<Self> {
        let members = names.members().filter(|(_, member)| member.drives);
        let wheel = |(id, member): &(MotorId, NameAndSide)| {
            Some(Wheel {
                id: *id,
                is_right: match member.side {
                    Side::None => return None,
                    Side::Left => false,
                    Side::Right => true,
                },
                mirror: names.mirror(*id),
                name: member.name().trim().to_owned(),
            })
        };
        let wheels: Vec<Wheel> = members.filter_map(wheel).collect();
        let has = |right| wheels.iter().any(|wheel| wheel.is_right == right);
        (has(false) && has(true)).then_some(Self { wheels })
    }

    pub(crate) fn wheels(&self) -> &[Wheel] {
        &self.wheels
    }

    /// The wheels of one side, from the front to the rear.
    pub(crate) fn side(&self, right: bool) -> impl Iterator<Item = &Wheel> {
        self.wheels
            .iter()
            .filter(move |wheel| wheel.is_right == right)
    }

    /// From the first axle to the last, in mm.
    pub(crate) fn base_mm(&self, geometry: Geometry) -> f64 {
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
    pub(crate) fn places(&self, geometry: Geometry) -> Vec<Place> {
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

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::model::scan_texts::tests::id;

    /// Odd IDs are left wheels, even ones right wheels.
    pub(crate) fn names(count: u8) -> NamesAndSides {
        let mut names = NamesAndSides::default();
        for number in 1..=count {
            names.change(id(number), |member| {
                member.drives = true;
                member.side = if number % 2 == 0 {
                    Side::Right
                } else {
                    Side::Left
                };
            });
        }
        names
    }

    #[test]
    fn a_vehicle_has_a_wheel_on_either_side() {
        let wheels = |names: &NamesAndSides| Vehicle::of(names).map(|it| it.wheels.len());
        assert_eq!(wheels(&names(2)), Some(2));
        assert_eq!(wheels(&names(1)), None, "no right wheel");
        assert_eq!(wheels(&NamesAndSides::default()), None);
        let mut names = names(4);
        names.change(id(3), |member| member.side = Side::None);
        assert_eq!(wheels(&names), Some(3), "without a side it is no wheel");
        names.change(id(1), |member| member.drives = false);
        assert_eq!(
            wheels(&names),
            None,
            "motors outside the group are no wheels"
        );
    }

    #[test]
    fn wheels_are_placed_from_the_front_to_the_rear_and_the_track_apart() {
        let geometry = Geometry::new(50, 300).unwrap();
        let places = |count| Vehicle::of(&names(count)).unwrap().places(geometry);
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
}
