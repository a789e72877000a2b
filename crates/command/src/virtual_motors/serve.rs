//! The loop: the world in real time.

use std::{io::Write as _, num::NonZeroU64, os::unix::net::UnixStream, time::Duration};

use motorlink_protocol::Instant;
use motorlink_simulator::{World, WorldConfig};
use rustix::{
    event::{PollFd, PollFlags, poll},
    io::{self, Errno},
    process::setpriority_process,
    stdio::stdin,
    thread::set_current_timer_slack,
};
use signal_hook::{
    consts::{SIGHUP, SIGINT, SIGTERM},
    low_level::pipe,
};

use crate::{
    failure::Failure,
    virtual_motors::{
        clock,
        command::{self, OfAdapter},
        lines::Lines,
        terminal::Terminal,
        wire_log::WireLog,
    },
};

/// Linux lets a timer be 50 us late by default. Replies are due to a tenth of a millisecond.
const TIMER_SLACK_NS: NonZeroU64 = NonZeroU64::MIN;

/// A sleeper wakes up some 50 to 100 us late (measured), so the last stretch before an event is spent
/// awake: 0.25 ms of each exchange, 1 % of a core at 50 Hz.
const AWAKE: Duration = Duration::from_micros(80);

/// A real motor does not wait until a compiler lets it have the processor. Takes effect where the
/// program may do so (as root, as on the bench); elsewhere replies may be late on a busy machine.
const NICE: i32 = -15;

/// Reads from the terminal and standard input: more than a host writes in a tenth of a second.
const BUFFER: usize = 4096;

/// Feedback of a motor, as the driver board of the vendor's `json_cmd.h` prints it.
const JSON_LINE: &[u8] = b"{\"T\":20010,\"id\":1,\"typ\":210,\"spd\":0,\"crt\":0}\r\n";

/// Becomes readable when the program is told to end.
#[derive(Debug)]
pub(crate) struct Signals(UnixStream);

impl Signals {
    /// From now on the signals that ask for an end are only noted.
    ///
    /// # Errors
    /// The system refuses a handler.
    pub(crate) fn register() -> Result<Self, Failure> {
        Self::try_register().map_err(Failure::system("cannot listen for signals"))
    }

    fn try_register() -> std::io::Result<Self> {
        let (noted, note) = UnixStream::pair()?;
        for signal in [SIGTERM, SIGINT, SIGHUP] {
            pipe::register(signal, note.try_clone()?)?;
        }
        Ok(Self(noted))
    }
}

/// What woke the loop.
#[derive(Debug, Default)]
struct Woken {
    told_to_end: bool,
    line_waits: bool,
}

/// The world, its terminal, and who watches.
#[derive(Debug)]
pub(crate) struct Server {
    world: World,
    /// Whether a driver board answers in place of the motors.
    json: bool,
    terminal: Terminal,
    log: Option<WireLog>,
    signals: Signals,
    commands: Option<Lines>,
    /// Until then nothing passes between terminal and wire, as where an adapter stalls: what the host
    /// writes waits in the terminal, and what the motors say waits in the adapter.
    stalled_until: Option<Instant>,
}

impl Server {
    pub(crate) fn new(
        config: WorldConfig,
        json: bool,
        terminal: Terminal,
        log: Option<WireLog>,
        signals: Signals,
    ) -> Self {
        Self {
            world: World::new(config),
            json,
            terminal,
            log,
            signals,
            commands: Some(Lines::default()),
            stalled_until: None,
        }
    }

    /// Until a signal ends it.
    ///
    /// # Errors
    /// The terminal or the log fails.
    pub(crate) fn run(mut self) -> Result<(), Failure> {
        // Without it replies come some 50 us later, which is no reason not to run.
        let _ = set_current_timer_slack(Some(TIMER_SLACK_NS));
        let _ = setpriority_process(None, NICE);
        let mut buffer = [0; BUFFER];
        loop {
            self.carry(&mut buffer)?;
            let woken = self.sleep()?;
            if woken.told_to_end {
                return Ok(());
            }
            if woken.line_waits {
                self.obey(&mut buffer);
            }
        }
    }

