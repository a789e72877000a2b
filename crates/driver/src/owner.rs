//! The thread that owns the port.

use std::{
    collections::BTreeSet,
    panic::{AssertUnwindSafe, catch_unwind},
    time::Duration,
};

use motorlink_bus::{COMMAND_AGE_MAX, Command, Event, StopReport};
use motorlink_messages::{ModelChoice, encode};
use motorlink_port::{Host, Line, NotDone, PortControl, Turned};
use motorlink_protocol::{Instant, MotorId};

use crate::{
    answers::Answers,
    computer::Computer,
    driven_file::DrivenFile,
    entry::{Entry, Status},
    inputs::{Input, Told},
    options::{Ending, Options},
    ports::ChosenPort,
    runs::OwnProgram,
};

/// How long the thread sleeps at most: it has nothing to do while the port is lost but to look for it.
const SLEEP_MAX: Duration = Duration::from_millis(500);

/// What the thread is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    /// It looks for the motors. The program may not drive.
    OnTrial,
    /// The program may drive.
    Settled,
    /// The motors are being stopped; then the port is closed.
    Ending {
        /// Whether that stop has ended.
        has_stopped: bool,
    },
}

impl Stage {
    pub(crate) const fn is_ending(self) -> bool {
        matches!(self, Self::Ending { .. })
    }
}

/// The state of the thread.
pub(crate) struct Owner<C> {
    pub(crate) computer: C,
    /// The model that the program asks for, or that was found last.
    pub(crate) choice: ModelChoice,
    pub(crate) control: PortControl<OwnProgram>,
    pub(crate) watched: BTreeSet<MotorId>,
    tells_traffic: bool,
    pub(crate) file: DrivenFile,
    /// The open line; `None` while the port is lost.
    pub(crate) host: Option<Host<Box<dyn Line>>>,
    /// Whether the ID query of the opened line has ended, or there is none.
    pub(crate) has_queried: bool,
    /// The serial port; `None` for virtual motors.
    pub(crate) port: Option<ChosenPort>,
    pub(crate) stage: Stage,
    /// The number of the open port. Bytes of an earlier one are not for this bus.
    pub(crate) number: u32,
    /// When a lost port is looked for next.
    pub(crate) look_at: Instant,
    /// How many stops have begun.
    stops_begun: u64,
    /// The stop that was the last to end.
    pub(crate) last_stop: Option<StopReport>,
    answers: Answers,
    #[cfg(test)]
    fails_next: bool,
}

impl<C: Computer> Owner<C> {
    pub(crate) fn new(computer: C, options: &Options) -> Self {
        Self {
            computer,
            choice: ModelChoice {
                model: options.model.unwrap_or_default(),
                detect: options.model.is_none(),
            },
            control: PortControl {
                settings: options.settings,
                ..PortControl::default()
            },
            watched: options.watch.iter().copied().collect(),
            tells_traffic: options.tells_traffic,
            file: DrivenFile::none(),
            host: None,
            has_queried: false,
            port: None,
            stage: Stage::OnTrial,
            number: 0,
            look_at: Instant::ZERO,
            stops_begun: 0,
            last_stop: None,
            answers: Answers::default(),
            #[cfg(test)]
            fails_next: false,
        }
    }

    /// Opens the port, tells whether it is open, and runs it until the end.
    pub(crate) fn run(mut self, options: &Options) -> Ending {
        let result = catch_unwind(AssertUnwindSafe(|| {
            let model = self.open(options);
            let is_open = model.is_ok();
            self.computer.opened(model);
            if is_open {
                self.run_open();
            }
        }));
        let has_failed = result.is_err();
        if has_failed {
            self.stop_after_failure();
        }
        self.close_line();
        self.computer.keep_answers(&self.answers);
        Ending {
            last_stop: self.last_stop,
            may_turn: self
                .file
                .left
                .take()
                .into_iter()
                .map(|motor| motor.id)
                .collect(),
            has_failed,
        }
    }

    /// Runs the open port until the program ends it.
    pub(crate) fn run_open(&mut self) {
        loop {
            let wake = self.turn();
            self.tell_of_run();
            if let Stage::Ending { has_stopped } = self.stage
                && (has_stopped || !self.needs_stop())
            {
                return;
            }
            self.take_inputs(wake);
        }
    }

