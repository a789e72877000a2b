//! Opening, trying and reopening ports.
//!
//! The browser cannot tell two adapters of the same model apart, and their order changes after a
//! replug. So the worker opens one candidate after the other; [`Opening`] says which, and for which model. Nothing drives
//! meanwhile.

use std::{rc::Rc, time::Duration};

use gloo_timers::future::sleep;
use motorlink_bus::{Command, Refusal, StopReason};
use motorlink_messages::{
    Adapter, ConnectError, LeftBehind, Notice, PortRef, ToWorker, VirtualLine,
};
use motorlink_port::{Host, IfNoReply, Opening, Others, Step};
use motorlink_protocol::{Instant, MotorId, family::Model};
use wasm_bindgen_futures::spawn_local;

use crate::{
    claim::{claim, release_claim},
    driven_file::DrivenFile,
    line::Line,
    port_owner::{PortOwner, Shared},
    port_state::{AfterClosing, OpenPort, PortState, Stage},
    serial::{self, ReadEnd, ReadEvent},
};

/// Number of tries to reopen: a replugged adapter appears before the system has set its permissions.
const REOPEN_TRIES: u32 = 10;
/// Pause between two tries.
const REOPEN_PAUSE: Duration = Duration::from_millis(300);
/// How long the claim of an adapter is tried again: a tab that was killed or reloaded holds it for a moment longer.
const CLAIM_WITHIN: Duration = Duration::from_millis(500);
/// Pause between two claims.
const CLAIM_PAUSE: Duration = Duration::from_millis(40);

/// Stops the motors, closes the port, and then does what `then` asks.
pub(crate) fn stop_and_close(shared: &Shared, then: AfterClosing) {
    {
        let mut owner = shared.borrow_mut();
        let now = owner.now();
        if let PortState::Open(open) = &mut owner.port
            && open.host.bus.needs_stop(now)
        {
            open.stage = Stage::Closing(then);
            // A stop is never refused.
            let _: Result<(), Refusal> = open
                .host
                .bus
                .command(now, Command::StopAll(StopReason::Disconnect));
            return;
        }
    }
    close(shared, then);
}

/// Closes the port, and then does what `then` asks.
fn close(shared: &Shared, then: AfterClosing) {
    let (left, generation) = shared.borrow_mut().set_port(PortState::Closed);
    let shared = Rc::clone(shared);
    spawn_local(async move {
        if let PortState::Open(open) = left {
            open.close().await;
        }
        if shared.borrow().generation != generation {
            return;
        }
        // A tab that opens another port of the same model keeps its claim.
        if !matches!(then.0, Some(ToWorker::ConnectSerial { .. })) {
            release_claim();
        }
        match then.0 {
            Some(ToWorker::ConnectVirtual(line)) => open_virtual(&shared, line),
            Some(ToWorker::ConnectSerial {
                candidates,
                wanted,
                model,
                left,
            }) => {
                {
                    let mut owner = shared.borrow_mut();
                    owner.model = model;
                    owner.left.foreign.clear();
                    owner.left.lost_on_trial = 0;
                    let usb = candidates.first().and_then(|port| port.usb);
                    let model = model.model;
                    let motors = left;
                    owner.left.of(usb).carry(LeftBehind { model, motors });
                }
                open_serial(&shared, candidates, wanted).await;
            }
            _ => {}
        }
    });
}

/// Does everything that is due, and arms the alarm for the next deadline.
pub(crate) fn pump(shared: &Shared) {
    let left = shared.borrow_mut().turn();
    if let Some(then) = left {
        close(shared, then);
        shared.borrow_mut().turn();
    }
}

/// Handles an event of a port's reader, unless another port state has begun.
pub(crate) fn receive(shared: &Shared, generation: u32, event: ReadEvent<'_>) {
    {
        let mut owner = shared.borrow_mut();
        if owner.generation != generation {
            return;
        }
        let now = owner.now();
        match (&mut owner.port, event) {
            (PortState::Open(open), ReadEvent::Bytes(bytes)) => open.host.receive(now, bytes),
            (PortState::Open(open), ReadEvent::LineError(error)) => {
                let count = open.line_errors.count(now);
                if let Some(count) = count {
                    owner.outbox.notice(Notice::LineError { error, count });
                }
            }
            (_, ReadEvent::Bytes(_) | ReadEvent::LineError(_)) => {}
        }
    }
    pump(shared);
}

/// Opens the built-in virtual line.
pub(crate) fn open_virtual(shared: &Shared, line: VirtualLine) {
    {
        let mut owner = shared.borrow_mut();
        let bus = owner.new_bus(line.model, Some(line));
        let line = Line::of_virtual(line);
        let open = OpenPort::new(Host { bus, line }, Stage::Settled, DrivenFile::default());
        owner.set_port(PortState::Open(Box::new(open)));
    }
    pump(shared);
}

