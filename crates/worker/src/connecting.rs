//! Opening, trying and reopening ports.
//!
//! Two adapters of one make look alike to the browser, and their order changes after a replug. They
//! are told apart by who answers on them: each candidate is opened in turn until the wanted motor is
//! heard. Nothing drives meanwhile.

use std::{rc::Rc, time::Duration};

use gloo_timers::future::sleep;
use motorlink_bus::{Command, Refusal, StopReason};
use motorlink_messages::{Adapter, ConnectError, Notice, PortRef, ToWorker};
use motorlink_protocol::MotorId;
use wasm_bindgen_futures::spawn_local;

use crate::{
    claim::{claim, give_back},
    line::Line,
    serial::{self, ReadEnd, ReadEvent, SharedInFlight},
    session::{AfterClosing, OpenSession, Session, Stage},
    station::Shared,
};

/// How long the wanted motor may take to answer before the next adapter is tried: three queries at
/// 10 Hz, behind an ID query of 60 ms.
const TRIAL: Duration = Duration::from_millis(400);
/// How often it is looked whether it has answered.
const TRIAL_STEP: Duration = Duration::from_millis(20);

/// A replugged adapter is shown before the system has set its permissions: try again this often.
const REOPEN_TRIES: u32 = 10;
/// Between two tries.
const REOPEN_PAUSE: Duration = Duration::from_millis(300);

/// Stops what is driven, closes the port, and then does what `then` asks.
pub(crate) fn leave(shared: &Shared, then: AfterClosing) {
    {
        let mut station = shared.borrow_mut();
        let now = station.now();
        if let Session::Open(open) = &mut station.session
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
        // A tab that opens another port of the same make keeps its place.
        if !matches!(then.0, Some(ToWorker::ConnectSerial { .. })) {
            give_back();
        }
        match then.0 {
            Some(ToWorker::ConnectVirtual) => open_virtual(&shared),
            Some(ToWorker::ConnectSerial { candidates, wanted }) => {
                open_serial(&shared, candidates, wanted).await;
            }
            _ => {}
        }
    });
}

/// Lets everything that is due happen, and sets the alarm for what is due next.
pub(crate) fn pump(shared: &Shared) {
    let left = shared.borrow_mut().turn();
    if let Some(then) = left {
        close(shared, then);
        shared.borrow_mut().turn();
    }
}

/// Takes what a port's reader tells, for as long as that port is the one in use.
pub(crate) fn receive(shared: &Shared, generation: u32, event: ReadEvent<'_>) {
    {
        let mut station = shared.borrow_mut();
        if station.generation != generation {
            return;
        }
        let now = station.now();
        match (&mut station.session, event) {
            (Session::Open(open), ReadEvent::Bytes(bytes)) => open.bus.receive(now, bytes),
            (_, ReadEvent::LineError) => station.outbox.notice(Notice::LineError),
            (_, ReadEvent::Bytes(_)) => {}
        }
    }
    pump(shared);
}

/// Opens the built-in virtual bus.
pub(crate) fn open_virtual(shared: &Shared) {
    {
        let mut station = shared.borrow_mut();
        let bus = station.new_bus();
        let open = OpenSession {
            line: Line::virtual_bus(),
            bus,
            stage: Stage::Settled,
            reader: None,
        };
        station.begin_session(Session::Open(Box::new(open)));
    }
    pump(shared);
}

/// What is done where the wanted motor answers on none of the candidates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum IfNobodyAnswers {
    /// The first that opens is taken: a person, or a plug, has pointed at it.
    TakeFirst,
    /// Nothing pointed at any of them: another adapter of the same make is not the one that was lost.
    KeepWaiting,
}

/// Opens the first candidate on which the wanted motor answers, or else the first that opens.
pub(crate) async fn open_serial(shared: &Shared, candidates: Vec<PortRef>, wanted: MotorId) {
    let failure = open_any(shared, candidates, wanted, None, IfNobodyAnswers::TakeFirst).await;
    if let Ok(Some(failure)) = failure {
        begin(shared, Session::Failed(failure));
        give_back();
    }
}

/// Goes through the candidates. Gives back why none is open, if none is. With `lost`, an adapter that
/// was pulled out is opened again.
async fn open_any(
    shared: &Shared,
    candidates: Vec<PortRef>,
    wanted: MotorId,
    lost: Option<Adapter>,
    if_nobody_answers: IfNobodyAnswers,
) -> Result<Option<ConnectError>, Superseded> {
    let mut generation = begin(shared, Session::Opening { lost });
    let mut first_that_opens = None;
    let mut failure = ConnectError::PortGone;
    let alone = candidates.len() < 2 && if_nobody_answers == IfNobodyAnswers::TakeFirst;
    for candidate in candidates {
        let stage = if alone {
            Stage::Settled
        } else {
            Stage::OnTrial { lost }
        };
        match open_one(shared, generation, candidate, stage).await? {
            Err(error) => failure = error,
            Ok(opened) => {
                generation = opened;
                if alone || answers(shared, generation, wanted).await? {
                    settle(shared, lost);
                    return Ok(None);
                }
                first_that_opens.get_or_insert(candidate);
                generation = close_trial(shared, lost).await;
            }
        }
    }
    if let Some(candidate) =
        first_that_opens.filter(|_| if_nobody_answers == IfNobodyAnswers::TakeFirst)
    {
        match open_one(shared, generation, candidate, Stage::Settled).await? {
            Ok(_) => {
                settle(shared, lost);
                return Ok(None);
            }
            Err(error) => failure = error,
        }
    }
    Ok(Some(failure))
}

