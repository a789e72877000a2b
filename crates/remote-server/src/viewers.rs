//! The pages and controllers that are connected: who they are, who drives, and what is sent to them.

mod acts;
mod controllers;
mod controlling;

use std::{
    collections::BTreeMap,
    io, mem,
    net::IpAddr,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    thread,
    time::Duration,
};

use axum::body::Bytes;
use motorlink_bus::{Command, StopReason};
use motorlink_driver::{Clock, Commander};
use motorlink_messages::{Notice, encode};
use motorlink_protocol::Instant;
use motorlink_remote::{Control, Ended, FromServer, Participant, Taken, Viewer, ViewerId};
use tokio::sync::{broadcast, mpsc, watch};

use self::controllers::Controllers;
pub(crate) use self::controllers::Own;
use crate::{
    control_socket::Line,
    foxglove::Clients,
    messages::{Garbage, Message},
};

/// Messages for one page that wait for its connection: challenges of three seconds, and some answers. A page that takes
/// longer misses its challenges, and loses its lease.
const QUEUE: usize = 32;
/// Updates that wait for the slowest page: one or two seconds of them. A page that takes longer misses some.
const UPDATES: usize = 64;

/// The driver refuses a command at once, and a busy computer needs longer.
const ANSWERED_WITHIN: Duration = Duration::from_secs(1);
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
    line: watch::Sender<Arc<Line>>,
}

