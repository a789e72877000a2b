//! A setup for ROS 2: `diff_drive_controller` on the hardware interface of `lazytatzv/ddsm115_driver`.

use motorlink_protocol::MotorId;

use super::plain;

const YAML: &str = include_str!("controllers.yaml");
const URDF: &str = include_str!("ros2_control.urdf");

/// A robot with two driven wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ros2<'a> {
    /// The serial port.
    pub port: &'a str,
    /// The motor of the left wheel.
    pub left: MotorId,
    /// The motor of the right wheel, which is mounted mirrored.
    pub right: MotorId,
    /// Distance between the middles of the wheels, in m.
    pub wheel_separation_m: f64,
    /// Radius of a wheel in m; 0.0503 for the bare wheel of the DDSM115.
    pub wheel_radius_m: f64,
    /// Highest speed of a wheel in rpm.
    pub rpm_max: f64,
}

/// The two files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ros2Files {
    /// Parameters of the controller manager and of `diff_drive_controller`.
    pub controllers_yaml: String,
    /// The `ros2_control` part of the robot's description.
    pub urdf: String,
}

/// The files of this robot.
#[must_use]
pub fn ros2(robot: &Ros2<'_>) -> Ros2Files {
    let rad_s = robot.rpm_max * std::f64::consts::TAU / 60.0;
    let metres_s = rad_s * robot.wheel_radius_m;
    let turn_rad_s = 2.0 * metres_s / robot.wheel_separation_m;
    let parts = [
        ("@PORT@", plain(robot.port)),
        ("@LEFT@", robot.left.get().to_string()),
        ("@RIGHT@", robot.right.get().to_string()),
        ("@SEPARATION@", format!("{:.4}", robot.wheel_separation_m)),
        ("@RADIUS@", format!("{:.4}", robot.wheel_radius_m)),
        ("@METRES_S@", format!("{metres_s:.3}")),
        ("@TURN_RAD_S@", format!("{turn_rad_s:.3}")),
    ];
    let put = |text: String, (name, part): &(&str, String)| text.replace(name, part);
    let fill = |text: &str| parts.iter().fold(text.to_owned(), put);
    Ros2Files {
        controllers_yaml: fill(YAML),
        urdf: fill(URDF),
    }
}
