//! Experiments: what is asked of motors, the run that asks it, and its curves.
//!
//! Nothing moves before a person has armed the run, has read what will move, and has pressed `Run`.
//!
//! | file | idea |
//! |---|---|
//! | `panel` | the panel `Experiments` with its tabs |
//! | `state`, `actions` | what the panel knows; what its buttons do |
//! | `table` | the table of steps as it is typed |
//! | `steps`, `steps_grid` | the tab Sequence; its table as HTML |
//! | `fields` | the parameters of a study |
//! | `run_bar` | arm, run, pause, abort |
//! | `chart` | the curves of a plan and of its run |
//! | `kept` | the runs that the browser keeps |
//! | `results` | charts and figures of runs, and the tab Runs |
//! | `code` | the tab Code: a sequence as a program |
//! | `texts` | errors, refusals and ends in words |

mod actions;
mod chart;
mod code;
mod fields;
mod kept;
pub(crate) mod panel;
mod results;
mod run_bar;
pub(crate) mod state;
mod steps;
mod steps_grid;
mod table;
mod texts;