    /// Everything that is due between host and motors.
    fn carry(&mut self, buffer: &mut [u8]) -> Result<(), Failure> {
        if let Some(until) = self.stalled_until {
            let now = clock::now();
            if now < until {
                self.world.advance(now);
                return self.log_traffic();
            }
            self.stalled_until = None;
        }
        let Some(pty) = self.terminal.pty() else {
            // The adapter is pulled out: what the motors say is lost.
            let now = clock::now();
            while self.world.receive(now).is_some() {}
            self.world.advance(now);
            return self.log_traffic();
        };
        // The clock is read after the bytes, so that they are never older than their time.
        let written = pty.read(buffer)?;
        let now = clock::now();
        if !written.is_empty() {
            self.world.set_baud(now, pty.baud()?);
        }
        if self.json && !written.is_empty() {
            pty.write(JSON_LINE)?;
            return Ok(());
        }
        self.world.transmit(now, written);
        while let Some(chunk) = self.world.receive(now) {
            pty.write(&chunk.bytes)?;
        }
        self.log_traffic()
    }

    fn log_traffic(&mut self) -> Result<(), Failure> {
        let traffic = self.world.drain_wire_frames();
        match &mut self.log {
            Some(log) => log.write(traffic),
            None => Ok(()),
        }
    }

    /// Sleeps until shortly before the next event of the world, or until an input arrives.
    fn sleep(&self) -> Result<Woken, Failure> {
        let wake = match self.stalled_until {
            // Deliveries that are due cannot be made.
            Some(until) => Some(until),
            None => self.world.next_event().map(|at| at - AWAKE),
        };
        let timeout = wake.map(|at| clock::until(at, clock::now()));
        let input = stdin();
        let terminal = match self.stalled_until {
            Some(_) => PollFlags::empty(),
            None => PollFlags::IN,
        };
        let mut watched = vec![PollFd::new(&self.signals.0, PollFlags::IN)];
        if self.commands.is_some() {
            watched.push(PollFd::new(&input, PollFlags::IN));
        }
        let hears = watched.len() > 1;
        if let Some(pty) = self.terminal.pty() {
            watched.push(PollFd::new(pty.master(), terminal));
        }
        match poll(&mut watched, timeout.as_ref()) {
            Ok(_) => {
                let mut spoke = watched.iter().map(|fd| !fd.revents().is_empty());
                let (signal, line) = (spoke.next(), spoke.next());
                Ok(Woken {
                    told_to_end: signal.unwrap_or(false),
                    line_waits: hears && line.unwrap_or(false),
                })
            }
            Err(Errno::INTR) => Ok(Woken::default()),
            Err(error) => Err(Failure::system("cannot wait for the terminal")(error)),
        }
    }

    /// Reads standard input and answers its lines. Its end is not the end of the program.
    fn obey(&mut self, buffer: &mut [u8]) {
        let count = match io::read(stdin(), &mut *buffer) {
            Err(Errno::INTR | Errno::AGAIN) => return,
            Ok(count) => count,
            Err(_) => 0,
        };
        let said = buffer.get(..count).unwrap_or_default();
        if said.is_empty() {
            self.commands = None;
        }
        let lines = self.commands.as_mut().map(|commands| commands.feed(said));
        let mut out = std::io::stdout().lock();
        for line in lines.unwrap_or_default() {
            self.world.advance(clock::now());
            // The reader has closed the output.
            let of_adapter = |asked| match asked {
                OfAdapter::Stall(time) => {
                    self.stalled_until = Some(clock::now() + time);
                    Ok(())
                }
                OfAdapter::Unplug => self.terminal.unplug(),
                OfAdapter::Plug => self.terminal.plug(),
            };
            let _ = writeln!(out, "{}", command::obey(&line, &mut self.world, of_adapter));
        }
        let _ = out.flush();
    }
}
