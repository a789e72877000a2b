//! What is passed on between the page and the server.

use std::{cell::RefCell, collections::VecDeque, rc::Rc, time::Duration};

use gloo_timers::callback::Interval;
use motorlink_bus::Command;
use motorlink_messages::{
    Adapter, ConnectError, Connection, Notice, ToPage, ToWorker, Update, decode, encode,
    remote::{RemoteRequest, WhoDrives},
};
use motorlink_protocol::Instant;
use motorlink_remote::{ANSWER_AGAIN_EVERY, FromServer, Stamp, ToServer, Viewer};
use web_sys::MessagePort;

use crate::{
    page_clock::PageClock,
    remote::{
        group::{Group, on_group},
        socket::{Closed, Socket},
    },
    scope::{self, Clock, Incoming, post, post_bytes},
    traffic::{send_encoded, send_state},
};

/// [`ANSWER_AGAIN_EVERY`], in milliseconds.
#[expect(clippy::cast_possible_truncation, reason = "25")]
const TICK_MS: u32 = ANSWER_AGAIN_EVERY.as_millis() as u32;
/// After how many ticks the connection is looked at: four times a second. The page is pinged as often: it takes a worker that does not
/// ping for a failed one.
const LOOK_EVERY: u32 = 10;
/// The server sends four messages a second at least. The connection is lost if nothing comes for so long.
const SILENCE_MAX: Duration = Duration::from_millis(1_500);
/// The pause before a lost connection is tried again.
const TRY_AGAIN: Duration = Duration::from_secs(1);
/// How long a connection may take to be made.
const CONNECTS_WITHIN: Duration = Duration::from_secs(5);
/// Pings that the page has not answered. A page that hangs longer has lost its lease long ago.
const PINGS_MAX: usize = 64;
/// The clocks of page and server are compared again if they differ by more than this: the server was started again.
const CLOCK_ERROR_MAX_MS: f64 = 50.0;

/// The state of the worker. Each callback of the browser borrows it once, briefly.
struct Relay {
    clock: Clock,
    page_clock: PageClock,
    link: Link,
    recorder: Option<MessagePort>,
    /// What each ping asks of the page, oldest first: the answer to a challenge, or only a sign of life.
    pings: VecDeque<Option<u64>>,
    /// The newest challenge that the page has answered.
    answered: u64,
    /// The number of the lease, while this page drives.
    epoch: Option<u32>,
    sequence: u32,
    ticks: u32,
    /// The group `Remote` of the page, once it is loaded.
    group: Option<Group>,
    /// What it shows: a text of [`WhoDrives`].
    state: String,
    /// Whether the server has left out something since the last update.
    has_missed: bool,
    /// The zero of the server's clock, in milliseconds since 1970, as the page was told.
    server_origin_ms: Option<f64>,
}

/// The link to the server.
enum Link {
    /// The user has disconnected.
    Off,
    /// The server has another version.
    OtherVersion,
    /// Nothing has come yet, or nothing any more.
    Trying {
        socket: Option<Socket>,
        since: Instant,
    },
    /// The server has sent something.
    Open { socket: Socket, heard: Instant },
}

type Shared = Rc<RefCell<Relay>>;

/// Starts the worker, which connects at once: to watch moves nothing.
pub(crate) fn start() {
    let clock = Clock::new();
    let relay = Rc::new(RefCell::new(Relay {
        page_clock: PageClock::default(),
        link: Link::Off,
        recorder: None,
        group: None,
        pings: VecDeque::new(),
        answered: 0,
        epoch: None,
        sequence: 0,
        ticks: 0,
        has_missed: false,
        state: WhoDrives::Connecting.text(""),
        server_origin_ms: None,
        clock,
    }));
    connect(&relay);
    let of_group = Rc::clone(&relay);
    on_group(move |port| {
        let asking = Rc::clone(&of_group);
        let mut relay = of_group.borrow_mut();
        relay.group = Some(Group::listen(port, move |request| asked(&asking, request)));
        relay.tell();
    });
    let of_page = Rc::clone(&relay);
    scope::on_message(move |incoming| match incoming {
        Incoming::Message(bytes) => match decode(&bytes) {
            Ok(message) => from_page(&of_page, &message, bytes),
            Err(error) => {
                let error = error.to_string().into();
                scope::report("the page sent a message of another build", &error);
            }
        },
        Incoming::TrafficPort(port) => of_page.borrow_mut().recorder = Some(port),
    });
    Interval::new(TICK_MS, move || tick(&relay)).forget();
}

/// Connects to the server.
fn connect(shared: &Shared) {
    let (of_message, of_close) = (Rc::downgrade(shared), Rc::downgrade(shared));
    let socket = Socket::open(
        move |message| {
            if let Some(shared) = of_message.upgrade() {
                shared.borrow_mut().receive(message);
            }
        },
        move |closed| {
            if let Some(shared) = of_close.upgrade() {
                shared.borrow_mut().closed(closed);
            }
        },
    );
    let mut relay = shared.borrow_mut();
    let since = relay.clock.now();
    relay.link = Link::Trying { socket, since };
    relay.tell_link();
}