#[derive(Debug)]
struct State {
    control: Control,
    clock: Clock,
    commander: Commander,
    pages: BTreeMap<ViewerId, Page>,
    controllers: Controllers,
    /// Notices for one page, which the hub sends with the state.
    notices: BTreeMap<ViewerId, Vec<Notice>>,
    /// The pages without the lease that have stopped something lately, and when.
    stopped: BTreeMap<ViewerId, Instant>,
    /// Whether a person has stopped all motors, and nobody has released them since. A program does not.
    is_stopped_by_person: bool,
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
            control: Control::default(),
            clock: Clock::new(),
            commander,
            pages: BTreeMap::new(),
            controllers: Controllers::default(),
            notices: BTreeMap::new(),
            stopped: BTreeMap::new(),
            is_stopped_by_person: false,
            log: Vec::new(),
            has_new: false,
            told: (None, None),
            driver_ahead_us: 0,
        };
        let viewers = Self(Arc::new(Shared {
            state: Mutex::new(state),
            updates,
            foxglove: Clients::new(),
            line: watch::Sender::new(Arc::default()),
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

    /// The clients that watch by Foxglove's protocol.
    pub(crate) fn foxglove(&self) -> Clients {
        self.0.foxglove.clone()
    }

    /// A page has connected. Returns nothing if there are too many.
    pub(crate) fn join(&self, address: IpAddr) -> Option<(ViewerId, Outgoing)> {
        let mut state = self.state();
        let now = state.clock.now();
        let viewer = state.control.join(now, Participant::Page)?;
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

    pub(crate) fn leave(&self, viewer: ViewerId) {
        let mut state = self.state();
        state.pages.remove(&viewer);
        state.stopped.remove(&viewer);
        let ended = state.control.leave(viewer);
        state.stop_after(ended);
        state.controllers.remove(viewer);
        state.tell_control();
    }

    /// A message of a page.
    pub(crate) fn received(&self, viewer: ViewerId, message: &[u8]) -> Result<(), Garbage> {
        // Before the lock: what one page sends delays no other.
        let message = Message::read(message)?;
        let mut state = self.state();
        let now = state.clock.now();
        match message {
            Message::Answer { challenge } => state.control.answer(now, viewer, challenge),
            Message::Take { by_force } => {
                if let Taken::Granted(ended) = state.control.take(now, viewer, by_force) {
                    state.stop_after(ended);
                }
                // It may have missed that it holds the lease.
                state.tell_control_to(viewer);
                state.tell_control();
            }
            Message::GiveUp => {
                let ended = state.control.give_up(viewer);
                state.stop_after(ended);
                state.tell_control();
            }
            Message::Command(act, command) => state.command(now, viewer, act, command),
            Message::Select(act, id) => {
                if state.control.act(now, viewer, act.stamp, false).is_ok() {
                    state.commander.command(Command::Watch(id));
                }
            }
            Message::Run(act, message) => state.run(now, viewer, act, message),
            Message::ForOwnComputer => {}
        }
        Ok(())
    }

    /// Ends a lease that was not renewed, and sends the challenges that are due. Returns how long to wait for the next call.
    pub(crate) fn turn(&self) -> Duration {
        let mut state = self.state();
        let now = state.clock.now();
        if let Some(ended) = state.control.expire(now) {
            state.stop_after(Some(ended));
            state.tell_control();
        }
        // A system without random numbers: no lease is renewed, and nobody drives.
        for (viewer, challenge) in state.control.challenge(now, random) {
            if !state.controllers.challenge(viewer, challenge) {
                state.send(viewer, &FromServer::Challenge(challenge));
            }
        }
        let next = state.control.next_turn();
        next.map_or(Duration::MAX, |at| at.since(now))
    }

    /// Whether a page has waited for a state since the last call, and the notices for single pages.
    pub(crate) fn take_news(&self) -> (bool, BTreeMap<ViewerId, Vec<Notice>>) {
        let mut state = self.state();
        (mem::take(&mut state.has_new), mem::take(&mut state.notices))
    }

    /// Keeps a notice for the pages that may have given a command that was not carried out: the operator, and who has
    /// stopped something within a second.
    pub(crate) fn not_carried_out(&self, notice: &Notice) {
        let mut state = self.state();
        let now = state.clock.now();
        state.stopped.retain(|_, at| *at + ANSWERED_WITHIN > now);
        let operator = state.control.operator().map(|(holder, _)| holder);
        let given: Vec<_> = operator
            .into_iter()
            .chain(state.stopped.keys().copied())
            .collect();
        for viewer in given {
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

/// A number that nobody guesses.
fn random() -> Option<u64> {
    getrandom::u64().ok()
}

impl State {
    fn send(&self, viewer: ViewerId, message: &FromServer) {
        if let Some(page) = self.pages.get(&viewer) {
            // A page that takes nothing misses it.
            let _ = page.queue.try_send(encoded(message));
        }
    }

    /// Stops what a lease drove that has ended.
    fn stop_after(&mut self, ended: Option<Ended>) {
        if let Some(why) = ended {
            let stop = Command::StopAll(StopReason::OperatorLost);
            self.commander.command(stop);
            self.controllers.lease_ended(why);
        }
    }

    /// Tells every page who drives, if that has changed.
    fn tell_control(&mut self) {
        let newest = (self.control.operator(), self.control.asks());
        if self.told != newest {
            self.told = newest;
            self.has_new = true;
            for viewer in self.pages.keys() {
                self.tell_control_to(*viewer);
            }
            let operator = newest.0.map(|(holder, _)| holder);
            self.controllers.tell_operator(operator);
        }
    }

    fn tell_control_to(&self, viewer: ViewerId) {
        let operator = self.control.operator();
        let epoch = operator.filter(|(holder, _)| *holder == viewer);
        let message = FromServer::Control {
            epoch: epoch.map(|(_, epoch)| epoch),
            you: viewer.0,
            operator: operator.and_then(|(holder, _)| self.named(holder)),
            asks: self.control.asks().and_then(|asks| self.named(asks)),
        };
        self.send(viewer, &message);
    }

    fn named(&self, viewer: ViewerId) -> Option<Viewer> {
        let number = viewer.0;
        let address = match self.pages.get(&viewer) {
            Some(page) => page.address.to_string(),
            None => self
                .controllers
                .list
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
