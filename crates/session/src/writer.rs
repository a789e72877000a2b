//! The writer of sessions: takes records, returns bytes of a file.

use std::{collections::BTreeMap, time::Duration};

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_messages::{Update, stored_state};
use motorlink_protocol::{Faults, Instant, MotorId, Reply};

use crate::{
    channels::{
        Topic, events,
        link::{Meter, Second},
        rover::{Moved, Rover},
        schemas,
        state::{self, Replies},
        telemetry::{Motors, Reported},
        wire::Batch,
    },
    clock::utc_ns,
    format,
    mcap::container::Container,
    overview::Overview,
    record::{Event, EventKind, Record, What},
};

/// A state is at most so much older than a record behind it: less than a replay looks back.
const STATE_EVERY: Duration = Duration::from_secs(2);

/// A line that is open has a record in a shorter time. If none came for so long, the page was closed, or its worker
/// stood still.
pub(crate) const STATE_HOLDS: Duration = Duration::from_secs(5);

/// Writes a session file. The caller takes the bytes regularly ([`Writer::take`]). The writer keeps one chunk, the
/// overview and the index: a few megabytes for an hour.
#[derive(Debug)]
pub struct Writer {
    container: Container,
    /// The wall clock at [`Instant::ZERO`], in microseconds since 1970.
    zero_unix_us: i64,
    last: Instant,
    batch: Batch,
    /// Telemetry of the frames in the batch. It is written after them, so that times in the file increase.
    telemetry: Vec<(MotorId, Instant, String)>,
    spare: Vec<String>,
    motors: Motors,
    meter: Meter,
    /// With the channels of `/odom` and `/cmd_vel`.
    rover: Option<(Rover, [u16; 2])>,
    overview: Overview,
    wire: u16,
    events: u16,
    link: u16,
    state: Option<u16>,
    replies: Replies,
    /// The last state, and when it was last written.
    last_state: Option<(Instant, Update)>,
    telemetry_schema: u16,
    channels: BTreeMap<MotorId, u16>,
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
        let mut channel = |(name, json), topic: &str| {
            let schema = container.schema(name, json);
            container.channel(schema, topic.to_owned())
        };
        let wire = channel(schemas::WIRE, Topic::WIRE);
        let events = channel(schemas::EVENT, Topic::EVENTS);
        let link = channel(schemas::LINK, Topic::LINK);
        let rover = about.iter().find(|(name, _)| *name == format::ROVER_KEY);
        let rover = rover.and_then(|(_, json)| Rover::from_json(json));
        let rover = rover.map(|rover| {
            let odom = channel(schemas::ODOMETRY, Topic::ODOM);
            (rover, [odom, channel(schemas::TWIST, Topic::CMD_VEL)])
        });
        let (name, json) = schemas::TELEMETRY;
        let telemetry_schema = container.schema(name, json);
        Self {
            container,
            zero_unix_us,
            last: Instant::ZERO,
            batch: Batch::default(),
            telemetry: Vec::new(),
            spare: Vec::new(),
            motors: Motors::default(),
            meter: Meter::default(),
            rover,
            overview: Overview::default(),
            wire,
            events,
            link,
            state: None,
            replies: Replies::default(),
            last_state: None,
            telemetry_schema,
            channels: BTreeMap::new(),
        }
    }

    /// Sets a new offset of the wall clock for the following records.
    pub fn set_clock(&mut self, zero_unix_us: i64) {
        if self.zero_unix_us != zero_unix_us {
            self.flush();
            self.zero_unix_us = zero_unix_us;
        }
    }

    /// Adds an event of the bus.
    pub fn line(&mut self, event: &LineEvent) {
        self.repeat_state(event.at);
        if let LineEventKind::ModelSelected(model) = event.kind {
            self.flush();
            self.batch.set_model(model);
            self.replies.set_model(model);
            self.overview.set_model(model);
            self.motors.add_event(event);
            return;
        }
        if let Some(second) = self.meter.add_event(event) {
            self.flush();
            self.second(&second);
        } else if self.batch.is_full_for(event.at) {
            self.flush();
        }
        self.last = event.at;
        self.batch.push(event);
        self.replies.add_event(event);
        self.count(event.at, What::Line(event.kind));
        let reported = self.motors.add_event(event);
        if let Some((rover, _)) = &mut self.rover {
            rover.add_event(self.motors.model(), event);
            if let Some(reported) = &reported {
                rover.add_reply(event.at, &reported.reply);
            }
        }
        if let Some(reported) = reported {
            self.reported(event.at, &reported);
        }
    }

    fn reported(&mut self, at: Instant, reported: &Reported) {
        let mut json = self.spare.pop().unwrap_or_default();
        reported.write(&mut json, at);
        self.telemetry.push((reported.reply.id, at, json));
        if let Some(before) = reported.faults_changed {
            self.put_event(at, &faults_event(&reported.reply, before));
        }
    }

    /// Adds an event between frames. Faults are derived from replies, so fault events are ignored here.
    pub fn event(&mut self, at: Instant, event: &Event) {
        let is_of_line = matches!(event.kind, EventKind::Connected | EventKind::Disconnected);
        if let Some((rover, _)) = self.rover.as_mut().filter(|_| is_of_line) {
            rover.cut_off();
        }
        if event.kind != EventKind::Fault {
            self.put_event(at, event);
        }
    }

    /// Adds what the page showed from this time on, as `motorlink_messages::stored_state` stores it.
    pub fn state(&mut self, at: Instant, stored: &[u8]) {
        let Some(mut update) = stored_state::read(stored, at) else {
            return;
        };
        self.put_state(at, update.clone());
        self.overview.reach(at, utc_ns(self.zero_unix_us, at));
        update.samples = Vec::new();
        self.last = at;
        self.last_state = Some((at, update));
    }

    fn put_state(&mut self, at: Instant, update: Update) {
        self.flush();
        let log_ns = utc_ns(self.zero_unix_us, at);
        let container = &mut self.container;
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

    fn put_event(&mut self, at: Instant, event: &Event) {
        self.repeat_state(at);
        self.flush();
        self.last = at;
        self.count(at, What::Event(event.clone()));
        let json = events::json(at, event);
        let log_ns = utc_ns(self.zero_unix_us, at);
        self.container.message(self.events, log_ns, json.as_bytes());
    }

    fn count(&mut self, at: Instant, what: What) {
        let utc_ns = utc_ns(self.zero_unix_us, at);
        self.overview.add(&Record { at, utc_ns, what });
    }

    fn second(&mut self, second: &Second) {
        let log_ns = utc_ns(self.zero_unix_us, second.began());
        let json = second.json();
        self.container.message(self.link, log_ns, json.as_bytes());
    }

    /// Writes the frames so far, and their telemetry.
    fn flush(&mut self) {
        if let Some((at, json)) = self.batch.end() {
            let log_ns = utc_ns(self.zero_unix_us, at);
            self.container.message(self.wire, log_ns, json.as_bytes());
        }
        for (id, at, json) in self.telemetry.drain(..) {
            let container = &mut self.container;
            let channel = *self.channels.entry(id).or_insert_with(|| {
                let topic = format!("/motors/{}/telemetry", id.get());
                container.channel(self.telemetry_schema, topic)
            });
            let log_ns = utc_ns(self.zero_unix_us, at);
            container.message(channel, log_ns, json.as_bytes());
            self.spare.push(json);
        }
        let Some((rover, [odom, cmd_vel])) = &mut self.rover else {
            return;
        };
        for moved in rover.take() {
            let channel = match moved {
                Moved::Odometry(_) => *odom,
                Moved::Command(..) => *cmd_vel,
            };
            let log_ns = utc_ns(self.zero_unix_us, moved.at());
            let json = moved.json(log_ns);
            self.container.message(channel, log_ns, json.as_bytes());
        }
    }

    /// Adds an attachment, such as the setup.
    pub fn attach(&mut self, name: &str, media_type: &str, data: &[u8]) {
        self.flush();
        let log_ns = utc_ns(self.zero_unix_us, self.last);
        self.container.attach(log_ns, name, media_type, data);
    }

    /// Number of completed bytes that were not taken.
    #[must_use]
    pub const fn written(&self) -> usize {
        self.container.written()
    }

    /// Takes the completed bytes.
    pub fn take(&mut self) -> Vec<u8> {
        self.container.take()
    }

    /// Ends the file. Returns the bytes that were not taken.
    #[must_use]
    pub fn finish(mut self) -> Vec<u8> {
        self.flush();
        if let Some(second) = self.meter.end() {
            self.second(&second);
        }
        let overview = self.overview.to_json();
        self.attach(format::OVERVIEW, "application/json", overview.as_bytes());
        self.container.finish()
    }
}

/// A change of the faults of a motor.
fn faults_event(reply: &Reply, before: Faults) -> Event {
    let id = reply.id.get();
    if reply.faults.is_none() {
        return Event::new(
            EventKind::Fault,
            format!("Motor {id}: no fault any more ({before})"),
        );
    }
    Event::new(EventKind::Fault, format!("Motor {id}: {}", reply.faults)).bad()
}
