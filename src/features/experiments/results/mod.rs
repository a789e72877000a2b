//! Charts and figures of runs, and the tab `Runs`.
//!
//! | file | idea |
//! |---|---|
//! | `figures` | the findings of a run as rows of text |
//! | `view` | the chart and the figures of one run, or of several over each other |
//! | `runs_tab` | the tab `Runs` |
//! | `export` | files of runs |
//! | `texts` | names of axes, and how a run ended |

mod export;
mod figures;
pub(super) mod runs_tab;
mod texts;
pub(super) mod view;

pub(super) use export::save_text;
