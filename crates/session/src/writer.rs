//! The writer of sessions: takes records, returns bytes of a file.

use std::time::Duration;

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_messages::{Update, stored_state};
use motorlink_protocol::Instant;

use crate::{
    channels::{
        Channel, Topic,
        rover::Rover,
        schemas,
        state::{self, Replies},
    },
    format,
    mcap::container::Container,
    messages::{Message, Messages},
    overview::Overview,
    record::{Event, EventKind, Record, STATE_HOLDS, What},
};

/// A state is at most so much older than a record behind it: less than a replay looks back.
const STATE_EVERY: Duration = Duration::from_secs(2);

/// Writes a session file. The caller takes the bytes regularly ([`Writer::take`]). The writer keeps one chunk, the
/// overview and the index: a few megabytes for an hour.
#[derive(Debug)]
pub struct Writer {
    file: JsonFile,
    messages: Messages,
    last: Instant,
    overview: Overview,
    state: Option<u16>,
    replies: Replies,
    /// The last state, and when it was last written.
    last_state: Option<(Instant, Update)>,
}

/// The container with the channels of the JSON messages.
#[derive(Debug)]
struct JsonFile {
    container: Container,
    telemetry_schema: u16,
    /// A few. To search a map takes more code than the browser should load.
    channels: Vec<(Channel, u16)>,
}

impl JsonFile {
    fn add(&mut self, channel: Channel, schema: u16) -> u16 {
        let number = self.container.channel(schema, &channel.topic());
        self.channels.push((channel, number));
        number
    }

    /// Puts messages into the file. One function does it, for all that make messages.
    fn putting(&mut self) -> impl FnMut(Message<'_>) {
        |message| self.put(&message)
    }

    fn put(&mut self, message: &Message<'_>) {
        let found = self.channels.iter().find(|(it, _)| *it == message.channel);
        let channel = match found {
            Some((_, channel)) => *channel,
            // The others are there from the start.
            None => self.add(message.channel, self.telemetry_schema),
        };
        self.container
            .message(channel, message.log_ns, message.json.as_bytes());
    }
}

impl Writer {
    /// Starts a file. `zero_unix_us` is the wall clock at [`Instant::ZERO`], in microseconds since 1970, UTC. `about`
    /// describes the origin of the session in names and values, such as the version of the page. The value of `rover`, a
    /// `Vehicle` as JSON, adds the motion of that rover.
    #[must_use]
    pub fn new(zero_unix_us: i64, about: &[(&str, &str)]) -> Self {
        let library = concat!("motorlink-session ", env!("CARGO_PKG_VERSION"));
        let mut container = Container::new(format::PROFILE, library);
        let own = [(format::VERSION_KEY, format::VERSION_TEXT)];
        container.metadata(format::METADATA, &[&own, about].concat());
        let rover = about.iter().find(|(name, _)| *name == format::ROVER_KEY);
        let rover = rover.and_then(|(_, json)| Rover::from_json(json));
        let mut file = JsonFile {
            container,
            telemetry_schema: 0,
            channels: Vec::new(),
        };
        let channels = [
            Channel::Wire,
            Channel::Events,
            Channel::Link,
            Channel::Odometry,
            Channel::CommandedMotion,
        ];
        let count = if rover.is_some() { 5 } else { 3 };
        for channel in channels.into_iter().take(count) {
            let (name, json) = channel.schema();
            let schema = file.container.schema(name, json);
            file.add(channel, schema);
        }
        let (name, json) = schemas::TELEMETRY;
        file.telemetry_schema = file.container.schema(name, json);
        Self {
            file,
            messages: Messages::new(zero_unix_us).with_rover(rover),
            last: Instant::ZERO,
            overview: Overview::default(),
            state: None,
            replies: Replies::default(),
            last_state: None,
        }
    }

    /// Sets a new offset of the wall clock for the following records.
    pub fn set_clock(&mut self, zero_unix_us: i64) {
        self.messages
            .set_clock(zero_unix_us, &mut self.file.putting());
    }

