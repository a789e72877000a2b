//! The one owner of the port: what is done with messages, bytes and the passing of time.

use std::{cell::RefCell, rc::Rc};

use motorlink_bus::{Activity, Bus, Command, CommandRate, Event, Limits, Output, Ramp, Refusal};
use motorlink_messages::Notice;
use motorlink_protocol::{Instant, MotorId};
use web_sys::MessagePort;

use crate::{
    alarm::Alarm,
    claim::give_back,
    outbox::{Outbox, Present},
    scope::Clock,
    session::{AfterClosing, Session, Stage},
    telling::tell,
    traffic::TrafficTape,
};

mod acts;

/// Everything that the worker is. Each callback of the browser borrows it once, briefly.
pub(crate) struct Station {
    clock: Clock,
    alarm: Alarm,
    pub(crate) outbox: Outbox,
    tape: TrafficTape,
    pub(crate) session: Session,
    /// Counts sessions, so that a task of an old one does nothing to a new one.
    pub(crate) generation: u32,
    pub(crate) selected: MotorId,
    rate: CommandRate,
    ramp: Option<Ramp>,
    limits: Limits,
    /// Whether Stop all motors stands. It outlives the port.
    halted: bool,
    /// How much more our clock shows than the page's, by the quickest message so far.
    ahead_of_page_ms: f64,
}

/// The handle that the browser's callbacks share.
pub(crate) type Shared = Rc<RefCell<Station>>;

impl Station {
    pub(crate) fn new(clock: Clock, alarm: Alarm) -> Self {
        Self {
            clock,
            alarm,
            outbox: Outbox::default(),
            tape: TrafficTape::default(),
            session: Session::Closed,
            generation: 0,
            selected: MotorId::FIRST,
            rate: CommandRate::default(),
            ramp: None,
            limits: Limits::default(),
            halted: false,
            ahead_of_page_ms: f64::INFINITY,
        }
    }

    /// The recorder's end of the line on which frames are posted to it.
    pub(crate) fn connect_recorder(&mut self, port: MessagePort) {
        self.tape.connect(port);
    }

    pub(crate) fn now(&self) -> Instant {
        self.clock.now()
    }

    /// A bus on which nothing drives, and on which Stop all motors still stands if it stood.
    pub(crate) fn new_bus(&self) -> Bus {
        let now = self.now();
        let mut bus = if self.halted {
            Bus::halted(now)
        } else {
            Bus::new(now)
        };
        for command in [
            Command::SetRate(self.rate),
            Command::SetRamp(self.ramp),
            Command::SetLimits(self.limits),
            Command::IdQuery,
            Command::Watch(self.selected),
        ] {
            // None of them is refused on a bus on which nothing drives.
            let _: Result<(), Refusal> = bus.command(now, command);
        }
        bus
    }

    /// Takes up another session; gives back the old one and the number of the new.
    pub(crate) fn begin_session(&mut self, session: Session) -> (Session, u32) {
        self.generation += 1;
        self.outbox.touch();
        let now = self.now();
        let mut left = std::mem::replace(&mut self.session, session);
        if let Session::Open(open) = &mut left {
            // A scan or an ID change that ends with its port is told as cancelled.
            let last_events: Vec<Event> = open.bus.close(now).collect();
            for event in last_events {
                match event {
                    Event::Line(traffic) => self.tape.push(traffic),
                    event => tell(&mut self.outbox, open, event),
                }
            }
            self.tape.hurry();
        }
        (left, self.generation)
    }

    /// The adapter is gone: what was driven coasts, and the adapter is waited for.
    ///
    /// Gives back what was to be done after closing, where the port was being closed anyway.
    pub(crate) fn adapter_lost(&mut self) -> Option<AfterClosing> {
        let now = self.now();
        let Session::Open(open) = &mut self.session else {
            return None;
        };
        let leaving = match &mut open.stage {
            Stage::Closing(then) => Some(std::mem::take(then)),
            Stage::OnTrial { .. } | Stage::Settled => None,
        };
        let adapter = open.line.adapter();
        let moved = |activity| !matches!(activity, Activity::Idle);
        let driven = open
            .bus
            .motors(now)
            .filter(|m| moved(m.activity))
            .map(|m| m.id)
            .collect();
        self.outbox.notice(Notice::AdapterLost { driven });
        // What is not there is nobody's; when it is back it is claimed anew.
        give_back();
        let waiting = if leaving.is_some() {
            Session::Closed
        } else {
            Session::Lost(adapter)
        };
        self.begin_session(waiting);
        leaving
    }

    /// Lets everything that is due happen. Gives back what to do after closing, once the motors
    /// stand and the port can be closed.
    pub(crate) fn turn(&mut self) -> Option<AfterClosing> {
        let now = self.now();
        let mut wake = None;
        let mut left = None;
        if let Session::Open(open) = &mut self.session {
            let at = loop {
                while let Some(bytes) = open.line.take_received(now) {
                    open.bus.receive(now, &bytes);
                }
                match open.bus.poll(now) {
                    Output::Transmit(frame) if open.line.write(now, frame) => {}
                    Output::Transmit(_) => open.bus.transmit_failed(),
                    Output::Event(Event::PingPage) => self.outbox.ping(now),
                    // Of a port on trial too: the log shows what passed, whoever it came from.
                    Output::Event(Event::Line(traffic)) => self.tape.push(traffic),
                    Output::Event(event) => {
                        if let Event::StopEnded(_) = event
                            && let Stage::Closing(then) = &mut open.stage
                        {
                            left = Some(std::mem::take(then));
                        }
                        tell(&mut self.outbox, open, event);
                    }
                    Output::Wait(at) => break at,
                }
            };
            // The bus stops all motors by itself where the page or the computer was away.
            self.halted |= open.bus.is_halted();
            wake = Some(open.line.next_event().map_or(at, |event| event.min(at)));
        }
        // Before the page hears that a port is closed, the recorder is sent all that passed on it.
        if self.tape.due().is_some_and(|due| due <= now) {
            self.tape.send(now);
        }
        if self.outbox.due(now).is_some_and(|due| due <= now) {
            let present = self.present(now);
            self.outbox.send(now, present);
        }
        let outbox_due = self.outbox.due(now);
        let tape_due = self.tape.due();
        // The recorder can wait for the next frame of the screen: one wake-up for both.
        let tape_due = tape_due.map(|due| outbox_due.map_or(due, |frame| frame.max(due)));
        if let Some(at) = wake.into_iter().chain(outbox_due).chain(tape_due).min() {
            self.alarm.arm(now, at);
        }
        left
    }

    fn present(&self, now: Instant) -> Present {
        let bus = match &self.session {
            Session::Open(open) if !matches!(open.stage, Stage::OnTrial { .. }) => Some(&open.bus),
            _ => None,
        };
        Present {
            connection: self.session.connection(),
            halted: self.halted,
            motors: bus.map_or_else(Vec::new, |bus| bus.motors(now).collect()),
            job: bus.and_then(Bus::job),
            raw: bus.and_then(Bus::raw),
            line: bus.map(|bus| bus.line_status(now)),
        }
    }
}
