//! The bus on a serial port of this computer, or on virtual motors.
//!
//! A thread of its own owns the port and decides every frame, as the worker of the page does. The program that opened it
//! gives commands and takes entries: [`Driver`].
//!
//! # What it promises
//!
//! - The motors are stopped when the program ends the driver, drops it, or does not take entries for a second, and when
//!   the driver itself fails. See [`Driver::end`].
//! - What is driven is in a file before its first frame. The next driver on that adapter stops it first, also after a
//!   killed process: [`default_folder`].
//! - A port that is lost is opened again when it is back, and what was driven is stopped first.
//!
//! It is not for several programs at once: the second one gets [`OpenFailure::Busy`].

mod answers;
mod clock;
mod computer;
mod driven_file;
mod driver;
mod ending;
mod entry;
mod experiment;
mod forgetting;
mod holder;
mod inputs;
mod latency;
mod locked_file;
mod open_failure;
mod opening;
mod options;
mod owner;
mod ports;
mod runs;
mod serial_line;
mod this_computer;
mod virtual_line;
pub mod words;

pub use answers::{Answered, Answers};
pub use clock::{Clock, zero_unix_us};
pub use computer::Computer;
pub use driven_file::{DrivenFile, NoFile, Store};
pub use driver::{Commander, Driver, Next, run_on};
pub use entry::{Entry, Status};
pub use experiment::{Experiment, NotRun, Progress};
pub use forgetting::forget_left_driven;
pub use holder::Holder;
pub use inputs::{Input, Told};
pub use locked_file::default_folder;
pub use motorlink_port::{Line, Written};
pub use open_failure::OpenFailure;
pub use options::{Ender, Ending, Options};
pub use ports::{ChosenPort, FoundPort, Place, UsbAdapter, found_port, found_ports};
pub use virtual_line::VirtualLine;
