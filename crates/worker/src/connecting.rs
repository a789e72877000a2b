//! Opening, trying and reopening ports.
//!
//! The browser cannot tell two adapters of the same model apart, and their order changes after a
//! replug. So the worker opens one candidate after the other until the wanted motor replies. Nothing
//! drives meanwhile.

use std::{rc::Rc, time::Duration};

use gloo_timers::future::sleep;
use motorlink_bus::{
    Awaited, Bus, Command, DetectedModel, LeftDriven, LeftMotors, OpeningOrder, Refusal, StopReason,
};
use motorlink_messages::{
    Adapter, ConnectError, LeftBehind, ModelChoice, Notice, PortRef, ToWorker, VirtualLine,
};
use motorlink_protocol::{Instant, MotorId, family::Model};
use wasm_bindgen_futures::spawn_local;

use crate::{
    asks_again::AsksAgain,
    claim::{claim, release_claim},
    driven_file::DrivenFile,
    line::Line,
    line_errors::LineErrors,
    port_owner::{PortOwner, Shared},
    port_state::{AfterClosing, OpenPort, PortState, Stage},
    serial::{self, ReadEnd, ReadEvent, SerialLine, SharedInFlight},
    trial::{Superseded, awaited, left_motor_turns, wanted_motor_replies},
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
            && open.bus.needs_stop(now)
        {
            open.stage = Stage::Closing(then);
            // A stop is never refused.
            let _: Result<(), Refusal> = open
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
                    let usb = candidates.first().and_then(|port| port.usb);
                    let model = model.model;
                    let motors = left;
                    owner.left.add(usb, LeftBehind { model, motors });
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
            (PortState::Open(open), ReadEvent::Bytes(bytes)) => open.bus.receive(now, bytes),
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
        let open = OpenPort {
            line: Line::of_virtual(line),
            bus,
            stage: Stage::Settled,
            reader: None,
            id_query: None,
            asks_again: AsksAgain::default(),
            driven_file: DrivenFile::default(),
            line_errors: LineErrors::default(),
        };
        owner.set_port(PortState::Open(Box::new(open)));
    }
    pump(shared);
}

/// What to do if the wanted motor replies on none of the candidates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum IfNoReply {
    /// Use the first that opens: the user chose it or plugged it in.
    TakeFirst,
    /// Use none: another adapter of the same model is not the one that was lost.
    KeepWaiting,
}

/// How a trial of a candidate treats the motors that an earlier connection left driven. They may be on another adapter of
/// this make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LeftHere {
    /// It stops them at once if they can be on no other adapter; otherwise it asks them.
    Find,
    /// It stops them at once: all other adapters of this make were asked.
    Stop,
    /// It leaves them alone: they did not answer here.
    Leave,
}

/// A port that is open on trial.
#[derive(Clone, Copy, Debug)]
struct Opened {
    generation: u32,
    /// What the worker finds out about the motors that were left driven.
    left: LeftOnTrial,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LeftOnTrial {
    /// There are none.
    None,
    /// They are being stopped.
    Stopped,
    /// They are only asked: they may be on another adapter of this make.
    Asked,
}

/// An attempt to open a port.
#[derive(Clone, Copy)]
struct Attempt<'a> {
    shared: &'a Shared,
    /// The motor that the page would like to find.
    wanted: MotorId,
    /// The adapter that was unplugged, if this is a reconnect.
    lost: Option<Adapter>,
    if_no_reply: IfNoReply,
    /// Whether there is one candidate, which is taken whatever answers.
    is_only: bool,
    began: Instant,
}

/// Opens the first candidate on which the wanted motor replies, or else the first that opens.
pub(crate) async fn open_serial(shared: &Shared, candidates: Vec<PortRef>, wanted: MotorId) {
    let attempt = Attempt {
        shared,
        wanted,
        lost: None,
        if_no_reply: IfNoReply::TakeFirst,
        is_only: candidates.len() < 2,
        began: shared.borrow().now(),
    };
    if let Ok(Some(failure)) = attempt.open_any(candidates).await {
        begin(shared, PortState::Failed(failure));
        release_claim();
    }
}