const fn patience(socket: Option<&Socket>) -> Duration {
    match socket {
        Some(_) => CONNECTS_WITHIN,
        None => TRY_AGAIN,
    }
}

/// Sends the newest answer again: so TCP repeats an earlier lost packet sooner. Looks at the connection from time to time.
fn tick(shared: &Shared) {
    let mut relay = shared.borrow_mut();
    if relay.epoch.is_some() {
        let challenge = relay.answered;
        relay.send(&ToServer::Answer { challenge });
    }
    relay.ticks += 1;
    if relay.ticks == LOOK_EVERY {
        relay.ticks = 0;
        drop(relay);
        look(shared);
    }
}

/// Looks at the connection, and shows the page that this worker lives.
fn look(shared: &Shared) {
    let mut relay = shared.borrow_mut();
    let now = relay.clock.now();
    relay.ping(None);
    match &relay.link {
        Link::Open { heard, .. } if now > *heard + SILENCE_MAX => relay.closed(Closed::Lost),
        Link::Trying { socket, since } if now > *since + patience(socket.as_ref()) => {
            drop(relay);
            connect(shared);
        }
        _ => {}
    }
}

fn from_page(shared: &Shared, message: &ToWorker, bytes: Vec<u8>) {
    match *message {
        ToWorker::Pong { page_ms } => shared.borrow_mut().page_answered(page_ms),
        ToWorker::Command { command, given_ms } => {
            let stops = matches!(command, Command::Stop(_) | Command::StopAll(_));
            shared.borrow_mut().act(bytes, Some(given_ms), stops);
        }
        ToWorker::Run { given_ms, .. } => {
            shared.borrow_mut().act(bytes, Some(given_ms), false);
        }
        ToWorker::Select(_) => shared.borrow_mut().act(bytes, None, false),
        ToWorker::Disconnect => shared.borrow_mut().disconnect(),
        // The motors are the server's.
        ToWorker::ConnectSerial { .. } | ToWorker::ConnectVirtual(_) | ToWorker::VirtualWire(_) => {
        }
    }
}

fn asked(shared: &Shared, request: RemoteRequest) {
    match request {
        RemoteRequest::Watch => {
            let is_on = matches!(
                shared.borrow().link,
                Link::Trying { .. } | Link::Open { .. }
            );
            if !is_on {
                connect(shared);
            }
        }
        RemoteRequest::Ask => shared.borrow().send(&ToServer::Take { by_force: false }),
        RemoteRequest::TakeByForce => shared.borrow().send(&ToServer::Take { by_force: true }),
        RemoteRequest::GiveUp => shared.borrow().send(&ToServer::GiveUp),
    }
}

impl Relay {
    fn send(&self, message: &ToServer) {
        self.send_first(message, false);
    }

    fn send_first(&self, message: &ToServer, stops: bool) {
        if let Link::Open { socket, .. } = &self.link {
            socket.send(message, stops);
        }
    }

    fn ping(&mut self, challenge: Option<u64>) {
        if self.pings.len() < PINGS_MAX {
            self.pings.push_back(challenge);
            post(&ToPage::Ping);
        }
    }

    /// The page has answered the oldest ping.
    fn page_answered(&mut self, page_ms: f64) {
        self.page_clock.heard(self.clock.now(), page_ms);
        if let Some(Some(challenge)) = self.pings.pop_front() {
            self.answered = challenge;
            self.send(&ToServer::Answer { challenge });
        }
    }

    /// Passes on what a person did at this time of the page, or just now.
    fn act(&mut self, message: Vec<u8>, given_ms: Option<f64>, stops: bool) {
        if stops && !matches!(self.link, Link::Open { .. }) {
            // The server stops what this page drove; another page may drive on.
            let mut update = Update::without_motors(self.server_now(), Connection::Connecting);
            update.notices.push(Notice::NotConnected);
            post(&ToPage::Update(update));
        }
        self.sequence += 1;
        let now = self.clock.now();
        let age = given_ms.map_or(Duration::ZERO, |given_ms| {
            self.page_clock.age(now, given_ms)
        });
        let act = ToServer::Act {
            stamp: Stamp {
                epoch: self.epoch.unwrap_or_default(),
                sequence: self.sequence,
                challenge: self.answered,
            },
            age_ms: u32::try_from(age.as_millis()).unwrap_or(u32::MAX),
            message,
        };
        self.send_first(&act, stops);
    }

    fn disconnect(&mut self) {
        self.send(&ToServer::GiveUp);
        self.link = Link::Off;
        self.epoch = None;
        self.tell_link();
    }

