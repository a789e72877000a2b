//! The rover: a group of motors with sides as a vehicle, seen from above.
//!
//! | file | idea |
//! |---|---|
//! | `geometry` | wheel radius and track width, entered once and stored |
//! | `vehicle` | which motors are the wheels, and where they are |
//! | `wheel_track` | how far a wheel has rolled, from its replies |
//! | `odometry` | the motion of the vehicle, from its wheels |
//! | `path` | the path driven, with a bounded number of points |
//! | `trip` | feeds the history of the motors to the odometry |
//! | `motion` | speed and turn rate from wheel speeds, and their arrows |
//! | `picture`, `tread` | the drawing as markup, and its turning treads |
//! | `readings`, `texts` | what is said beside the drawing |
//! | `painter`, `panel`, `state`, `geometry_fields` | the browser: attributes, views, what a person sets |

pub(crate) mod geometry;
pub(crate) mod geometry_fields;
pub(crate) mod motion;
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
pub(crate) mod vehicle;
pub(crate) mod wheel_track;
