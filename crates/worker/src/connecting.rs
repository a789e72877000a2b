//! Opening, trying and reopening ports.
//!
//! The browser cannot tell two adapters of the same model apart, and their order changes after a
//! replug. So the worker opens one candidate after the other until the wanted motor replies. Nothing
//! drives meanwhile.

use std::{rc::Rc, time::Duration};

use gloo_timers::future::sleep;
use motorlink_bus::{Command, Refusal, StopReason};
use motorlink_messages::{Adapter, ConnectError, Notice, PortRef, ToWorker, VirtualLine};
use motorlink_protocol::{MotorId, family::Model};
use wasm_bindgen_futures::spawn_local;

use crate::{
    claim::{claim, release_claim},
    line::Line,
    port_owner::Shared,
    serial::{self, ReadEnd, ReadEvent, SharedInFlight},
    session::{AfterClosing, OpenSession, Session, Stage},
    trial::{DetectedModel, Superseded, detected_model, wanted_motor_replies},
};

/// Number of tries to reopen: a replugged adapter appears before the system has set its permissions.
const REOPEN_TRIES: u32 = 10;
/// Pause between two tries.
const REOPEN_PAUSE: Duration = Duration::from_millis(300);

/// Stops the motors, closes the port, and then does what `then` asks.
pub(crate) fn stop_and_close(shared: &Shared, then: AfterClosing) {
    {
        let mut owner = shared.borrow_mut();
        let now = owner.now();
        if let Session::Open(open) = &mut owner.session
            && open.bus.is_active(now)
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
    let (left, generation) = shared.borrow_mut().begin_session(Session::Closed);
    let shared = Rc::clone(shared);
    spawn_local(async move {
        if let Session::Open(open) = left {
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
            }) => {
                shared.borrow_mut().model = model;
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

/// Handles an event of a port's reader, unless another session has begun.
pub(crate) fn receive(shared: &Shared, generation: u32, event: ReadEvent<'_>) {
    {
        let mut owner = shared.borrow_mut();
        if owner.generation != generation {
            return;
        }
        let now = owner.now();
        match (&mut owner.session, event) {
            (Session::Open(open), ReadEvent::Bytes(bytes)) => open.bus.receive(now, bytes),
            (_, ReadEvent::LineError) => owner.outbox.notice(Notice::LineError),
            (_, ReadEvent::Bytes(_)) => {}
        }
    }
    pump(shared);
}

/// Opens the built-in virtual line.
pub(crate) fn open_virtual(shared: &Shared, line: VirtualLine) {
    {
        let mut owner = shared.borrow_mut();
        let bus = owner.new_bus(line.model, Some(line));
        let open = OpenSession {
            line: Line::of_virtual(line),
            bus,
            stage: Stage::Settled,
            reader: None,
            id_query: None,
        };
        owner.begin_session(Session::Open(Box::new(open)));
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

/// Opens the first candidate on which the wanted motor replies, or else the first that opens.
pub(crate) async fn open_serial(shared: &Shared, candidates: Vec<PortRef>, wanted: MotorId) {
    let failure = open_any(shared, candidates, wanted, None, IfNoReply::TakeFirst).await;
    if let Ok(Some(failure)) = failure {
        begin(shared, Session::Failed(failure));
        release_claim();
    }
}

/// Tries the candidates in turn. Returns the error if none is open at the end. `lost` is the adapter
/// that was unplugged, if this is a reconnect.
async fn open_any(
    shared: &Shared,
    candidates: Vec<PortRef>,
    wanted: MotorId,
    lost: Option<Adapter>,
    if_no_reply: IfNoReply,
) -> Result<Option<ConnectError>, Superseded> {
    let mut generation = begin(shared, Session::Opening { lost });
    let mut first_that_opens = None;
    let mut failure = ConnectError::PortGone;
    let alone = candidates.len() < 2 && if_no_reply == IfNoReply::TakeFirst;
    for candidate in candidates {
        match open_as_detected(shared, generation, candidate, lost).await? {
            Err(error) => failure = error,
            Ok(opened) => {
                generation = opened;
                if alone || wanted_motor_replies(shared, generation, wanted).await? {
                    settle(shared, lost);
                    return Ok(None);
                }
                first_that_opens.get_or_insert(candidate);
                generation = close_trial(shared, lost).await;
            }
        }
    }
    if let Some(candidate) = first_that_opens.filter(|_| if_no_reply == IfNoReply::TakeFirst) {
        match open_as_detected(shared, generation, candidate, lost).await? {
            Ok(_) => {
                settle(shared, lost);
                return Ok(None);
            }
            Err(error) => failure = error,
        }
    }
    Ok(Some(failure))
}

/// Handles a plugged-in adapter: if it may be the one that was unplugged, it is opened again. That
/// starts no motor.
pub(crate) fn adapter_plugged(shared: &Shared) {
    reopen(shared, IfNoReply::TakeFirst);
}

fn reopen(shared: &Shared, if_no_reply: IfNoReply) {
    let Session::Lost(lost) = shared.borrow().session else {
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
            if !matches!(shared.borrow().session, Session::Lost(_)) {
                return;
            }
            let refs = (0_u16..)
                .zip(&ports)
                .map(|(place, port)| (place, serial::usb_of(port)));
            let candidates: Vec<_> = refs
                .filter(|(_, found)| *found == usb)
                .map(|(place, usb)| PortRef { place, usb })
                .collect();
            if !candidates.is_empty() {
                let wanted = shared.borrow().selected;
                match open_any(&shared, candidates, wanted, Some(lost), if_no_reply).await {
                    Ok(Some(_)) => _ = begin(&shared, Session::Lost(lost)),
                    Ok(None) | Err(Superseded) => return,
                }
            }
            sleep(REOPEN_PAUSE).await;
        }
    });
}

fn begin(shared: &Shared, session: Session) -> u32 {
    let (_, generation) = shared.borrow_mut().begin_session(session);
    pump(shared);
    generation
}

/// Opens one port on trial for the model that its motors answer as, if detection is on. If it is off, or no motor
/// answers, opens it for the model that the person has chosen.
async fn open_as_detected(
    shared: &Shared,
    mut generation: u32,
    candidate: PortRef,
    lost: Option<Adapter>,
) -> Result<Result<u32, ConnectError>, Superseded> {
    let choice = shared.borrow().model;
    let mut tried = Vec::new();
    let mut next = Some(choice.model).filter(|_| choice.detect);
    while let Some(model) = next {
        match open_one(shared, generation, candidate, model, lost).await? {
            Err(error) => return Ok(Err(error)),
            Ok(opened) => generation = opened,
        }
        tried.push(model);
        let detected = match detected_model(shared, generation).await? {
            DetectedModel::Own => {
                shared.borrow_mut().model.model = model;
                return Ok(Ok(generation));
            }
            DetectedModel::Other(model) => Some(model),
            DetectedModel::Unknown => None,
        };
        let of_either_baud = [Model::Ddsm115, Model::Ddsm400];
        let untried = |model: &Model| {
            let same_baud = |tried: &Model| tried.spec().baud == model.spec().baud;
            !tried.iter().any(same_baud)
        };
        next = detected
            .filter(|model| !tried.contains(model))
            .or_else(|| of_either_baud.into_iter().find(untried));
        generation = close_trial(shared, lost).await;
    }
    open_one(shared, generation, candidate, choice.model, lost).await
}

/// Opens one port on trial and starts reading it. Returns the number of its session.
async fn open_one(
    shared: &Shared,
    generation: u32,
    candidate: PortRef,
    model: Model,
    lost: Option<Adapter>,
) -> Result<Result<u32, ConnectError>, Superseded> {
    let opened = if claim(candidate.place).await {
        serial::open(candidate, model).await
    } else {
        Err(ConnectError::OtherTab)
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
    let bus = shared.borrow().new_bus(model, None).on_trial();
    let open = OpenSession {
        line: Line::Serial(line),
        bus,
        stage: Stage::OnTrial { lost },
        reader: None,
        id_query: None,
    };
    let generation = begin(shared, Session::Open(Box::new(open)));
    spawn_local(read(Rc::clone(shared), generation, port, in_flight));
    Ok(Ok(generation))
}

/// Reads a port until its session ends.
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
            if let Session::Open(open) = &mut owner.session {
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
    let (left, generation) = shared.borrow_mut().begin_session(Session::Opening { lost });
    if let Session::Open(open) = left {
        open.close().await;
    }
    generation
}

/// Ends the trial: the page may drive from now on, if the port is still open.
fn settle(shared: &Shared, lost: Option<Adapter>) {
    {
        let mut owner = shared.borrow_mut();
        let now = owner.now();
        if let Session::Open(open) = &mut owner.session
            && let Stage::OnTrial { .. } = open.stage
        {
            open.stage = Stage::Settled;
            open.bus.end_trial(now);
            if let Some(outcome) = open.id_query.take() {
                owner.outbox.notice(Notice::IdQueryEnded(outcome));
            }
        }
        if lost.is_some() {
            owner.outbox.notice(Notice::AdapterBack);
        }
        owner.outbox.touch();
    }
    pump(shared);
}
