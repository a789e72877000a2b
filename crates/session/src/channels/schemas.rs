//! JSON schemas of the messages. Foxglove requires the encoding `jsonschema`, messages in `json`, and an object at
//! the top: <https://docs.foxglove.dev/docs/sdk/schemas>.

/// A name and a schema.
pub(crate) type Schema = (&'static str, &'static str);

pub(crate) const WIRE: Schema = ("motorlink.Wire", include_str!("wire.schema.json"));
pub(crate) const TELEMETRY: Schema = ("motorlink.Telemetry", include_str!("telemetry.schema.json"));
pub(crate) const EVENT: Schema = ("motorlink.Event", include_str!("event.schema.json"));
pub(crate) const LINK: Schema = ("motorlink.Link", include_str!("link.schema.json"));

// As ROS 2 names them, which Foxglove knows.
pub(crate) const ODOMETRY: Schema = (
    "nav_msgs/msg/Odometry",
    include_str!("odometry.schema.json"),
);
pub(crate) const TWIST: Schema = (
    "geometry_msgs/msg/TwistStamped",
    include_str!("twist.schema.json"),
);
