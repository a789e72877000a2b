//! The computer that this process runs on.

use std::{
    path::PathBuf,
    sync::mpsc::{Receiver, Sender, SyncSender, TrySendError},
    time::Duration,
};

use motorlink_port::Line;
use motorlink_protocol::{Instant, family::Model};

use crate::{
    answers::Answers,
    clock::Clock,
    computer::Computer,
    driven_file::{DrivenFile, NoFile},
    holder::holder_of,
    inputs::{Given, Input, Told},
    latency::ask_for_low_latency,
    locked_file::LockedFile,
    open_failure::OpenFailure,
    ports::ChosenPort,
    serial_line::SerialLine,
};

/// The clock, the ports and the files of this computer, and the channels to the program.
pub(crate) struct ThisComputer {
    clock: Clock,
    inputs: Receiver<Given>,
    to_self: Sender<Given>,
    told: SyncSender<Told>,
    opened: SyncSender<Result<Model, OpenFailure>>,
    state_folder: Option<PathBuf>,
    /// What the port was when it was opened: one that is unplugged may not tell any more.
    adapter: Option<String>,
}

impl ThisComputer {
    pub(crate) fn new(
        (to_self, inputs): (Sender<Given>, Receiver<Given>),
        told: SyncSender<Told>,
        opened: SyncSender<Result<Model, OpenFailure>>,
        state_folder: Option<PathBuf>,
    ) -> Self {
        Self {
            clock: Clock::new(),
            inputs,
            to_self,
            told,
            opened,
            state_folder,
            adapter: None,
        }
    }
}

impl Computer for ThisComputer {
    fn now(&mut self) -> Instant {
        self.clock.now()
    }

    fn wait(&mut self, until: Instant) -> Option<(Input, Duration)> {
        let wait = until.since(self.clock.now());
        let given = self.inputs.recv_timeout(wait).ok()?;
        Some((given.input, given.at.elapsed()))
    }

    fn tell(&mut self, told: Told) {
        match self.told.try_send(told) {
            // A program that takes nothing is stopped by the watchdog of the bus, as its pings are lost too.
            Ok(()) | Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => {}
        }
    }

    fn opened(&mut self, result: Result<Model, OpenFailure>) {
        // The program waits for it.
        let _ = self.opened.send(result);
    }

    fn find_port(&mut self, path: Option<&str>) -> Result<ChosenPort, OpenFailure> {
        let port = ChosenPort::find(path)?;
        // The superuser may open a port that another program has open.
        match holder_of(&port.path) {
            None => Ok(port),
            holder => Err(OpenFailure::Busy {
                path: port.path,
                holder,
            }),
        }
    }

    fn port_again(&mut self, port: &ChosenPort) -> Option<String> {
        port.again()
    }

    fn open_line(
        &mut self,
        path: &str,
        model: Model,
        number: u32,
    ) -> Result<Box<dyn Line>, OpenFailure> {
        ask_for_low_latency(path);
        let line = SerialLine::open(path, model, number, self.to_self.clone());
        let line = line.map_err(|error| OpenFailure::of(path, &error))?;
        Ok(Box::new(line))
    }

    fn open_file(&mut self, adapter: &str) -> Result<DrivenFile, NoFile> {
        self.adapter = Some(adapter.to_owned());
        let folder = self.state_folder.as_deref().ok_or(NoFile::Refused)?;
        let (file, content) = LockedFile::open(folder, adapter)?;
        Ok(DrivenFile::new(Box::new(file), &content))
    }

    fn keep_answers(&mut self, answers: &Answers) {
        if let (Some(folder), Some(adapter)) = (&self.state_folder, &self.adapter) {
            // What the disk refuses is not known later, and does no harm.
            let _ = answers.keep(self.clock.now(), folder, adapter);
        }
    }
}
