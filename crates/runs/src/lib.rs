//! The run of an experiment beside the bus.
//!
//! A run has two sides in one thread. The [`Program`] decides: it has the sequence, the plan and the record. In the
//! browser it has a memory of its own, and is loaded when the first run is armed. The [`Host`] belongs to the owner of
//! the port. It is small, applies what the program returns to the bus, and stops the motors of the run without asking
//! the program.
//! Only [`Input`] and [`Output`] cross.
//!
//! | file | what it is |
//! |---|---|
//! | `exchange` | what crosses between the two sides |
//! | `host` | the side of the port |
//! | `runs` | both sides beside a bus, as each owner of a port has them |
//! | `program` | the side that decides |
//! | `cause` | events of the bus as causes that end a run |
//! | `report` | what the program tells the page |
//! | `recorded_run` | a run as a program without a page asks for it and records it |

mod cause;
mod exchange;
mod host;
mod program;
mod recorded_run;
mod report;
mod runs;

pub use exchange::{Act, Input, LineState, Output};
pub use host::{Failed, Host, Line};
pub use program::Program;
pub use recorded_run::RecordedRun;
pub use runs::{Decides, Runs};