/// An attempt to open a port.
#[derive(Clone, Copy)]
struct Attempt<'a> {
    shared: &'a Shared,
    /// The adapter that was unplugged, if this is a reconnect.
    lost: Option<Adapter>,
    began: Instant,
}

/// Another port state has begun meanwhile, so this task ends.
struct Superseded;

/// Opens the candidate with a motor that was left driven and turns, else the first on which the wanted motor replies, else
/// the first that opens.
pub(crate) async fn open_serial(shared: &Shared, candidates: Vec<PortRef>, wanted: MotorId) {
    let attempt = Attempt {
        shared,
        lost: None,
        began: shared.borrow().now(),
    };
    let failed = attempt.open_any(&candidates, wanted, IfNoReply::TakeFirst);
    if let Ok(Some(failure)) = failed.await {
        begin(shared, PortState::Failed(failure));
        release_claim();
    }
}

impl Attempt<'_> {
    /// Tries the candidates. Returns the error if none is open at the end.
    async fn open_any(
        self,
        candidates: &[PortRef],
        wanted: MotorId,
        if_no_reply: IfNoReply,
    ) -> Result<Option<ConnectError>, Superseded> {
        let (shared, lost) = (self.shared, self.lost);
        let mut generation = begin(shared, PortState::Opening { lost });
        let mut failure = ConnectError::PortGone;
        let choice = shared.borrow().model;
        let mut opening = Opening::new(candidates.len(), wanted, choice, if_no_reply);
        loop {
            let candidate = candidates.get(opening.port());
            let step = {
                let mut owner = shared.borrow_mut();
                if owner.generation != generation {
                    return Err(Superseded);
                }
                let now = owner.now();
                let PortOwner { port, left, .. } = &mut *owner;
                let bus = match port {
                    PortState::Open(open) => Some(&mut open.host.bus),
                    _ => None,
                };
                let usb = candidate.and_then(|port| port.usb);
                let step = opening.step(now, bus, left.of(usb));
                owner.model = opening.choice();
                step
            };
            let candidate = candidates.get(opening.port()).copied();
            let done = match (step, candidate) {
                (Step::Claim(_), Some(candidate)) => self.claim(generation, candidate).await?,
                (Step::Open(_, model), Some(candidate)) => {
                    let alike = candidates.iter().filter(|port| port.usb == candidate.usb);
                    let trial = (&mut opening, alike.count().saturating_sub(1));
                    let opened = self.open_one(generation, candidate, model, trial);
                    opened.await?.map(|opened| generation = opened)
                }
                (Step::Close, _) => {
                    generation = close_trial(shared, lost).await;
                    Ok(())
                }
                (Step::Wait, _) => {
                    sleep(Opening::STEP).await;
                    Ok(())
                }
                (Step::Done, _) => {
                    self.settle();
                    return Ok(None);
                }
                _ => return Ok(Some(failure)),
            };
            if let Err(error) = done {
                failure = error;
                let usb = candidate.and_then(|port| port.usb);
                opening.refused(shared.borrow_mut().left.of(usb));
            }
        }
    }

    /// Claims the adapter, and learns what workers that have ended left driven on it.
    async fn claim(
        self,
        generation: u32,
        candidate: PortRef,
    ) -> Result<Result<(), ConnectError>, Superseded> {
        loop {
            let claimed = claim(candidate.place).await;
            {
                let mut owner = self.shared.borrow_mut();
                if owner.generation != generation {
                    return Err(Superseded);
                }
                if let Some(mut driven_file) = claimed {
                    owner.left.of(candidate.usb).learn(driven_file.take_found());
                    return Ok(Ok(()));
                }
                if owner.now().since(self.began) > CLAIM_WITHIN {
                    return Ok(Err(ConnectError::OtherTab));
                }
            }
            sleep(CLAIM_PAUSE).await;
        }
    }

    /// Opens one port on trial and starts reading it. Returns the number of its state.
    async fn open_one(
        self,
        generation: u32,
        candidate: PortRef,
        model: Model,
        (opening, tried): (&mut Opening, usize),
    ) -> Result<Result<u32, ConnectError>, Superseded> {
        let shared = self.shared;
        let begun = shared.borrow().now();
        let again = || {
            let owner = shared.borrow();
            let now = owner.now();
            // A port that this attempt has just closed needs a moment too, however long the attempt takes.
            owner.generation == generation
                && (now.since(self.began) < serial::REOPEN_WITHIN
                    || now.since(begun) < serial::JUST_CLOSED)
        };
        let (driven_file, opened) = match claim(candidate.place).await {
            Some(driven_file) => (driven_file, serial::open(candidate, model, again).await),
            None => (DrivenFile::default(), Err(ConnectError::OtherTab)),
        };
        if shared.borrow().generation != generation {
            if let Ok(line) = opened {
                serial::close(line, None).await;
            }
            return Err(Superseded);
        }
        let line = match opened {
            Ok(line) => line,
            Err(error) => return Ok(Err(error)),
        };
        let port = line.port();
        let bus = {
            let mut owner = shared.borrow_mut();
            let now = owner.now();
            let mut bus = owner.new_bus(model, None).after_another(now).on_trial();
            let count = owner.left.others(&line.others_of_make);
            let others = Others { count, tried };
            opening.opened(now, &mut bus, owner.left.of(line.usb()), others);
            bus
        };
        let stage = Stage::OnTrial {
            lost: self.lost,
            id_query: None,
        };
        let line = Line::Serial(line);
        let open = OpenPort::new(Host { bus, line }, stage, driven_file);
        let generation = begin(shared, PortState::Open(Box::new(open)));
        spawn_local(read(Rc::clone(shared), generation, port));
        Ok(Ok(generation))
    }

    /// Ends the trial: the page may drive from now on, if the port is still open.
    fn settle(self) {
        {
            let mut owner = self.shared.borrow_mut();
            let now = owner.now();
            if let PortState::Open(open) = &mut owner.port
                && let Stage::OnTrial { id_query, .. } = open.stage
            {
                open.stage = Stage::Settled;
                open.host.bus.end_trial(now);
                if let Some(outcome) = id_query {
                    owner.outbox.notice(Notice::IdQueryEnded(outcome));
                }
            }
            owner.left.lost_on_trial = 0;
            if self.lost.is_some() {
                owner.outbox.notice(Notice::AdapterBack);
            }
            owner.outbox.touch();
        }
        pump(self.shared);
    }
}

