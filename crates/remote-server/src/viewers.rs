//! The pages and controllers that are connected: who they are, and what is sent to them.

mod operation;

use std::{
    collections::BTreeMap,
    io, mem,
    net::IpAddr,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    thread,
    time::Duration,
};

use axum::body::Bytes;
use motorlink_driver::{Clock, Commander, Driver, Status};
use motorlink_messages::{Notice, encode};
use motorlink_protocol::Instant;
use motorlink_remote::{FromServer, Participant, Viewer, ViewerId};
use tokio::sync::{broadcast, mpsc, watch};

use self::operation::Output;
pub(crate) use self::operation::{DriveReport, Operation};
use crate::{control_socket::Snapshot, foxglove::Clients};

/// Messages for one page that wait for its connection: challenges of three seconds, and some answers. A page that takes
/// longer misses its challenges, and loses its lease.
const QUEUE: usize = 32;
/// Updates that wait for the slowest page: one or two seconds of them. A page that takes longer misses some.
const UPDATES: usize = 64;

/// How often the lease is looked at.
const LOOK_MAX: Duration = Duration::from_millis(10);
const LOOK_MIN: Duration = Duration::from_millis(1);

/// How a controller is named beside the addresses of pages.
const ON_SOCKET: &str = "socket";

/// The pages and controllers, shared by their connections and the hub.
#[derive(Clone, Debug)]
pub struct Viewers(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    state: Mutex<State>,
    updates: broadcast::Sender<Bytes>,
    foxglove: Clients,
    snapshot: watch::Sender<Arc<Snapshot>>,
}

#[derive(Debug)]
struct State {
    operation: Operation,
    clock: Clock,
    commander: Commander,
    pages: BTreeMap<ViewerId, Page>,
    controllers: BTreeMap<ViewerId, watch::Sender<DriveReport>>,
    /// Notices for one page, which the hub sends with the state.
    notices: BTreeMap<ViewerId, Vec<Notice>>,
    /// Lines for the log of the server.
    log: Vec<String>,
    /// Whether a page waits for a state.
    has_new: bool,
    /// The operator with its lease, and who asks, as every page was told.
    told: (Option<(ViewerId, u32)>, Option<ViewerId>),
    /// How far the driver's clock is ahead of ours, in microseconds, by its newest state.
    driver_ahead_us: i64,
}

#[derive(Debug)]
struct Page {
    address: IpAddr,
    queue: mpsc::Sender<Bytes>,
}

/// What a connection sends to its page.
pub(crate) struct Outgoing {
    /// For this page alone, first.
    pub(crate) own: mpsc::Receiver<Bytes>,
    /// For every page.
    pub(crate) updates: broadcast::Receiver<Bytes>,
}

pub(crate) fn encoded(message: &FromServer) -> Bytes {
    // A message of ours always encodes.
    encode(message).unwrap_or_default().into()
}