impl Attempt<'_> {
    /// Tries the candidates in turn. Returns the error if none is open at the end.
    ///
    /// Motors that were left driven are stopped first. Where several adapters are alike, all of them are asked which one
    /// has a motor that turns, and nothing but queries goes out before that is known.
    async fn open_any(self, candidates: Vec<PortRef>) -> Result<Option<ConnectError>, Superseded> {
        let lost = self.lost;
        let mut generation = begin(self.shared, PortState::Opening { lost });
        let mut first_that_opens = None;
        let mut first_that_fits = None;
        let mut failure = ConnectError::PortGone;
        let takes_first = self.if_no_reply == IfNoReply::TakeFirst;
        for candidate in candidates {
            match self
                .open_as_detected(generation, candidate, LeftHere::Find, self.is_only)
                .await?
            {
                Err(error) => failure = error,
                Ok(opened) => {
                    generation = opened.generation;
                    let asked = opened.left == LeftOnTrial::Asked;
                    if asked && left_motor_turns(self.shared, generation).await? {
                        self.stop_left();
                        self.settle();
                        return Ok(None);
                    }
                    let is_wanted = (self.is_only && !asked)
                        || wanted_motor_replies(self.shared, generation, self.wanted).await?;
                    if is_wanted && !asked {
                        self.settle();
                        return Ok(None);
                    }
                    first_that_opens.get_or_insert(candidate);
                    if is_wanted {
                        first_that_fits.get_or_insert(candidate);
                    }
                    generation = close_trial(self.shared, lost).await;
                }
            }
        }
        let taken = first_that_fits.or(first_that_opens.filter(|_| takes_first));
        if let Some(candidate) = taken {
            let left = if first_that_fits.is_some() {
                LeftHere::Stop
            } else {
                LeftHere::Leave
            };
            match self
                .open_as_detected(generation, candidate, left, true)
                .await?
            {
                Ok(opened) => {
                    if opened.left == LeftOnTrial::Asked
                        && left_motor_turns(self.shared, opened.generation).await?
                    {
                        self.stop_left();
                    }
                    self.settle();
                    return Ok(None);
                }
                Err(error) => failure = error,
            }
        }
        Ok(Some(failure))
    }

    /// Opens one port on trial. If motors were left driven on an adapter of this make, it opens for their model, and they
    /// are the first that are asked or stopped. Else it opens for the model that its motors answer as, if detection is on.
    /// If it is off, or no motor answers, it opens for the model that the person has chosen. Left-driven motors of a like
    /// model are then asked or stopped again if the port `stays_open`, or if they have answered by now.
    async fn open_as_detected(
        self,
        mut generation: u32,
        candidate: PortRef,
        left: LeftHere,
        stays_open: bool,
    ) -> Result<Result<Opened, ConnectError>, Superseded> {
        let shared = self.shared;
        if !self.claim(generation, candidate).await? {
            return Ok(Err(ConnectError::OtherTab));
        }
        let left_model = || shared.borrow().left.model(candidate.usb);
        let ModelChoice { model, detect } = shared.borrow().model;
        let chosen = (!detect).then_some(model);
        let mut order = OpeningOrder::new(left_model(), chosen, model);
        if left == LeftHere::Leave && left_model().is_some() {
            order.tried(None);
        }
        let mut has_answered = false;
        loop {
            let trial = order.trial();
            let is_last = trial.awaits == Awaited::Nothing;
            let here = match trial.left {
                LeftMotors::Stop if !is_last => left,
                LeftMotors::Stop
                    if (has_answered || stays_open)
                        && left_model().is_some_and(|left| left.is_like(trial.model)) =>
                {
                    LeftHere::Find
                }
                _ => LeftHere::Leave,
            };
            let opened = match self
                .open_one(generation, candidate, trial.model, here)
                .await?
            {
                Err(error) => return Ok(Err(error)),
                Ok(opened) => opened,
            };
            // A reply does not tell one adapter from another: the caller finds out whether a motor turns.
            let is_asked = opened.left == LeftOnTrial::Asked;
            let found = if is_asked {
                None
            } else {
                awaited(shared, opened.generation, trial.awaits).await?
            };
            has_answered = found == Some(DetectedModel::Own);
            if has_answered || (is_asked && !is_last) {
                shared.borrow_mut().model.model = trial.model;
            }
            if is_asked || order.tried(found) {
                return Ok(Ok(opened));
            }
            generation = close_trial(shared, self.lost).await;
        }
    }

    /// Claims the adapter, and learns what workers that have ended left driven on it. Returns false if other tabs have it.
    async fn claim(self, generation: u32, candidate: PortRef) -> Result<bool, Superseded> {
        loop {
            let claimed = claim(candidate.place).await;
            {
                let mut owner = self.shared.borrow_mut();
                if owner.generation != generation {
                    return Err(Superseded);
                }
                if let Some(mut driven_file) = claimed {
                    if let Some(found) = driven_file.take_found() {
                        owner.left.add(candidate.usb, found);
                    }
                    return Ok(true);
                }
                if owner.now().since(self.began) > CLAIM_WITHIN {
                    return Ok(false);
                }
            }
            sleep(CLAIM_PAUSE).await;
        }
    }

    /// Opens one port on trial and starts reading it.
    async fn open_one(
        self,
        generation: u32,
        candidate: PortRef,
        model: Model,
        left: LeftHere,
    ) -> Result<Result<Opened, ConnectError>, Superseded> {
        let shared = self.shared;
        let opening = shared.borrow().now();
        let again = || {
            let owner = shared.borrow();
            let now = owner.now();
            // A port that this attempt has just closed needs a moment too, however long the attempt takes.
            owner.generation == generation
                && (now.since(self.began) < serial::REOPEN_WITHIN
                    || now.since(opening) < serial::JUST_CLOSED)
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
        let (port, in_flight) = (line.port(), line.in_flight());
        let (bus, left) = self.new_bus(&line, model, left);
        let open = OpenPort {
            line: Line::Serial(line),
            bus,
            stage: Stage::OnTrial { lost: self.lost },
            reader: None,
            id_query: None,
            asks_again: AsksAgain::default(),
            driven_file,
            line_errors: LineErrors::default(),
        };
        let generation = begin(shared, PortState::Open(Box::new(open)));
        spawn_local(read(Rc::clone(shared), generation, port, in_flight));
        Ok(Ok(Opened { generation, left }))
    }

    /// The bus for a port on trial, with the stop of the motors that were left driven as its first act.
    fn new_bus(self, line: &SerialLine, model: Model, how: LeftHere) -> (Bus, LeftOnTrial) {
        let mut owner = self.shared.borrow_mut();
        let now = owner.now();
        let mut bus = owner.new_bus(model, None).on_trial();
        let is_alone = || owner.left.are_foreign(&line.others_of_make);
        let stops = match how {
            LeftHere::Find => is_alone(),
            LeftHere::Stop => true,
            LeftHere::Leave => return (bus, LeftOnTrial::None),
        };
        let left = if stops {
            bus.stop_first(now, owner.left.take(line.usb()));
            LeftOnTrial::Stopped
        } else {
            for LeftDriven { id, .. } in owner.left.of(line.usb()) {
                // Not refused while nothing drives.
                let _: Result<(), Refusal> = bus.command(now, Command::Watch(id));
            }
            LeftOnTrial::Asked
        };
        (bus, left)
    }

    /// Stops the motors that were left driven: they answer on this port.
    fn stop_left(self) {
        let mut owner = self.shared.borrow_mut();
        let now = owner.now();
        let PortOwner { port, left, .. } = &mut *owner;
        if let PortState::Open(open) = port {
            open.bus.stop_first(now, left.take(open.usb()));
        }
    }

    /// Ends the trial: the page may drive from now on, if the port is still open.
    fn settle(self) {
        {
            let mut owner = self.shared.borrow_mut();
            let now = owner.now();
            if let PortState::Open(open) = &mut owner.port
                && let Stage::OnTrial { .. } = open.stage
            {
                open.stage = Stage::Settled;
                open.bus.end_trial(now);
                if let Some(outcome) = open.id_query.take() {
                    owner.outbox.notice(Notice::IdQueryEnded(outcome));
                }
            }
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
                    wanted: shared.borrow().selected,
                    lost: Some(lost),
                    if_no_reply,
                    is_only: candidates.len() < 2 && if_no_reply == IfNoReply::TakeFirst,
                    began: shared.borrow().now(),
                };
                match attempt.open_any(candidates).await {
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
async fn read(
    shared: Shared,
    generation: u32,
    port: web_sys::SerialPort,
    in_flight: SharedInFlight,
) {
    let shared_by_reader = Rc::clone(&shared);
    let shared_by_events = Rc::clone(&shared);
    let ended = serial::read(
        port,
        in_flight,
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
