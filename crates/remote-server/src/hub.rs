//! What happens on the line, on its way to the pages.

use std::{collections::BTreeMap, time::Duration};

use motorlink_bus::{Event, LineEvent};
use motorlink_driver::{Driver, Entry, Status};
use motorlink_messages::{
    Adapter, Connection, Notice, Outbox, ToPage, Update, encode, recorder::push_traffic,
};
use motorlink_protocol::Instant;
use motorlink_remote::{FromServer, ViewerId};

use crate::{control_socket, foxglove, viewers::Viewers};

/// The longest time between two turns. The hub checks the lease as often as the thread that does nothing else.
const TURN_MAX: Duration = Duration::from_millis(10);
/// The shortest: twice as often as a page is told a change.
const TURN_MIN: Duration = Duration::from_millis(2);
/// How often line events go to the pages, as in the page's own worker.
const TRAFFIC_EVERY: Duration = Duration::from_millis(50);
/// How often the pages get the state of a quiet line, as often as the page's own worker sends it.
const STATE_EVERY: Duration = Duration::from_millis(250);

/// Takes the entries of the driver, and tells the pages.
#[derive(Debug)]
pub struct Hub {
    foxglove: foxglove::Feed,
    socket: control_socket::Feed,
    viewers: Viewers,
    outbox: Outbox,
    traffic: Vec<LineEvent>,
    traffic_sent: std::time::Instant,
    adapter: Adapter,
    is_open: bool,
    is_stopping: bool,
    /// The time of the newest state, by the driver's clock and by ours.
    newest: Option<(Instant, std::time::Instant)>,
}

impl Hub {
    /// Nothing has happened yet. The driver has opened this adapter.
    #[must_use]
    pub fn new(viewers: Viewers, adapter: Adapter) -> Self {
        let now = std::time::Instant::now();
        Self {
            foxglove: foxglove::Feed::new(viewers.foxglove()),
            socket: control_socket::Feed::new(viewers.clone()),
            viewers,
            outbox: Outbox::default(),
            traffic: Vec::new(),
            traffic_sent: now,
            adapter,
            is_open: true,
            is_stopping: false,
            newest: None,
        }
    }

    /// Takes an entry of the driver, and its time.
    pub fn take(&mut self, at: Instant, entry: Entry) {
        self.foxglove.take(at, &entry);
        self.socket.take(&entry);
        match entry {
            Entry::Event(Event::Line(event)) => self.traffic.push(event),
            Entry::Event(event) => {
                match event {
                    Event::StopBegan(_) => self.is_stopping = true,
                    Event::StopEnded(_) => self.is_stopping = false,
                    _ => {}
                }
                self.outbox.event(event, self.is_stopping);
            }
            Entry::Refused { command, refusal } => {
                let notice = Notice::Refused { command, refusal };
                self.viewers.not_carried_out(&notice);
            }
            Entry::TooLate(command) => self.viewers.not_carried_out(&Notice::TooLate(command)),
            Entry::NotConnected(_) => self.viewers.not_carried_out(&Notice::NotConnected),
            Entry::PortLost { driven } => {
                self.is_open = false;
                self.outbox.notice(Notice::AdapterLost { driven });
            }
            Entry::PortBack => {
                self.is_open = true;
                self.outbox.notice(Notice::AdapterBack);
            }
            Entry::Run(message) => {
                let message = encode(&*message).unwrap_or_default();
                self.viewers.send_all(&to_page(&ToPage::Run(message)));
            }
            Entry::NotRemembered => self.outbox.notice(Notice::NotRemembered),
        }
    }

    /// Does what is due. Returns how long to wait for the next entry at most.
    pub fn turn(&mut self, driver: &Driver) -> Duration {
        let lease = self.viewers.turn();
        self.foxglove.turn(driver);
        self.socket.turn(driver);
        let now = std::time::Instant::now();
        if self.viewers.are_there() {
            if !self.traffic.is_empty() && now >= self.traffic_sent + TRAFFIC_EVERY {
                self.send_traffic(now);
            }
            let (is_awaited, notices) = self.viewers.take_news();
            if is_awaited || !notices.is_empty() || self.is_state_due(now) {
                self.send_state(driver, notices);
            }
        } else {
            self.traffic.clear();
        }
        lease.clamp(TURN_MIN, TURN_MAX)
    }

    fn is_state_due(&self, now: std::time::Instant) -> bool {
        let Some((at, seen)) = self.newest else {
            return true;
        };
        let age = now.saturating_duration_since(seen);
        let driver_now = at + age;
        let due = self.outbox.due(driver_now);
        // On a quiet line only counters change.
        age >= STATE_EVERY || due.is_some_and(|due| due <= driver_now)
    }

    /// Sends the state of this moment to every page, and these notices to one each.
    fn send_state(&mut self, driver: &Driver, notices: BTreeMap<ViewerId, Vec<Notice>>) {
        // The driver has ended, or stalls: the pages see that nothing comes.
        let Some(status) = driver.status() else {
            return;
        };
        self.newest = Some((status.now, std::time::Instant::now()));
        self.viewers.driver_is_at(status.now);
        let mut update = self.state(status);
        for (viewer, notices) in notices {
            let mut own = update.clone();
            own.notices = notices;
            self.viewers.send(viewer, &to_page(&ToPage::Update(own)));
        }
        self.outbox.fill(&mut update);
        self.viewers.send_all(&to_page(&ToPage::Update(update)));
    }

    fn state(&self, status: Status) -> Update {
        let connection = if self.is_open {
            Connection::Connected(self.adapter)
        } else {
            Connection::Reconnecting(self.adapter)
        };
        Update {
            halted: status.is_halted,
            motors: status.motors,
            job: status.job,
            raw: status.raw,
            line: status.line,
            ..Update::without_motors(status.now, connection)
        }
    }

    fn send_traffic(&mut self, now: std::time::Instant) {
        let mut buffer = Vec::new();
        for event in self.traffic.drain(..) {
            push_traffic(&mut buffer, &event);
        }
        self.traffic_sent = now;
        self.viewers.send_all(&FromServer::Traffic(buffer));
    }
}

fn to_page(message: &ToPage) -> FromServer {
    // A message of ours always encodes.
    FromServer::Page(encode(message).unwrap_or_default())
}
