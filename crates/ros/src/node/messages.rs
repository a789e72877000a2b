//! The ROS messages that this program sends and takes, as CDR. The fields and their order are those of the definitions of ROS 2
//! (Humble and later); `HASH` is the hash of each definition (REP 2016), in the form RIHS01.

use byteorder::{BigEndian, LittleEndian};
use cdr_encoding::{from_bytes, to_vec};
use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// Representation header: CDR, little-endian.
const HEADER: [u8; 4] = [0, 1, 0, 0];

/// A type with a name in ROS.
pub trait RosType {
    /// As `sensor_msgs::msg::dds_::JointState_`.
    const NAME: &'static str;
    /// 64 hexadecimal digits.
    const HASH: &'static str;
}

/// The bytes of a message with its header.
#[must_use]
pub fn encode<T: Serialize>(message: &T) -> Vec<u8> {
    // It fails only for types that CDR does not have, and for more than 4 GB.
    let body = to_vec::<T, LittleEndian>(message).unwrap_or_default();
    [&HEADER[..], &body].concat()
}

/// Reads a message with its header; `None` if it is none.
#[must_use]
pub fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    let (header, body) = bytes.split_first_chunk::<4>()?;
    let read = match *header {
        [0, 1, _, _] => from_bytes::<T, LittleEndian>(body),
        [0, 0, _, _] => from_bytes::<T, BigEndian>(body),
        _ => return None,
    };
    read.ok().map(|(message, _)| message)
}

/// Seconds and nanoseconds since 1970.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Time {
    /// Seconds.
    pub sec: i32,
    /// Nanoseconds within the second.
    pub nanosec: u32,
}

/// When, and in which frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// When the values were measured.
    pub stamp: Time,
    /// Their frame.
    pub frame_id: String,
}

/// Three axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Vector3 {
    /// Ahead.
    pub x: f64,
    /// To the left.
    pub y: f64,
    /// Up.
    pub z: f64,
}

/// A direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Quaternion {
    /// First.
    pub x: f64,
    /// Second.
    pub y: f64,
    /// Third.
    pub z: f64,
    /// Real part.
    pub w: f64,
}

/// `geometry_msgs/msg/Twist`: m/s and rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Twist {
    /// In m/s.
    pub linear: Vector3,
    /// In rad/s, counter-clockwise seen from above about `z`.
    pub angular: Vector3,
}

impl RosType for Twist {
    const NAME: &'static str = "geometry_msgs::msg::dds_::Twist_";
    const HASH: &'static str = "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a";
}

/// `geometry_msgs/msg/TwistStamped`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TwistStamped {
    /// When it was sent.
    pub header: Header,
    /// What is asked.
    pub twist: Twist,
}

impl RosType for TwistStamped {
    const NAME: &'static str = "geometry_msgs::msg::dds_::TwistStamped_";
    const HASH: &'static str = "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64";
}

/// `sensor_msgs/msg/JointState`: rad, rad/s, N.m.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointState {
    /// When the newest of them was measured.
    pub header: Header,
    /// The joints.
    pub name: Vec<String>,
    /// One for each joint.
    pub position: Vec<f64>,
    /// One for each joint.
    pub velocity: Vec<f64>,
    /// One for each joint, or none.
    pub effort: Vec<f64>,
}

impl RosType for JointState {
    const NAME: &'static str = "sensor_msgs::msg::dds_::JointState_";
    const HASH: &'static str = "a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e";
}

/// `sensor_msgs/msg/Temperature`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Temperature {
    /// When it was measured.
    pub header: Header,
    /// In degrees Celsius.
    pub temperature: f64,
    /// 0: unknown.
    pub variance: f64,
}

impl RosType for Temperature {
    const NAME: &'static str = "sensor_msgs::msg::dds_::Temperature_";
    const HASH: &'static str = "72514a14126ab9f8a9abec974c78e5610a367b59db5da355ff1fb982d5bad4b8";
}

/// Place and direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// In metres.
    pub position: Vector3,
    /// The direction.
    pub orientation: Quaternion,
}

/// Six by six, row by row: x, y, z, and the rotations about them.
pub type Covariance = [[f64; 6]; 6];

/// `nav_msgs/msg/Odometry`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Odometry {
    /// When, and the frame of the pose.
    pub header: Header,
    /// The frame of the twist.
    pub child_frame_id: String,
    /// Where the robot is.
    pub pose: Pose,
    /// How far off that may be.
    pub pose_covariance: Covariance,
    /// How it moves.
    pub twist: Twist,
    /// How far off that may be.
    pub twist_covariance: Covariance,
}

impl RosType for Odometry {
    const NAME: &'static str = "nav_msgs::msg::dds_::Odometry_";
    const HASH: &'static str = "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0";
}

/// Where a frame is in another.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TransformStamped {
    /// When, and in which frame.
    pub header: Header,
    /// The frame that is there.
    pub child_frame_id: String,
    /// In metres.
    pub translation: Vector3,
    /// The direction.
    pub rotation: Quaternion,
}

/// `tf2_msgs/msg/TFMessage`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TfMessage {
    /// The frames.
    pub transforms: Vec<TransformStamped>,
}

impl RosType for TfMessage {
    const NAME: &'static str = "tf2_msgs::msg::dds_::TFMessage_";
    const HASH: &'static str = "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087";
}

/// A figure of a [`DiagnosticStatus`].
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeyValue {
    /// What it is.
    pub key: String,
    /// With its unit.
    pub value: String,
}

/// How a part of the robot is.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DiagnosticStatus {
    /// 0 OK, 1 a warning, 2 an error, 3 stale.
    pub level: u8,
    /// The part.
    pub name: String,
    /// One sentence.
    pub message: String,
    /// The hardware.
    pub hardware_id: String,
    /// Figures.
    pub values: Vec<KeyValue>,
}

/// `diagnostic_msgs/msg/DiagnosticArray`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DiagnosticArray {
    /// When.
    pub header: Header,
    /// The parts.
    pub status: Vec<DiagnosticStatus>,
}

impl RosType for DiagnosticArray {
    const NAME: &'static str = "diagnostic_msgs::msg::dds_::DiagnosticArray_";
    const HASH: &'static str = "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e";
}

/// `std_srvs/srv/Trigger`: a request without content.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TriggerResponse {
    /// Whether it was done.
    pub success: bool,
    /// What was done, or why not.
    pub message: String,
}

/// The service that [`TriggerResponse`] answers.
#[derive(Debug)]
pub struct Trigger;

impl RosType for Trigger {
    const NAME: &'static str = "std_srvs::srv::dds_::Trigger_";
    const HASH: &'static str = "eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f";
}