    /// Adds an event of the bus.
    pub fn line(&mut self, event: &LineEvent) {
        self.repeat_state(event.at);
        let fault = self.messages.line(event, &mut self.file.putting());
        if let LineEventKind::ModelSelected(model) = event.kind {
            self.replies.set_model(model);
            self.overview.set_model(model);
            return;
        }
        self.last = event.at;
        self.replies.add_event(event);
        self.count(event.at, What::Line(event.kind));
        if let Some((at, fault)) = fault {
            self.count(at, What::Event(fault));
        }
    }

    /// Adds an event between frames. Faults are derived from replies, so fault events are ignored here.
    pub fn event(&mut self, at: Instant, event: &Event) {
        if event.kind == EventKind::Fault {
            return;
        }
        self.repeat_state(at);
        self.messages.event(at, event, &mut self.file.putting());
        self.last = at;
        self.count(at, What::Event(event.clone()));
    }

    /// Adds what the page showed from this time on, as `motorlink_messages::stored_state` stores it.
    pub fn state(&mut self, at: Instant, stored: &[u8]) {
        let Some(mut update) = stored_state::read(stored, at) else {
            return;
        };
        self.put_state(at, update.clone());
        self.overview.state(&update, self.messages.utc_ns(at));
        update.samples = Vec::new();
        self.last = at;
        self.last_state = Some((at, update));
    }

    fn put_state(&mut self, at: Instant, update: Update) {
        self.flush();
        let log_ns = self.messages.utc_ns(at);
        let container = &mut self.file.container;
        let channel = self
            .state
            .get_or_insert_with(|| container.own_channel(state::ENCODING, Topic::STATE));
        let message = if container.is_first(*channel, log_ns) {
            self.replies.whole(at, update)
        } else {
            self.replies.message(at, update)
        };
        container.message(*channel, log_ns, &message);
    }

    /// Writes the state again if it is old: a jump reads the last seconds only. Behind a gap it holds no more.
    fn repeat_state(&mut self, now: Instant) {
        if now.since(self.last) > STATE_HOLDS {
            self.last_state = None;
        }
        if let Some((written, update)) = &mut self.last_state
            && now.since(*written) >= STATE_EVERY
        {
            *written = now;
            // Its readings keep their times.
            update.now = now;
            let update = update.clone();
            self.put_state(now, update);
        }
    }

    /// Adds a record of another session.
    pub fn record(&mut self, record: &Record) {
        self.set_clock(crate::clock::zero_unix_us(record.at, record.utc_ns));
        match &record.what {
            What::Line(kind) => self.line(&LineEvent {
                at: record.at,
                kind: *kind,
            }),
            What::Event(event) => self.event(record.at, event),
            What::State(update) => self.state(record.at, &stored_state::store((**update).clone())),
        }
    }

    fn count(&mut self, at: Instant, what: What) {
        let utc_ns = self.messages.utc_ns(at);
        self.overview.add(&Record { at, utc_ns, what });
    }

    /// Writes the frames so far, and their telemetry.
    fn flush(&mut self) {
        self.messages.flush(&mut self.file.putting());
    }

    /// Adds an attachment, such as the setup.
    pub fn attach(&mut self, name: &str, media_type: &str, data: &[u8]) {
        self.flush();
        let log_ns = self.messages.utc_ns(self.last);
        self.file.container.attach(log_ns, name, media_type, data);
    }

    /// Number of completed bytes that were not taken.
    #[must_use]
    pub const fn written(&self) -> usize {
        self.file.container.written()
    }

    /// Takes the completed bytes.
    pub fn take(&mut self) -> Vec<u8> {
        self.file.container.take()
    }

    /// Ends the file. Returns the bytes that were not taken.
    #[must_use]
    pub fn finish(mut self) -> Vec<u8> {
        self.messages.end(&mut self.file.putting());
        let overview = self.overview.to_json();
        self.attach(format::OVERVIEW, "application/json", overview.as_bytes());
        self.file.container.finish()
    }
}
