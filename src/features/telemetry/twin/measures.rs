//! The wheel of a DDSM115 and the dial in millimetres from the axle. Others differ by their [`Look`].
//!
//! [`Look`]: crate::features::telemetry::twin::look::Look
//!
//! The wheel has a diameter of 102 mm, its shaft 15.2 mm with a flat of 8 mm, and three M2.5 screws hold its front
//! cover. These are the maker's figures; the rest is estimated.

/// Running surface of the tread.
pub const TYRE: f64 = 51.0;
/// Bottom of the gaps between tread blocks.
pub const CARCASS: f64 = 49.5;
/// Outer edge of the sidewall.
pub const SIDEWALL: f64 = 44.9;
/// Inner end of the tread blocks, under the edge of the sidewall.
pub const SHOULDER: f64 = 44.2;

/// Aluminium hub, up to the bead of the tyre.
pub const HUB: f64 = 38.0;
/// Inner edge of the hub's lip.
pub const LIP: f64 = 36.6;
/// Face of the hub, inside the step below the lip.
pub const FACE: f64 = 35.8;
/// Circle on which the holes are.
pub const HOLES: f64 = 31.9;
/// Radius of a hole.
pub const HOLE: f64 = 1.75;

/// Black front cover.
pub const COVER: f64 = 27.6;
/// Face of the cover, inside the bevelled edge.
pub const COVER_FACE: f64 = 26.6;
/// Step around the middle of the cover.
pub const STEP: f64 = 12.6;
/// Circle on which the screws are.
pub const SCREWS: f64 = 19.4;
/// Radius of a screw's head: M2.5.
pub const SCREW: f64 = 2.35;

/// Opening in the cover around the shaft.
pub const RECESS: f64 = 9.4;
/// The shaft.
pub const AXLE: f64 = 7.6;
/// Length of the flat on it.
pub const AXLE_FLAT: f64 = 8.0;

/// The wheel's shadow on the page. [`SHADOW_DROP`] is its distance below the wheel.
pub const SHADOW: f64 = 57.5;
/// See [`SHADOW`].
pub const SHADOW_DROP: f64 = 3.2;

/// Middle of the speed ring.
pub const RING: f64 = 56.8;
/// Start of the ticks.
pub const TICKS: f64 = 59.8;
/// End of the short ticks.
pub const TICKS_SHORT: f64 = 61.2;
/// End of the long ticks.
pub const TICKS_LONG: f64 = 62.8;
/// Middle of the labels at the ticks.
pub const FIGURES: f64 = 68.4;
