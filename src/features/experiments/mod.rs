//! Experiments: what is asked of motors, the run that asks it, and its curves.
//!
//! Nothing moves before a person has armed the run, has read what will move, and has pressed `Run`.
//!
//! | file | idea |
//! |---|---|
//! | `panel` | the panel `Experiments` with its tabs |
//! | `state`, `actions`, `messages` | what the panel knows; what its buttons do; what the run tells |
//! | `table` | the table of steps as it is typed |
//! | `sequence_fields`, `sequence_file` | template, name and limits of a sequence; a sequence as a file |
//! | `steps`, `steps_grid` | the table of steps; its rows as HTML |
//! | `fields` | the parameters of a study |
//! | `run_bar` | arm, run, pause, abort |
//! | `chart` | the curves of a plan and of its run |
//! | `kept` | the runs that the browser keeps |
//! | `results` | charts and figures of runs, and the tab Runs |
//! | `code` | the tab Code: a sequence as a program, a rover as a robot for ROS 2 |
//! | `texts` | errors, refusals and ends in words |

mod actions;
mod chart;
mod code;
mod fields;
mod kept;
mod messages;
pub(crate) mod panel;
mod results;
mod run_bar;
mod sequence_fields;
mod sequence_file;
pub(crate) mod state;
mod steps;
mod steps_grid;
mod table;
mod texts;
