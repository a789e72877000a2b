//! A vehicle as a robot for ROS 2: its description, the parameters of `diff_drive_controller`, and a launch file.
//!
//! The hardware interface is `ros/motorlink_hardware`.

mod names;

use std::f64::consts::TAU;

use crate::vehicle::{Geometry, Place, Vehicle, Wheel};

const YAML: &str = include_str!("controllers.yaml");
const URDF: &str = include_str!("rover.urdf");
const LAUNCH: &str = include_str!("rover.launch.xml");

/// The lines around a part of a template that is repeated for each wheel.
const EACH: &str = "@EACH_WHEEL@\n";
const END: &str = "@END@\n";

/// A robot with driven wheels.
#[derive(Clone, Copy, Debug)]
pub struct Robot<'a> {
    /// Its wheels.
    pub vehicle: &'a Vehicle,
    /// Its measures.
    pub geometry: Geometry,
    /// Whether its motors tell their position often enough for odometry.
    pub by_position: bool,
    /// Highest speed of a wheel in rpm.
    pub rpm_max: f64,
    /// The change of speed that a motor follows, in rpm per second.
    pub rpm_per_s_max: f64,
}

/// The files of a robot: names and contents. Each names the others.
pub type RobotFiles = [(&'static str, String); 3];

/// `diff_drive_controller` wants as many wheels on the left as on the right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("ROS 2 needs as many wheels on the left as on the right.")]
pub struct UnevenSides;

/// The files of this robot.
///
/// # Errors
///
/// [`UnevenSides`]
pub fn ros2(robot: &Robot<'_>) -> Result<RobotFiles, UnevenSides> {
    let Robot {
        vehicle, geometry, ..
    } = *robot;
    if vehicle.side(false).count() != vehicle.side(true).count() {
        return Err(UnevenSides);
    }
    let (radius_m, track_m) = (geometry.radius_mm() / 1e3, geometry.track_mm() / 1e3);
    let names = names::of_wheels(vehicle);
    let joints = |right: bool| {
        let wheels = vehicle.wheels().iter().zip(&names);
        let of_side = wheels.filter(|(wheel, _)| wheel.is_right == right);
        let joints: Vec<_> = of_side.map(|(_, name)| format!("{name}_joint")).collect();
        joints.join(", ")
    };
    // On the spot, a wheel rolls on a circle around the middle of the vehicle.
    let straight = |rpm: f64| number(rpm / 60.0 * TAU * radius_m);
    let on_the_spot = |rpm: f64| number(rpm / 60.0 * TAU * radius_m / (track_m / 2.0));
    let parts = [
        ("@BY_POSITION@", robot.by_position.to_string()),
        ("@LEFT@", joints(false)),
        ("@RIGHT@", joints(true)),
        ("@SEPARATION@", number(track_m)),
        ("@RADIUS@", number(radius_m)),
        ("@TYRE@", number(geometry.tyre_mm() / 1e3)),
        ("@RPM@", format!("{:.0}", robot.rpm_max)),
        ("@RPM_A_SECOND@", format!("{:.0}", robot.rpm_per_s_max)),
        ("@SPEED@", straight(robot.rpm_max)),
        ("@ACCELERATION@", straight(robot.rpm_per_s_max)),
        ("@TURN@", on_the_spot(robot.rpm_max)),
        ("@TURN_ACCELERATION@", on_the_spot(robot.rpm_per_s_max)),
    ];
    let places = vehicle.places(geometry);
    let wheels = vehicle.wheels().iter().zip(&names).zip(&places);
    let wheels: Vec<_> = wheels
        .map(|((wheel, name), place)| of_wheel(wheel, name, *place))
        .collect();
    Ok([
        ("rover.urdf", fill(&repeat(URDF, &wheels), &parts)),
        ("controllers.yaml", fill(YAML, &parts)),
        ("rover.launch.xml", LAUNCH.to_owned()),
    ])
}

/// What replaces the placeholders in a text.
type Part = (&'static str, String);

/// The parts of a wheel.
fn of_wheel(wheel: &Wheel, name: &str, place: Place) -> Vec<Part> {
    vec![
        ("@WHEEL@", name.to_owned()),
        ("@ID@", wheel.id.get().to_string()),
        ("@MIRRORED@", (wheel.forward_sign() < 0.0).to_string()),
        ("@X@", number(-place.y / 1e3)),
        ("@Y@", number(-place.x / 1e3)),
    ]
}

/// A number with a decimal point: the parameters are doubles, and a whole number would be refused.
fn number(value: f64) -> String {
    // The sum turns -0 into 0.
    format!("{:.4}", value + 0.0)
}

fn fill(text: &str, parts: &[Part]) -> String {
    let put = |text: String, (name, part): &Part| text.replace(name, part);
    parts.iter().fold(text.to_owned(), put)
}

/// Repeats the marked parts of a template for each wheel.
fn repeat(template: &str, wheels: &[Vec<Part>]) -> String {
    let mut text = String::new();
    for (number, piece) in template.split(EACH).enumerate() {
        // The first piece is in front of the first mark.
        let (each, rest) = match piece.split_once(END) {
            Some((each, rest)) if number > 0 => (each, rest),
            _ => ("", piece),
        };
        text.extend(wheels.iter().map(|parts| fill(each, parts)));
        text.push_str(rest);
    }
    text
}
