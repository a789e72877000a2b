//! The command line.

use std::{path::PathBuf, time::Duration};

use anyhow::{Context as _, Result, anyhow, bail};
use clap::Parser;
use motorlink_protocol::MotorId;
use zenoh::{Config, config::EndPoint};

use crate::{
    fleet::names::{RobotName, page_url},
    node::names::NodeName,
    odometry::OdometrySource,
    rover::{Rover, Wheel},
};

/// ROS 2 topics for the motors of a running motorlink, over Zenoh (as `rmw_zenoh`), without ROS installed.
///
/// Start `motorlink serve --socket PATH` first, and a Zenoh router (`ros2 run rmw_zenoh_cpp rmw_zenohd`, or `zenohd`).
///
/// The motors turn the wheels directly, with up to 2 N·m. THE POWER SWITCH IS THE ONLY EMERGENCY STOP: if the cable or the computer
/// fails, the wheels may keep turning.
#[derive(Debug, Parser)]
#[command(version, name = "motorlink-ros")]
pub struct Arguments {
    /// The socket of motorlink.
    #[arg(long, default_value = "/run/motorlink/socket")]
    pub socket: PathBuf,
    /// Motors on the left, from the front to the rear: IDs, each with its joint if that is not `left_wheel_joint`. `1` or `1=front_left_joint,3=rear_left_joint`.
    #[arg(
        long,
        value_delimiter = ',',
        required = true,
        value_name = "ID[=JOINT]"
    )]
    pub left: Vec<String>,
    /// Motors on the right, mounted mirrored.
    #[arg(
        long,
        value_delimiter = ',',
        required = true,
        value_name = "ID[=JOINT]"
    )]
    pub right: Vec<String>,
    /// Radius of the wheels in m. That of a DDSM115 is 0.0511.
    #[arg(long, value_name = "M")]
    pub wheel_radius: f64,
    /// Distance between the middles of the left and the right wheels in m.
    #[arg(long, value_name = "M")]
    pub track: f64,
    /// No wheel turns faster, in rpm. A command that is too fast is made slower as a whole.
    #[arg(long, default_value_t = 200.0, value_name = "RPM")]
    pub max_rpm: f64,
    /// A command counts for so long, in s. Then the motors are stopped.
    #[arg(long, default_value_t = 0.5, value_name = "S")]
    pub cmd_vel_timeout: f64,
    /// Messages of `joint_states`, odom and /tf a second.
    #[arg(long, default_value_t = 50.0, value_name = "HZ")]
    pub rate: f64,
    /// From what the way of a wheel is known. Without it, the model decides: a DDSM210 or DDSM400 tells its position too rarely.
    #[arg(long, value_enum)]
    pub odometry: Option<OdometrySource>,
    /// N·m/A, for `effort` in `joint_states`. None is built in: measure yours.
    #[arg(long, value_name = "NM_PER_A")]
    pub torque_constant: Option<f64>,
    /// Namespace of the node, for several robots.
    #[arg(long, default_value = "")]
    pub namespace: String,
    /// Name of the node.
    #[arg(long, default_value = "motorlink")]
    pub node: String,
    /// Domain.
    #[arg(long, env = "ROS_DOMAIN_ID", default_value_t = 0)]
    pub domain: u16,
    /// Put before the frames `odom` and `base_link`: `robot1/`.
    #[arg(long, default_value = "")]
    pub frame_prefix: String,
    /// Sends no transform from `odom` to `base_link`: another node does.
    #[arg(long)]
    pub no_tf: bool,
    /// The way to the Zenoh network.
    #[command(flatten)]
    pub network: Network,
    /// Name of the robot in the fleet: a-z A-Z 0-9 _ -. Usually the namespace, or the name of this computer.
    #[arg(long, value_name = "NAME")]
    pub robot: Option<String>,
    /// Where `motorlink serve` shows its page, for the fleet.
    #[arg(long, value_name = "URL", value_parser = page_url)]
    pub page: Option<String>,
    /// Session files for the fleet: the folder of `motorlink serve --log`.
    #[arg(long, value_name = "FOLDER")]
    pub sessions: Option<PathBuf>,
}

/// The way to the Zenoh network.
#[derive(Debug, clap::Args)]
pub struct Network {
    /// Where the Zenoh router is.
    #[arg(
        long,
        global = true,
        default_value = "tcp/localhost:7447",
        value_name = "ENDPOINT"
    )]
    pub connect: Vec<String>,
    /// Configuration of the Zenoh session instead, as for `rmw_zenoh`.
    #[arg(
        long,
        global = true,
        env = "ZENOH_SESSION_CONFIG_URI",
        value_name = "FILE"
    )]
    pub config: Option<PathBuf>,
}

