//! The wheel and its dial in millimetres from the axle.
//!
//! The wheel is 102 mm across, its shaft 15.2 mm with a flat of 8 mm, and its front cover is held by
//! three M2.5 screws: the maker's figures. The rest is by eye.

/// Running surface of the tread.
pub const TYRE: f64 = 51.0;
/// Ground of the gaps between tread blocks.
pub const CARCASS: f64 = 49.5;
/// Where the sidewall ends.
pub const SIDEWALL: f64 = 44.9;
/// Where the tread blocks begin, under the sidewall's edge.
pub const SHOULDER: f64 = 44.2;
/// Tread blocks round the turn.
pub const TREAD_BLOCKS: u16 = 32;

/// Aluminium hub, out to the bead of the tyre.
pub const HUB: f64 = 38.0;
/// Inside of its lip.
pub const LIP: f64 = 36.6;
/// Its face, inside the step below the lip.
pub const FACE: f64 = 35.8;
/// Circle of the holes.
pub const HOLES: f64 = 31.9;
/// Radius of a hole.
pub const HOLE: f64 = 1.75;
/// Holes round the turn.
pub const HOLE_COUNT: u16 = 18;

/// Black front cover.
pub const COVER: f64 = 27.6;
/// Its face, inside the bevelled edge.
pub const COVER_FACE: f64 = 26.6;
/// Step round the middle of the cover.
pub const STEP: f64 = 12.6;
/// Circle of the screws.
pub const SCREWS: f64 = 19.4;
/// Radius of a screw's head: M2.5.
pub const SCREW: f64 = 2.35;

/// Opening in the cover round the shaft.
pub const RECESS: f64 = 9.4;
/// The shaft.
pub const AXLE: f64 = 7.6;
/// Length of the flat on it.
pub const AXLE_FLAT: f64 = 8.0;

/// The wheel's shadow on the page, and how far below the wheel it lies.
pub const SHADOW: f64 = 57.5;
/// See [`SHADOW`].
pub const SHADOW_DROP: f64 = 3.2;

/// Middle of the speed ring.
pub const RING: f64 = 56.8;
/// Where ticks begin.
pub const TICKS: f64 = 59.8;
/// Where the short ones end.
pub const TICKS_SHORT: f64 = 61.2;
/// Where the long ones end.
pub const TICKS_LONG: f64 = 62.8;
/// Middle of the figures at the ticks.
pub const FIGURES: f64 = 68.4;
