//! The graph: telemetry of the last minutes as lines over one time axis.
//!
//! | file | idea |
//! |---|---|
//! | `trace` | the traces, and their values in a reply |
//! | `comparison` | the content: traces of one motor, or one trace of several |
//! | `view` | the shown period: live, panned or paused |
//! | `columns` | decimation to the least and greatest value of each pixel column |
//! | `lines` | traces and goals as lines |
//! | `strokes` | splits a line into parts that are cheap to draw |
//! | `surface`, `svg` | what the graph is drawn on, and a vector picture as such |
//! | `end_labels` | labels at the ends of lines |
//! | `scale` | the range of an axis, with hysteresis |
//! | `marks` | commands and events on the time axis |
//! | `ticks` | the marks of the time axis and their labels |
//! | `layout` | the division into plot and labels |
//! | `crosshair` | the values at one moment |
//! | `keys` | the actions of keys on the focused graph |
//! | `texts` | the graph's name, and its values as text |
//! | `palette` | the colours of the style sheet as numbers |
//!
//! All of it is pure and tested natively; the files beside this folder draw it.

pub mod columns;
pub(crate) mod comparison;
pub(crate) mod crosshair;
pub(crate) mod end_labels;
pub(crate) mod keys;
pub(crate) mod layout;
pub(crate) mod lines;
pub(crate) mod marks;
pub(crate) mod palette;
pub(crate) mod scale;
pub(crate) mod strokes;
pub(crate) mod surface;
pub(crate) mod svg;
pub(crate) mod texts;
pub(crate) mod ticks;
pub(crate) mod trace;
pub(crate) mod view;
