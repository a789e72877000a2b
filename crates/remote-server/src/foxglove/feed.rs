//! From the entries of the driver to the messages of a session.

use std::{
    collections::BTreeSet,
    time::{Duration, Instant as Moment},
};

use motorlink_bus::{Event, LineEvent, LineEventKind};
use motorlink_driver::{Driver, Entry, words, zero_unix_us};
use motorlink_protocol::{Instant, MotorId};
use motorlink_session::{Channel, Message, Messages};

use super::clients::Clients;

/// How long a message waits at most: as long as one to a page.
const FLUSH_EVERY: Duration = Duration::from_millis(50);
/// How often the wall clock is read at most. A Pi has no clock of its own: the network sets its time some time after the
/// start. Times do not jump while a client is subscribed.
const CLOCK_EVERY: Duration = Duration::from_secs(10);

/// Makes messages for the clients.
#[derive(Debug)]
pub(crate) struct Feed {
    clients: Clients,
    messages: Messages,
    motors: BTreeSet<MotorId>,
    /// Whether the messages know the model of the line.
    knows_model: bool,
    /// Whether a client is subscribed: only then JSON is made.
    is_wanted: bool,
    flushed: Moment,
    clock_read: Option<Moment>,
}

impl Feed {
    pub(crate) fn new(clients: Clients) -> Self {
        Self {
            clients,
            messages: Messages::default(),
            motors: BTreeSet::new(),
            knows_model: false,
            is_wanted: false,
            flushed: Moment::now(),
            clock_read: None,
        }
    }

    /// Takes an entry of the driver.
    pub(crate) fn take(&mut self, at: Instant, entry: &Entry) {
        let Self {
            clients,
            messages,
            motors,
            ..
        } = self;
        let mut meet = |id| {
            if motors.insert(id) {
                clients.add_motor(id);
            }
        };
        let mut put = |message: Message<'_>| {
            if let Channel::Telemetry(id) = message.channel {
                meet(id);
            }
            clients.put(&message);
        };
        match entry {
            Entry::Event(Event::Line(event)) if self.is_wanted => {
                messages.line(event, &mut put);
            }
            Entry::Event(Event::Line(event)) => {
                if let Some(id) = messages.follow(event) {
                    meet(id);
                }
            }
            entry => {
                if self.is_wanted
                    && let Some(event) = words::session_event(entry)
                {
                    messages.event(at, &event, &mut put);
                }
            }
        }
    }

    /// Does what is due.
    pub(crate) fn turn(&mut self, driver: &Driver) {
        if !self.knows_model {
            // The driver told it before there was a feed.
            self.knows_model = true;
            let kind = LineEventKind::ModelSelected(driver.model());
            let at = Instant::ZERO;
            self.messages.follow(&LineEvent { at, kind });
        }
        let was_wanted = std::mem::replace(&mut self.is_wanted, self.clients.are_subscribed());
        if self.is_wanted && !was_wanted {
            self.read_clock(driver);
        }
        if self.flushed.elapsed() >= FLUSH_EVERY {
            self.flushed = Moment::now();
            let clients = &self.clients;
            self.messages.flush(&mut |message| clients.put(&message));
        }
    }

    fn read_clock(&mut self, driver: &Driver) {
        let is_new = |read: Moment| read.elapsed() < CLOCK_EVERY;
        if self.clock_read.is_some_and(is_new) {
            return;
        }
        // The driver has ended, or stalls: nothing happens then.
        if let Some(status) = driver.status() {
            self.clock_read = Some(Moment::now());
            let zero = zero_unix_us(status.now);
            self.messages.set_clock(zero, &mut |_| ());
        }
    }
}