/// Something was plugged in: if it may be what was pulled out, it is opened again. Nothing drives
/// then.
pub(crate) fn adapter_plugged(shared: &Shared) {
    reopen(shared, IfNobodyAnswers::TakeFirst);
}

fn reopen(shared: &Shared, if_nobody_answers: IfNobodyAnswers) {
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
            // The person may have disconnected, or connected, in the meantime.
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
                match open_any(&shared, candidates, wanted, Some(lost), if_nobody_answers).await {
                    Ok(Some(_)) => _ = begin(&shared, Session::Lost(lost)),
                    Ok(None) | Err(Superseded) => return,
                }
            }
            sleep(REOPEN_PAUSE).await;
        }
    });
}

/// Another session has begun meanwhile: this task is not wanted any more.
struct Superseded;

fn begin(shared: &Shared, session: Session) -> u32 {
    let (_, generation) = shared.borrow_mut().begin_session(session);
    pump(shared);
    generation
}

/// Opens one port and starts reading it. Gives the number of its session.
async fn open_one(
    shared: &Shared,
    generation: u32,
    candidate: PortRef,
    stage: Stage,
) -> Result<Result<u32, ConnectError>, Superseded> {
    let opened = if claim(candidate.place).await {
        serial::open(candidate).await
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
    let bus = shared.borrow().new_bus();
    let open = OpenSession {
        line: Line::Serial(line),
        bus,
        stage,
        reader: None,
    };
    let generation = begin(shared, Session::Open(Box::new(open)));
    spawn_local(read(Rc::clone(shared), generation, port, in_flight));
    Ok(Ok(generation))
}

/// Reads a port for as long as its session lasts.
async fn read(
    shared: Shared,
    generation: u32,
    port: web_sys::SerialPort,
    in_flight: SharedInFlight,
) {
    let keep = Rc::clone(&shared);
    let tell = Rc::clone(&shared);
    let ended = serial::read(
        port,
        in_flight,
        move |reader| {
            let mut station = keep.borrow_mut();
            if station.generation != generation {
                return false;
            }
            if let Session::Open(open) = &mut station.session {
                open.reader = reader;
            }
            true
        },
        move |event| receive(&tell, generation, event),
    )
    .await;
    if ended == ReadEnd::Lost && shared.borrow().generation == generation {
        let leaving = shared.borrow_mut().adapter_lost();
        match leaving {
            Some(then) => leave(&shared, then),
            // It may be back already: a motor's noise can make USB lose and find it at once.
            None => reopen(&shared, IfNobodyAnswers::KeepWaiting),
        }
        pump(&shared);
    }
}

/// Whether the wanted motor answers on the port that is on trial.
async fn answers(shared: &Shared, generation: u32, wanted: MotorId) -> Result<bool, Superseded> {
    let mut left = TRIAL.as_millis() / TRIAL_STEP.as_millis();
    loop {
        sleep(TRIAL_STEP).await;
        let station = shared.borrow();
        let open = match &station.session {
            Session::Open(open) if station.generation == generation => open,
            _ => return Err(Superseded),
        };
        if open.heard(station.now(), wanted) {
            return Ok(true);
        }
        left = left.saturating_sub(1);
        // A stop that was asked for meanwhile is not cut off; it ends by itself.
        if left == 0 && !open.bus.is_active(station.now()) {
            return Ok(false);
        }
    }
}

async fn close_trial(shared: &Shared, lost: Option<Adapter>) -> u32 {
    let (left, generation) = shared.borrow_mut().begin_session(Session::Opening { lost });
    if let Session::Open(open) = left {
        open.close().await;
    }
    generation
}

/// The page may drive from now on, if the port is still open.
fn settle(shared: &Shared, lost: Option<Adapter>) {
    {
        let mut station = shared.borrow_mut();
        if let Session::Open(open) = &mut station.session
            && let Stage::OnTrial { .. } = open.stage
        {
            open.stage = Stage::Settled;
        }
        if lost.is_some() {
            station.outbox.notice(Notice::AdapterBack);
        }
        station.outbox.touch();
    }
    pump(shared);
}
