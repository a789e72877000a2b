//! Experiments: what is asked of a motor, the run, and its figures.
//!
//! | folder | idea |
//! |---|---|
//! | `kept` | the runs that the browser keeps |
//! | `results` | charts and figures of runs, and the tab `Runs` |
//! | `code` | the tab `Code`: a sequence as a program |

pub(crate) mod code;
pub(crate) mod kept;
pub(crate) mod results;
