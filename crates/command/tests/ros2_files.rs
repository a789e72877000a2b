//! The files of a robot for ROS 2 that `motorlink-experiments` generates: parsed, and their kinematics against those
//! of the page.

use std::{f64::consts::TAU, fs, process::Command};

use motorlink_experiments::{
    generate::{Robot, UnevenSides, ros2},
    vehicle::{Geometry, Motion, Vehicle, Wheel},
};
use motorlink_protocol::MotorId;

/// The greatest relative difference from the page's kinematics.
const TOLERANCE: f64 = 1e-3;

/// Right wheels first, and IDs not in the order of the places.
fn vehicle(right: u8, left: u8) -> Vehicle {
    let wheel = |number: u8| Wheel {
        id: MotorId::new(40 - number).unwrap(),
        is_right: number < right,
        name: ["Front right", "", "左"][usize::from(number) % 3].to_owned(),
    };
    Vehicle::new((0..right + left).map(wheel).collect()).unwrap()
}

/// What `check_ros2.py` prints about the files of this robot.
fn checked(vehicle: &Vehicle, geometry: Geometry) -> Result<String, UnevenSides> {
    let files = ros2(&Robot {
        vehicle,
        geometry,
        by_position: true,
        rpm_max: 200.0,
        rpm_per_s_max: 250.0,
    })?;
    let dir = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(dir.path().join(name), text).unwrap();
    }
    let check = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/generated/check_ros2.py");
    let mut command = Command::new(crate::tools::python());
    command.arg(check).arg(dir.path());
    Ok(crate::tools::run(&mut command, "python cannot be started"))
}

fn assert_near(value: f64, expected: f64, what: &str) {
    let scale = expected.abs().max(1e-3);
    assert!(
        (value - expected).abs() <= TOLERANCE * scale,
        "{what}: {value}, not {expected}"
    );
}

#[test]
fn the_robot_of_two_four_and_six_wheels_moves_as_on_the_page() {
    for (count, geometry) in [(1, (51, 300)), (2, (53, 417)), (3, (101, 777))] {
        let vehicle = vehicle(count, count);
        let geometry = Geometry::new(geometry.0, geometry.1).unwrap();
        let said = checked(&vehicle, geometry).unwrap();
        let mut motions = 0;
        for line in said.lines().filter(|line| line.contains('=')) {
            let mut words = line.split(' ');
            let mut asked = || words.next().unwrap().parse::<f64>().unwrap();
            let (ahead_m_s, left_rad_s) = (asked(), asked());
            let on_wire: Vec<(u8, f64)> = words
                .map(|word| word.split_once('=').unwrap())
                .map(|(motor, rpm)| (motor.parse().unwrap(), rpm.parse().unwrap()))
                .collect();
            assert_eq!(on_wire.len(), usize::from(2 * count));
            let rpm = |wheel: &Wheel| {
                let mut motors = on_wire.iter();
                let (_, rpm) = motors.find(|(motor, _)| *motor == wheel.id.get()).unwrap();
                Some(wheel.forward_sign() * rpm)
            };
            let rpm: Vec<_> = vehicle.wheels().iter().map(rpm).collect();
            let motion = Motion::of(&vehicle, geometry, &rpm).unwrap();
            assert_near(motion.forward_mm_per_s / 1e3, ahead_m_s, line);
            // The page counts turns to the right.
            assert_near(-motion.turn_deg_per_s.to_radians(), left_rad_s, line);
            motions += 1;
        }
        assert_eq!(motions, 6);
        // Straight ahead at the limit, the wheels turn at theirs; on the spot too.
        let ahead = TAU * geometry.radius_mm() / 1e3 / 60.0;
        let turn = ahead / (geometry.track_mm() / 2e3);
        for (axis, per_rpm) in [("linear ", ahead), ("angular ", turn)] {
            let limits = said.lines().find_map(|line| line.strip_prefix(axis));
            let (speed, acceleration) = limits.unwrap().split_once(' ').unwrap();
            assert_near(speed.parse().unwrap(), 200.0 * per_rpm, axis);
            assert_near(acceleration.parse().unwrap(), 250.0 * per_rpm, axis);
        }
    }
}

#[test]
fn sides_with_different_numbers_of_wheels_are_refused() {
    assert_eq!(
        checked(&vehicle(2, 1), Geometry::default()),
        Err(UnevenSides)
    );
}
