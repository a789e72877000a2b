//! Fault simulation from one seed: the bus, virtual motors, a bad wire and an operator who clicks
//! at random. Rules are checked after every step.
//!
//! | file | idea |
//! |---|---|
//! | `action` | what can happen |
//! | `scenario` | generates a list of actions from a seed |
//! | `generator` | draws random actions and commands |
//! | `of_model` | the same actions for another model |
//! | `player` | plays a scenario over virtual time and checks the rules |
//! | `sequence_run` | runs random sequences over the bus, as a worker does |
//! | `rule`, `rules` | the rules by name, and their checks |
//! | `driver` | the same for the native driver, on a computer that fails |
//! | `shrink` | the shortest scenario that still breaks the rule |
//!
//! For tests and for `cargo xtask soak`: one seed gives the same run on every machine.

mod action;
mod driver;
mod generator;
mod of_model;
mod player;
mod rule;
mod rules;
mod scenario;
mod sequence_run;
mod shrink;

pub use action::{Absence, Action, Fault, LineFault, PendingInput};
pub use driver::{
    Act, DriverCoverage, DriverRule, DriverScenario, DriverViolation, Process, play_driver,
    shrink_driver, trace_driver,
};
pub use player::{Coverage, Failure, play, trace_lines};
pub use rule::{Rule, Violation};
pub use scenario::Scenario;
pub use sequence_run::Runs;
pub use shrink::shrink;