    /// Does everything that is due. Returns when the next turn is.
    pub(crate) fn turn(&mut self) -> Instant {
        let now = self.computer.now();
        // The host stays in its place: after a failure in its bus, another bus stops the motors on its line.
        let Some(host) = self.host.as_mut() else {
            return self.look_for_port(now);
        };
        let mut entries = Vec::new();
        let mut is_remembered = true;
        let (computer, file) = (&mut self.computer, &mut self.file);
        let turned = self.control.turn(
            now,
            || computer.now(),
            host,
            |bus| is_remembered &= file.remember(bus.model(), || bus.left_driven()),
            |_, event| entries.push(Entry::Event(event)),
        );
        #[cfg(test)]
        let fails = std::mem::take(&mut self.fails_next) || self.control.runs.program.fails;
        #[cfg(test)]
        assert!(!fails, "asked for by a test");
        if !is_remembered {
            entries.push(Entry::NotRemembered);
        }
        for entry in entries {
            self.has_queried |= matches!(entry, Entry::Event(Event::IdQueryEnded(_)));
            if let Entry::Event(Event::StopBegan(_)) = &entry {
                self.stops_begun += 1;
            }
            if let Entry::Event(Event::StopEnded(report)) = &entry {
                if let Stage::Ending { has_stopped } = &mut self.stage {
                    // Whatever stop it was: one that begins meanwhile joins that of the end.
                    *has_stopped = true;
                }
                self.last_stop = Some(report.clone());
            }
            // The program waits until the port is open, and answers nothing meanwhile.
            if entry == Entry::Event(Event::PingPage)
                && self.stage == Stage::OnTrial
                && let Some(host) = &mut self.host
            {
                host.bus.page_answered(now);
            }
            self.tell(now, entry);
        }
        match turned {
            Turned::Wait(at) => at,
            Turned::Gone => {
                self.lose_port();
                now
            }
        }
    }

    /// Tells what the run has said.
    fn tell_of_run(&mut self) {
        let now = self.computer.now();
        for message in self.control.runs.program.program.take_messages() {
            self.tell(now, Entry::Run(Box::new(message)));
        }
    }

    pub(crate) fn tell(&mut self, now: Instant, entry: Entry) {
        let bus = self.host.as_ref().map(|host| &host.bus);
        self.answers.hear(now, &entry, bus);
        let told = match entry {
            Entry::Event(Event::PingPage) => Told::Ping,
            Entry::Event(Event::Line(_) | Event::Telemetry(_)) if !self.tells_traffic => return,
            entry => Told::Entry(now, entry),
        };
        self.computer.tell(told);
    }

    /// Waits until this moment or the next input, and handles all that is there.
    pub(crate) fn take_inputs(&mut self, until: Instant) {
        let now = self.computer.now();
        let mut until = until.min(now + SLEEP_MAX);
        while let Some((input, age)) = self.computer.wait(until) {
            self.handle(input, age);
            until = Instant::ZERO;
        }
    }

    fn handle(&mut self, input: Input, age: Duration) {
        let now = self.computer.now();
        match (input, &mut self.host) {
            (Input::Bytes(number, bytes), Some(host)) if number == self.number => {
                host.receive(now, &bytes);
            }
            (Input::PortGone(number), Some(_)) if number == self.number => self.lose_port(),
            (Input::Bytes(..) | Input::PortGone(_), _) | (Input::Alive, None) => {}
            (Input::Alive, Some(host)) => host.bus.page_answered(now),
            (Input::Command(command), _) => {
                if command.is_too_old(age) {
                    self.tell(now, Entry::TooLate(command.into()));
                } else {
                    self.command(now, command);
                }
            }
            (Input::Run(message), _) => {
                let is_old = age > COMMAND_AGE_MAX;
                let host = self.host.as_mut().filter(|_| self.stage == Stage::Settled);
                let bus = host.map(|host| &mut host.bus);
                // A message of ours always encodes.
                let bytes = encode(&message).unwrap_or_default();
                let PortControl { runs, settings, .. } = &mut self.control;
                runs.message(now, (bytes, is_old), bus, *settings);
            }
            (Input::Status(answer), _) => {
                // Who asked waits for it.
                let _ = answer.try_send(self.status(now));
            }
            (Input::End, _) => self.begin_end(now),
            #[cfg(test)]
            (Input::Fail, _) => self.fails_next = true,
            #[cfg(test)]
            (Input::FailRuns, _) => self.control.runs.program.fails = true,
        }
    }

    fn command(&mut self, now: Instant, command: Command) {
        match command {
            Command::Watch(id) => _ = self.watched.insert(id),
            Command::Forget(id) => _ = self.watched.remove(&id),
            _ => {}
        }
        let is_settled = self.stage == Stage::Settled;
        let bus = self.host.as_mut().map(|host| &mut host.bus);
        let done = self.control.command(now, command, bus, is_settled);
        match done {
            Err(NotDone::Refused(refusal)) => {
                let command = command.into();
                self.tell(now, Entry::Refused { command, refusal });
            }
            // They hold for the next port.
            Err(NotDone::NotConnected)
                if matches!(command, Command::Watch(_) | Command::Forget(_)) => {}
            Err(NotDone::NotConnected) => self.tell(now, Entry::NotConnected(command.into())),
            Ok(()) => {}
        }
    }

    fn status(&self, now: Instant) -> Status {
        let bus = self.host.as_ref().map(|host| &host.bus);
        Status {
            now,
            is_open: bus.is_some(),
            is_halted: self.control.is_halted,
            stops_begun: self.stops_begun,
            motors: bus.map_or_else(Vec::new, |bus| bus.motors(now).collect()),
            job: bus.and_then(motorlink_bus::Bus::job),
            raw: bus.and_then(motorlink_bus::Bus::raw),
            line: bus.map(|bus| bus.line_status(now)),
        }
    }
}