    fn receive(&mut self, message: FromServer) {
        let heard = self.clock.now();
        match std::mem::replace(&mut self.link, Link::Off) {
            Link::Open { socket, .. }
            | Link::Trying {
                socket: Some(socket),
                ..
            } => self.link = Link::Open { socket, heard },
            link => {
                self.link = link;
                return;
            }
        }
        match message {
            FromServer::Hello { now } => self.compare_clocks(now),
            FromServer::Challenge(challenge) => self.ping(Some(challenge)),
            FromServer::Page(bytes) => self.pass_on(bytes),
            FromServer::Missed => self.has_missed = true,
            FromServer::Traffic(events) => {
                if let Some(recorder) = &self.recorder {
                    send_encoded(recorder, &events);
                }
            }
            FromServer::Control {
                epoch,
                you,
                operator,
                asks,
            } => {
                let is_new = epoch.is_some() && epoch != self.epoch;
                self.epoch = epoch;
                self.state = state_of(you, operator, asks);
                self.tell();
                if is_new {
                    self.sequence = 0;
                    // The page answers with its settings, which are those of the operator.
                    self.hello();
                }
            }
        }
    }

    /// Posts a message of the server to the page, and an update to the recorder too.
    fn pass_on(&mut self, bytes: Vec<u8>) {
        let bytes = match decode(&bytes) {
            Ok(ToPage::Update(mut update)) => {
                let drives = self.epoch.is_some();
                update.connection = for_page(update.connection, drives);
                if std::mem::take(&mut self.has_missed) {
                    update.notices.push(Notice::Missed);
                }
                let Ok(bytes) = encode(&ToPage::Update(update)) else {
                    return;
                };
                if let Some(recorder) = &self.recorder {
                    send_state(recorder, &bytes);
                }
                bytes
            }
            Ok(_) => bytes,
            Err(error) => {
                let error = error.to_string().into();
                scope::report("the server sent an update of another build", &error);
                return;
            }
        };
        post_bytes(&bytes);
    }

    fn closed(&mut self, closed: Closed) {
        let since = self.clock.now();
        self.link = match closed {
            Closed::Lost => Link::Trying {
                socket: None,
                since,
            },
            Closed::OtherVersion => Link::OtherVersion,
        };
        self.epoch = None;
        self.tell_link();
    }

    /// Tells the page how the link is, while no update of the server comes.
    fn tell_link(&mut self) {
        let (control, connection) = match &self.link {
            Link::Off => (WhoDrives::Off, Connection::Disconnected),
            Link::OtherVersion => (
                WhoDrives::OtherVersion,
                Connection::Failed(ConnectError::Other),
            ),
            Link::Trying { .. } | Link::Open { .. } => {
                (WhoDrives::Connecting, Connection::Connecting)
            }
        };
        if self.server_origin_ms.is_none() {
            self.hello();
        }
        post(&ToPage::Update(Update::without_motors(
            self.server_now(),
            connection,
        )));
        self.state = control.text("");
        self.tell();
    }

    /// Tells the group `Remote`.
    fn tell(&self) {
        if let Some(group) = &self.group {
            group.show(&self.state);
        }
    }

    /// The zero of the clock that the page is told, in milliseconds since 1970.
    fn origin_ms(&self) -> f64 {
        self.server_origin_ms.unwrap_or(self.clock.origin_ms())
    }

    /// Tells the page the clock. It answers as it answers a ping.
    fn hello(&mut self) {
        self.pings.push_back(None);
        post(&ToPage::Hello {
            time_origin_ms: self.origin_ms(),
        });
    }

    /// The server has said its time. The page reads all times of the server by it.
    fn compare_clocks(&mut self, server_now: Instant) {
        let origin_ms = self.unix_ms() - millis(server_now);
        let known = self.server_origin_ms.replace(origin_ms);
        if known.is_some_and(|known| (known - origin_ms).abs() < CLOCK_ERROR_MAX_MS) {
            self.server_origin_ms = known;
        } else {
            self.hello();
        }
    }

    fn unix_ms(&self) -> f64 {
        self.clock.origin_ms() + millis(self.clock.now())
    }

    /// The time of the server.
    fn server_now(&self) -> Instant {
        let ms = (self.unix_ms() - self.origin_ms()).max(0.0);
        Instant::ZERO + Duration::try_from_secs_f64(ms / 1000.0).unwrap_or_default()
    }
}

/// Who drives, for the page with this number.
fn state_of(you: u32, operator: Option<Viewer>, asks: Option<Viewer>) -> String {
    let named = |viewer: Viewer| format!("{} ({})", viewer.number, viewer.address);
    let i_ask = asks.as_ref().is_some_and(|asks| asks.number == you);
    let (control, viewer) = match (operator, asks) {
        (None, _) => (WhoDrives::Free, None),
        (Some(operator), None) if operator.number == you => (WhoDrives::Mine, None),
        (Some(operator), asks) if operator.number == you => (WhoDrives::MineAndAsked, asks),
        (operator, _) if i_ask => (WhoDrives::OthersAndAsked, operator),
        (operator, _) => (WhoDrives::Others, operator),
    };
    control.text(&viewer.map(named).unwrap_or_default())
}

/// The connection as this page has it. An adapter that is lost is the server's.
const fn for_page(of_server: Connection, drives: bool) -> Connection {
    match of_server {
        Connection::Connected(_) => Connection::Connected(if drives {
            Adapter::Remote
        } else {
            Adapter::Watched
        }),
        other => other,
    }
}

fn millis(at: Instant) -> f64 {
    at.since(Instant::ZERO).as_secs_f64() * 1000.0
}