impl Arguments {
    /// The rover that they describe.
    ///
    /// # Errors
    ///
    /// For an invalid ID, one that appears twice, and for a measure that no rover has.
    pub fn rover(&self) -> Result<Rover> {
        let mut wheels: Vec<Wheel> = Vec::new();
        for (texts, is_right) in [(&self.left, false), (&self.right, true)] {
            for text in texts {
                let usual = match (is_right, texts.len()) {
                    (false, 1) => "left_wheel_joint".to_owned(),
                    (true, 1) => "right_wheel_joint".to_owned(),
                    _ => String::new(),
                };
                let (id, joint) = text.split_once('=').unwrap_or((text, &usual));
                let id = id.parse().ok().and_then(|id| MotorId::new(id).ok());
                let id = id.with_context(|| format!("{text}: an ID is 1 to 254"))?;
                let joint = match joint {
                    "" => format!("wheel_{}_joint", id.get()),
                    joint => joint.to_owned(),
                };
                if wheels
                    .iter()
                    .any(|wheel| wheel.id == id || wheel.joint == joint)
                {
                    bail!("{text}: another wheel has this ID or joint");
                }
                wheels.push(Wheel {
                    id,
                    joint,
                    is_right,
                });
            }
        }
        if wheels.len() > motorlink_controller_messages::MOTORS_MAX {
            bail!("{} wheels: 8 are driven together at most", wheels.len());
        }
        let in_range = |name: &str, value: f64, least: f64, most: f64| {
            if (least..=most).contains(&value) {
                Ok(value)
            } else {
                bail!("--{name} {value}: {least} to {most}")
            }
        };
        in_range("cmd-vel-timeout", self.cmd_vel_timeout, 0.05, 0.5)?;
        in_range("rate", self.rate, 1.0, 100.0)?;
        if let Some(constant) = self.torque_constant {
            in_range("torque-constant", constant, 0.01, 10.0)?;
        }
        Ok(Rover {
            wheels,
            radius_m: in_range("wheel-radius", self.wheel_radius, 0.01, 0.5)?,
            track_m: in_range("track", self.track, 0.05, 3.0)?,
            speed_max_rad_per_s: in_range("max-rpm", self.max_rpm, 1.0, 330.0)?
                * std::f64::consts::TAU
                / 60.0,
        })
    }

    /// For how long a command counts.
    #[must_use]
    pub fn timeout(&self) -> Duration {
        Duration::from_secs_f64(self.cmd_vel_timeout)
    }

    /// The node.
    ///
    /// # Errors
    ///
    /// For a name that is none in ROS.
    pub fn node_name(&self) -> Result<NodeName> {
        NodeName::new(self.domain, &self.namespace, &self.node)
    }

    /// Its name in the fleet.
    ///
    /// # Errors
    ///
    /// For a name that is none.
    pub fn robot_name(&self) -> Result<RobotName> {
        RobotName::choose(self.robot.as_deref(), &self.namespace)
    }

    /// The session: as that of `rmw_zenoh`, a peer that finds others by its router.
    ///
    /// # Errors
    ///
    /// For a file that is no configuration, and an endpoint that is none.
    pub fn zenoh(&self) -> Result<Config> {
        self.network.configuration(&[
            ("mode", "\"peer\""),
            ("listen/endpoints", "[\"tcp/localhost:0\"]"),
        ])
    }
}

impl Network {
    /// That of the file, else one with these settings.
    ///
    /// # Errors
    ///
    /// For a file that is no configuration, and an endpoint that is none.
    pub fn configuration(&self, settings: &[(&str, &str)]) -> Result<Config> {
        if let Some(file) = &self.config {
            return Config::from_file(file).map_err(|error| anyhow!("{}: {error}", file.display()));
        }
        let mut config = Config::default();
        let connect = self.connect.iter().map(|endpoint| {
            let parsed: Result<EndPoint, _> = endpoint.parse();
            parsed.map(|_| format!("{endpoint:?}")).map_err(|_| {
                anyhow!("--connect {endpoint}: PROTOCOL/ADDRESS, as tcp/localhost:7447")
            })
        });
        let connect = connect.collect::<Result<Vec<_>>>()?.join(",");
        let usual = [
            ("connect/endpoints", &*format!("[{connect}]")),
            ("scouting/multicast/enabled", "false"),
        ];
        for (key, value) in usual.iter().chain(settings) {
            config
                .insert_json5(key, value)
                .map_err(|error| anyhow!("{key} {value}: {error}"))?;
        }
        Ok(config)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rover(arguments: &[&str]) -> Result<Rover> {
        let all = ["motorlink-ros", "--wheel-radius", "0.05", "--track", "0.3"];
        let all = all.iter().chain(arguments);
        Arguments::try_parse_from(all)?.rover()
    }

    #[test]
    fn wheels_have_joints() {
        let joints = |arguments: &[&str]| -> Vec<String> {
            let wheels = rover(arguments).unwrap().wheels;
            wheels.into_iter().map(|wheel| wheel.joint).collect()
        };
        assert_eq!(
            joints(&["--left", "1", "--right", "2"]),
            ["left_wheel_joint", "right_wheel_joint"]
        );
        assert_eq!(
            joints(&["--left", "1=a,3", "--right", "2,4=d"]),
            ["a", "wheel_3_joint", "wheel_2_joint", "d"]
        );
    }

    #[test]
    fn what_is_no_rover_is_an_error() {
        for wrong in [
            &["--left", "1"][..],
            &["--left", "1", "--right", "1"],
            &["--left", "0", "--right", "1"],
            &["--left", "1=a", "--right", "2=a"],
            &["--left", "1,2,3,4,5", "--right", "6,7,8,9"],
            &["--left", "1", "--right", "2", "--max-rpm", "NaN"],
            &["--left", "1", "--right", "2", "--cmd-vel-timeout", "0.6"],
            &["--left", "1", "--right", "2", "--rate", "0"],
            &["--left", "1", "--right", "2", "--rate", "101"],
        ] {
            assert!(rover(wrong).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn an_endpoint_that_is_none_is_named() {
        let usual = "motorlink-ros --wheel-radius 0.05 --track 0.3 --left 1 --right 2 --connect";
        let config = |endpoint: &str| {
            let words = usual.split(' ').chain([endpoint]);
            Arguments::try_parse_from(words).unwrap().zenoh()
        };
        assert!(config("tcp/rover.local:7447").is_ok());
        let error = config("rover.local").unwrap_err().to_string();
        assert!(error.starts_with("--connect rover.local: "), "{error}");
    }
}