impl Viewers {
    /// No page yet. What the operator does goes to this driver.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(commander: Commander) -> io::Result<Self> {
        let (updates, _) = broadcast::channel(UPDATES);
        let state = State {
            operation: Operation::default(),
            clock: Clock::new(),
            commander,
            pages: BTreeMap::new(),
            controllers: BTreeMap::new(),
            notices: BTreeMap::new(),
            log: Vec::new(),
            has_new: false,
            told: (None, None),
            driver_ahead_us: 0,
        };
        let viewers = Self(Arc::new(Shared {
            state: Mutex::new(state),
            updates,
            foxglove: Clients::new(),
            snapshot: watch::Sender::new(Arc::default()),
        }));
        viewers.watch_lease()?;
        Ok(viewers)
    }

    /// Looks at the lease on a thread that does nothing else. The thread of the hub does it too, but may wait for a
    /// terminal.
    fn watch_lease(&self) -> io::Result<()> {
        let shared = Arc::downgrade(&self.0);
        let watch = move || {
            while let Some(shared) = shared.upgrade() {
                let next = Self(shared).turn();
                thread::sleep(next.clamp(LOOK_MIN, LOOK_MAX));
            }
        };
        let thread = thread::Builder::new().name("motorlink lease".to_owned());
        thread.spawn(watch).map(drop)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // No part of the state is left half changed by a panic, and a stop must still come through.
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Tells the operation what has happened, and carries out what follows.
    pub(crate) fn operate<T>(&self, happens: impl FnOnce(&mut Operation, Instant) -> T) -> T {
        let mut state = self.state();
        let now = state.clock.now();
        let done = happens(&mut state.operation, now);
        state.carry_out();
        done
    }

    /// The clients that watch by Foxglove's protocol.
    pub(crate) fn foxglove(&self) -> Clients {
        self.0.foxglove.clone()
    }

    /// A page has connected. Returns nothing if there are too many.
    pub(crate) fn join(&self, address: IpAddr) -> Option<(ViewerId, Outgoing)> {
        let mut state = self.state();
        let now = state.clock.now();
        let viewer = state.operation.join(now, Participant::Page)?;
        let (queue, own) = mpsc::channel(QUEUE);
        let updates = self.0.updates.subscribe();
        let now_us = now.as_micros().saturating_add_signed(state.driver_ahead_us);
        let now = Instant::from_micros(now_us);
        state.pages.insert(viewer, Page { address, queue });
        state.send(viewer, &FromServer::Hello { now });
        state.has_new = true;
        state.tell_control_to(viewer);
        Some((viewer, Outgoing { own, updates }))
    }

    /// A controller has connected. Returns nothing if there are too many.
    pub(crate) fn join_controller(&self) -> Option<(ViewerId, watch::Receiver<DriveReport>)> {
        let mut state = self.state();
        let now = state.clock.now();
        let viewer = state.operation.join(now, Participant::Controller)?;
        let (told, reports) = watch::channel(DriveReport::default());
        state.controllers.insert(viewer, told);
        drop(state);
        // Its first state has a challenge.
        self.turn();
        Some((viewer, reports))
    }

    pub(crate) fn leave(&self, viewer: ViewerId) {
        let mut state = self.state();
        state.pages.remove(&viewer);
        let last = state.operation.leave(viewer);
        if let Some((told, last)) = state.controllers.remove(&viewer).zip(last) {
            told.send_replace(last);
        }
        state.carry_out();
    }

    /// Ends a lease that was not renewed, and sends the challenges that are due. Returns how long to wait for the next call.
    pub(crate) fn turn(&self) -> Duration {
        // A system without random numbers: no lease is renewed, and nobody drives.
        self.operate(|operation, now| operation.turn(now, || getrandom::u64().ok()))
    }

    /// Asks the driver what it does, for the drives of controllers too. Nothing if it has ended or stalls.
    pub(crate) fn ask(&self, driver: &Driver) -> Option<Status> {
        let changes = self.operate(|operation, _| operation.changes());
        let status = driver.status()?;
        self.operate(|operation, _| operation.follow(changes, &status, driver.model()));
        Some(status)
    }

    /// Whether a page has waited for a state since the last call, and the notices for single pages.
    pub(crate) fn take_news(&self) -> (bool, BTreeMap<ViewerId, Vec<Notice>>) {
        let mut state = self.state();
        (mem::take(&mut state.has_new), mem::take(&mut state.notices))
    }

    /// Keeps a notice for the pages that may have given a command that was not carried out.
    pub(crate) fn not_carried_out(&self, notice: &Notice) {
        let mut state = self.state();
        let now = state.clock.now();
        for viewer in state.operation.may_have_commanded(now) {
            state.notice(viewer, notice.clone());
        }
    }

    /// Adds a line to the log of the server, unless it has many.
    pub(crate) fn log(&self, line: String) {
        let mut state = self.state();
        if state.log.len() < QUEUE {
            state.log.push(line);
        }
    }

    /// The lines for the log of the server since the last call.
    #[must_use]
    pub fn take_log(&self) -> Vec<String> {
        mem::take(&mut self.state().log)
    }

    /// Sends a message to one page.
    pub(crate) fn send(&self, viewer: ViewerId, message: &FromServer) {
        self.state().send(viewer, message);
    }

    /// Sends a message to every page.
    pub(crate) fn send_all(&self, message: &FromServer) {
        // Nobody watches.
        let _ = self.0.updates.send(encoded(message));
    }

    /// Who has control, as a text shows it.
    pub(crate) fn operator_name(&self) -> String {
        let state = self.state();
        let operator = state.operation.control().operator();
        let named = operator.and_then(|(holder, _)| state.named(holder));
        named.map_or_else(
            || "nobody".to_owned(),
            |viewer| format!("viewer {} ({})", viewer.number, viewer.address),
        )
    }

    /// The newest state of port and motors, for the clients of the socket.
    pub(crate) fn snapshot(&self) -> &watch::Sender<Arc<Snapshot>> {
        &self.0.snapshot
    }

    /// Whether a page is connected.
    pub(crate) fn are_there(&self) -> bool {
        self.0.updates.receiver_count() > 0
    }

    /// The state of the driver had this time.
    pub(crate) fn driver_is_at(&self, at: Instant) {
        let mut state = self.state();
        let now = state.clock.now();
        let us = |at: Instant| i64::try_from(at.as_micros()).unwrap_or(i64::MAX);
        state.driver_ahead_us = us(at).saturating_sub(us(now));
    }
}