/// Handles a plugged-in adapter: if it may be the one that was unplugged, it is opened again. That
/// starts no motor.
pub(crate) fn adapter_plugged(shared: &Shared) {
    reopen(shared, IfNoReply::TakeFirst);
}

fn reopen(shared: &Shared, if_no_reply: IfNoReply) {
    let PortState::Lost(lost) = shared.borrow().port else {
        return;
    };
    let Adapter::Serial(usb) = lost else { return };
    let shared = Rc::clone(shared);
    spawn_local(async move {
        for _ in 0..REOPEN_TRIES {
            let Ok(ports) = serial::ports().await else {
                return;
            };
            // The user may have disconnected or connected meanwhile.
            if !matches!(shared.borrow().port, PortState::Lost(_)) {
                return;
            }
            let candidates: Vec<_> = {
                let owner = shared.borrow();
                let of_make = (0_u16..).zip(&ports).filter(|(_, port)| {
                    // A replugged adapter is another object: one that was there before is another adapter.
                    serial::usb_of(port) == usb && !owner.left.is_foreign(port)
                });
                of_make.map(|(place, _)| PortRef { place, usb }).collect()
            };
            if !candidates.is_empty() {
                let attempt = Attempt {
                    shared: &shared,
                    lost: Some(lost),
                    began: shared.borrow().now(),
                };
                let wanted = shared.borrow().selected;
                match attempt.open_any(&candidates, wanted, if_no_reply).await {
                    Ok(Some(_)) => _ = begin(&shared, PortState::Lost(lost)),
                    Ok(None) | Err(Superseded) => return,
                }
            }
            sleep(REOPEN_PAUSE).await;
        }
    });
}

fn begin(shared: &Shared, port: PortState) -> u32 {
    let (_, generation) = shared.borrow_mut().set_port(port);
    pump(shared);
    generation
}

/// Reads a port until it is closed or lost.
async fn read(shared: Shared, generation: u32, port: web_sys::SerialPort) {
    let shared_by_reader = Rc::clone(&shared);
    let shared_by_events = Rc::clone(&shared);
    let ended = serial::read(
        port,
        move |reader| {
            let mut owner = shared_by_reader.borrow_mut();
            if owner.generation != generation {
                return false;
            }
            if let PortState::Open(open) = &mut owner.port {
                open.reader = reader;
            }
            true
        },
        move |event| receive(&shared_by_events, generation, event),
    )
    .await;
    if ended == ReadEnd::Lost && shared.borrow().generation == generation {
        let leaving = shared.borrow_mut().adapter_lost();
        match leaving {
            Some(then) => stop_and_close(&shared, then),
            // It may be back already: noise from a motor can make USB drop it and find it again at once.
            None => reopen(&shared, IfNoReply::KeepWaiting),
        }
        pump(&shared);
    }
}

async fn close_trial(shared: &Shared, lost: Option<Adapter>) -> u32 {
    let (left, generation) = shared.borrow_mut().set_port(PortState::Opening { lost });
    if let PortState::Open(open) = left {
        open.close().await;
    }
    generation
}

#[cfg(test)]
#[path = "connecting_tests.rs"]
mod tests;
