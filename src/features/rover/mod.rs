//! The rover: a group of motors with sides as a vehicle, seen from above.
//!
//! | file | idea |
//! |---|---|
//! | `path` | the path driven, with a bounded number of points |
//! | `trip` | feeds the history of the motors to the odometry |
//! | `arrow` | the arrow of a motion |
//! | `picture`, `tread` | the drawing as markup, and its turning treads |
//! | `group` | the cards of a group that is driven |
//! | `readings`, `texts` | what is said beside the drawing |
//! | `painter`, `panel`, `state` | the browser: attributes, views, what a person sets |
//! | `geometry`, `geometry_fields` | the fields of wheel radius and track width |
//!
//! Which motors are the wheels is in [`crate::model::vehicle`], their kinematics in
//! [`motorlink_messages::experiments::vehicle`], the motion from their replies in
//! [`motorlink_messages::experiments::odometry`].

pub(crate) mod arrow;
pub(crate) mod geometry;
pub(crate) mod geometry_fields;
pub(crate) mod group;
pub(crate) mod painter;
pub(crate) mod panel;
pub(crate) mod path;
pub(crate) mod picture;
pub(crate) mod readings;
pub(crate) mod state;
pub(crate) mod texts;
pub(crate) mod tread;
pub(crate) mod trip;
