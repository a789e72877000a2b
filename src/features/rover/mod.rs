//! The rover: a group of motors with sides as a vehicle, seen from above.
//!
//! | file | idea |
//! |---|---|
//! | `angle_judge` | whether the angle of a wheel follows its speed |
//! | `wheel_track` | how far a wheel has rolled, from its replies |
//! | `odometry` | the motion of the vehicle, from its wheels |
//! | `path` | the path driven, with a bounded number of points |
//! | `trip` | feeds the history of the motors to the odometry |
//! | `arrow` | the arrow of a motion |
//! | `picture`, `tread` | the drawing as markup, and its turning treads |
//! | `readings`, `texts` | what is said beside the drawing |
//! | `painter`, `panel`, `state` | the browser: attributes, views, what a person sets |
//! | `geometry`, `geometry_fields` | the fields of wheel radius and track width |
//!
//! Which motors are the wheels is in [`crate::model::vehicle`], their kinematics in
//! [`motorlink_messages::experiments::vehicle`].

pub(crate) mod angle_judge;
pub(crate) mod arrow;
pub(crate) mod geometry;
pub(crate) mod geometry_fields;
pub(crate) mod odometry;
pub(crate) mod painter;
pub(crate) mod panel;
pub(crate) mod path;
pub(crate) mod picture;
pub(crate) mod readings;
pub(crate) mod state;
pub(crate) mod texts;
pub(crate) mod tread;
pub(crate) mod trip;
pub(crate) mod wheel_track;