impl State {
    fn send(&self, viewer: ViewerId, message: &FromServer) {
        if let Some(page) = self.pages.get(&viewer) {
            // A page that takes nothing misses it.
            let _ = page.queue.try_send(encoded(message));
        }
    }

    /// Carries out what the operation has decided, in its order, before clients are told.
    fn carry_out(&mut self) {
        for output in mem::take(&mut self.operation.outputs) {
            match output {
                Output::Command(command) => self.commander.command(command),
                Output::Run(message) => self.commander.run(message),
                Output::Challenge(viewer, challenge) => {
                    self.send(viewer, &FromServer::Challenge(challenge));
                }
                Output::TellControl(viewer) => self.tell_control_to(viewer),
                Output::Notice(viewer, notice) => self.notice(viewer, notice),
            }
        }
        let control = self.operation.control();
        let newest = (control.operator(), control.asks());
        if self.told != newest {
            self.told = newest;
            self.has_new = true;
            for viewer in self.pages.keys() {
                self.tell_control_to(*viewer);
            }
        }
        for (viewer, told) in &self.controllers {
            if let Some(newest) = self.operation.report(*viewer) {
                told.send_if_modified(|report| mem::replace(report, newest) != *report);
            }
        }
    }

    fn tell_control_to(&self, viewer: ViewerId) {
        let control = self.operation.control();
        let operator = control.operator();
        let epoch = operator.filter(|(holder, _)| *holder == viewer);
        let message = FromServer::Control {
            epoch: epoch.map(|(_, epoch)| epoch),
            you: viewer.0,
            operator: operator.and_then(|(holder, _)| self.named(holder)),
            asks: control.asks().and_then(|asks| self.named(asks)),
        };
        self.send(viewer, &message);
    }

    fn named(&self, viewer: ViewerId) -> Option<Viewer> {
        let number = viewer.0;
        let address = match self.pages.get(&viewer) {
            Some(page) => page.address.to_string(),
            None => self
                .controllers
                .get(&viewer)
                .map(|_| ON_SOCKET.to_owned())?,
        };
        Some(Viewer { number, address })
    }

    /// Keeps a notice for a page, unless it has many. A controller reads none.
    fn notice(&mut self, viewer: ViewerId, notice: Notice) {
        if !self.pages.contains_key(&viewer) {
            return;
        }
        let notices = self.notices.entry(viewer).or_default();
        if notices.len() < QUEUE {
            notices.push(notice);
        }
    }
}
