//! The digital twin: a wheel on the screen that does what the wheel at the motor does.
//!
//! | file | idea |
//! |---|---|
//! | `feed` | what the page tells the twin, and what one frame shows of it |
//! | `motion` | from reports to the angle and speed of this moment |
//! | `course` | the way that the drawn wheel is sent on between two looks at that |
//! | `words` | motion and figures as text |
//! | `blur`, `scale` | what a speed looks like: sharpness, and place on the ring |
//! | `geometry`, `markup` | shapes as path data, elements as text |
//! | `measures`, `gradients`, `artwork`, `dial`, `picture` | the drawing itself |
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
mod markup;
mod measures;
mod motion;
mod painter;
pub(crate) mod panel;
mod picture;
mod scale;
mod texts;
mod turning;

pub use component::DigitalTwin;
pub use feed::{Drawn, TwinFeed};
pub use motion::AngleQuality;
