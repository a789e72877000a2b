//! What the driver needs of the computer: its clock, its serial ports, a file, and the program that opened the driver.
//!
//! The driver itself does no input and output: a fault simulation runs it on a computer of its own, in virtual time.

use std::time::Duration;

use motorlink_port::Line;
use motorlink_protocol::{Instant, family::Model};

use crate::{
    answers::Answers,
    driven_file::{DrivenFile, NoFile},
    inputs::{Input, Told},
    open_failure::OpenFailure,
    ports::ChosenPort,
};

/// The computer that a driver runs on.
pub trait Computer {
    /// The time. It counts the time asleep.
    fn now(&mut self) -> Instant;

    /// The next input, and how long ago it was given; nothing if none comes until this moment.
    fn wait(&mut self, until: Instant) -> Option<(Input, Duration)>;

    /// Tells the program.
    fn tell(&mut self, told: Told);

    /// Tells the program that the line is open, or why it is not. The program waits for it.
    fn opened(&mut self, result: Result<Model, OpenFailure>);

    /// Finds the port with this name, or the only USB adapter.
    ///
    /// # Errors
    /// There is none, or another program has it open.
    fn find_port(&mut self, path: Option<&str>) -> Result<ChosenPort, OpenFailure>;

    /// The name of the port of the same adapter now; `None` while it is not there.
    fn port_again(&mut self, port: &ChosenPort) -> Option<String>;

    /// Opens the port for this model. Its bytes come as [`Input::Bytes`] with this number.
    ///
    /// # Errors
    /// What the system says.
    fn open_line(
        &mut self,
        path: &str,
        model: Model,
        number: u32,
    ) -> Result<Box<dyn Line>, OpenFailure>;

    /// The file of this adapter.
    ///
    /// # Errors
    /// See [`NoFile`].
    fn open_file(&mut self, adapter: &str) -> Result<DrivenFile, NoFile>;

    /// Keeps which motors have answered on the adapter of that file. The port is closed by now: this may take its time.
    fn keep_answers(&mut self, _answers: &Answers) {}
}
