//! The digital twin: a drawn wheel that moves as the wheel at the motor.
//!
//! | file | idea |
//! |---|---|
//! | `feed` | the data of the twin, and the content of one frame |
//! | `motion` | estimates the present angle and speed from reports |
//! | `course` | the planned motion of the wheel between two updates |
//! | `texts` | motion and figures as text |
//! | `blur`, `scale` | sharpness at a speed, and its position on the ring |
//! | `geometry`, `markup` | shapes as path data, elements as text |
//! | `look`, `measures`, `gradients`, `artwork`, `dial`, `picture` | the drawing itself |
//! | `painter`, `turning`, `component` | the browser: attributes, the turning layer, the view |
//!
//! Only the last row touches a browser; the rest is pure and tested natively.

mod artwork;
mod blur;
mod component;
mod course;
mod dial;
mod feed;
mod geometry;
mod gradients;
mod look;
mod markup;
mod measures;
mod motion;
mod painter;
pub(crate) mod panel;
mod picture;
mod scale;
mod texts;
mod turning;

pub(crate) use component::DigitalTwin;
pub use feed::{Drawn, TwinFeed};
pub use motion::AngleQuality;
pub use texts::turns_text;
