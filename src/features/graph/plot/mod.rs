//! The graph: what motors reported over the last minutes, as lines over one time axis.
//!
//! | file | idea |
//! |---|---|
//! | `trace` | what can be drawn, and its value in a reply |
//! | `comparison` | what is drawn: traces of one motor, or one trace of several |
//! | `view` | which stretch of time is shown: live, panned or paused |
//! | `columns` | from every reply to the least and greatest of each pixel column |
//! | `lines` | a trace as lines, and the goal as one of the trace it belongs to |
//! | `strokes` | a line in parts that are cheap to draw |
//! | `end_labels` | which line is whose, at their ends |
//! | `scale` | how high an axis reaches, without jumping |
//! | `ticks` | where the time axis has its marks, and what they say |
//! | `layout` | which pixels are the plot's |
//! | `crosshair` | what was reported at one moment |
//! | `keys` | what a key does to the focused graph |
//! | `words` | the graph's name, and its values in words |
//! | `palette` | colours of the style sheet as numbers |
//!
//! All of it is pure and tested natively; the files beside this folder draw it.

pub mod columns;
pub(crate) mod comparison;
pub(crate) mod crosshair;
pub(crate) mod end_labels;
pub(crate) mod keys;
pub(crate) mod layout;
pub(crate) mod lines;
pub(crate) mod palette;
pub(crate) mod scale;
pub(crate) mod strokes;
pub(crate) mod texts;
pub(crate) mod ticks;
pub(crate) mod trace;
pub(crate) mod view;
