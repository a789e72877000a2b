//! The setpoints of a group for the speeds of a vehicle's wheels.

use motorlink_messages::{
    bus::{GroupError, GroupSetpoints},
    protocol::{MotorId, Setpoint, SpeedTarget},
};

use crate::model::names_and_sides::Side;

/// Speeds of a vehicle's sides in rpm; + is forward on both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Wheels {
    pub(crate) left: i32,
    pub(crate) right: i32,
}

impl Wheels {
    /// The speed of a motor on this side, in rpm: + is counter-clockwise, seen from its face.
    const fn rpm(self, side: Side) -> i32 {
        match side {
            Side::None | Side::Left => self.left,
            Side::Right => -self.right,
        }
    }
}

/// The setpoints for these speeds of the vehicle's wheels.
pub(crate) fn group_setpoints(
    members: &[(MotorId, Side)],
    wheels: Wheels,
) -> Result<GroupSetpoints, GroupError> {
    let part = |(id, side): &(MotorId, Side)| {
        let speed = SpeedTarget::clamped(wheels.rpm(*side));
        (*id, Setpoint::velocity(speed))
    };
    let setpoints: Vec<_> = members.iter().map(part).collect();
    GroupSetpoints::new(&setpoints)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scan_texts::tests::id;

    fn speeds(members: &[(MotorId, Side)], left: i32, right: i32) -> Vec<(u8, i16)> {
        let setpoints = group_setpoints(members, Wheels { left, right }).unwrap();
        let speed = |(id, setpoint): (MotorId, Setpoint)| match setpoint {
            Setpoint::Velocity { speed, .. } => (id.get(), speed.rpm()),
            other => panic!("{other:?}"),
        };
        setpoints.entries().map(speed).collect()
    }

    #[test]
    fn the_right_wheel_is_mirrored() {
        let members = [(id(1), Side::Left), (id(2), Side::Right)];
        assert_eq!(speeds(&members, 100, 100), [(1, 100), (2, -100)], "forward");
        assert_eq!(speeds(&members, 50, -50), [(1, 50), (2, 50)], "on the spot");
        assert_eq!(speeds(&[(id(3), Side::None)], -20, -20), [(3, -20)]);
        assert_eq!(speeds(&members, 999, 999), [(1, 380), (2, -380)]);
        let wheels = Wheels { left: 1, right: 1 };
        assert_eq!(group_setpoints(&[], wheels), Err(GroupError::Empty));
    }
}
