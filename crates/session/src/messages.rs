//! The messages of a session: takes records, tells JSON by channel. The writer puts them into a file.

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_protocol::{Faults, Instant, MotorId, Reply, family::Model};

use crate::{
    channels::{
        Channel, events,
        link::{Meter, Second},
        rover::{Moved, Rover},
        telemetry::{Motors, Reported},
        wire::Batch,
    },
    clock::utc_ns,
    record::{Event, EventKind},
};

/// A message of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Message<'a> {
    /// Its channel.
    pub channel: Channel,
    /// Its time, in nanoseconds since 1970, UTC.
    pub log_ns: u64,
    /// What it says.
    pub json: &'a str,
}

/// Makes the messages of the channels with JSON. Each function gives those that are complete to `put`, in the order of a
/// session file.
#[derive(Debug, Default)]
pub struct Messages {
    /// The wall clock at [`Instant::ZERO`], in microseconds since 1970.
    zero_unix_us: i64,
    batch: Batch,
    /// Telemetry of the frames in the batch. It is told after them, so that times increase.
    telemetry: Vec<(MotorId, Instant, String)>,
    spare: Vec<String>,
    motors: Motors,
    meter: Meter,
    rover: Option<Rover>,
}

impl Messages {
    /// No record yet. `zero_unix_us` is the wall clock at [`Instant::ZERO`], in microseconds since 1970, UTC.
    #[must_use]
    pub fn new(zero_unix_us: i64) -> Self {
        Self {
            zero_unix_us,
            ..Self::default()
        }
    }

    /// With the motion of this rover.
    pub(crate) fn with_rover(self, rover: Option<Rover>) -> Self {
        Self { rover, ..self }
    }

    /// Nanoseconds since 1970 at this time.
    pub(crate) fn utc_ns(&self, at: Instant) -> u64 {
        utc_ns(self.zero_unix_us, at)
    }

    /// Sets a new offset of the wall clock for the following records.
    pub fn set_clock(&mut self, zero_unix_us: i64, put: &mut dyn FnMut(Message<'_>)) {
        if self.zero_unix_us != zero_unix_us {
            self.flush(put);
            self.zero_unix_us = zero_unix_us;
        }
    }

    /// Takes an event of the bus. Returns the change of faults that it reports, which is a message of `/events` too.
    pub fn line(
        &mut self,
        event: &LineEvent,
        put: &mut dyn FnMut(Message<'_>),
    ) -> Option<(Instant, Event)> {
        if let LineEventKind::ModelSelected(model) = event.kind {
            self.flush(put);
            self.select(model, event);
            return None;
        }
        if let Some(second) = self.meter.add_event(event) {
            self.flush(put);
            self.second(&second, put);
        } else if self.batch.is_full_for(event.at) {
            self.flush(put);
        }
        self.batch.push(event);
        let reported = self.motors.add_event(event);
        if let Some(rover) = &mut self.rover {
            rover.add_event(self.motors.model(), event);
            if let Some(reported) = &reported {
                rover.add_reply(event.at, &reported.reply);
            }
        }
        self.reported(event.at, &reported?, put)
    }

    /// Takes an event of the bus that no message tells. What the following messages depend on is kept: setpoints, turns,
    /// faults. Returns the motor if it is a reply of which telemetry would be told. It drops what was not yet told.
    pub fn follow(&mut self, event: &LineEvent) -> Option<MotorId> {
        self.batch.end();
        self.spare
            .extend(self.telemetry.drain(..).map(|(_, _, json)| json));
        self.meter = Meter::default();
        if let LineEventKind::ModelSelected(model) = event.kind {
            self.select(model, event);
            return None;
        }
        Some(self.motors.add_event(event)?.reply.id)
    }

    fn select(&mut self, model: Model, event: &LineEvent) {
        self.batch.set_model(model);
        self.motors.add_event(event);
    }

    fn reported(
        &mut self,
        at: Instant,
        reported: &Reported,
        put: &mut dyn FnMut(Message<'_>),
    ) -> Option<(Instant, Event)> {
        let mut json = self.spare.pop().unwrap_or_default();
        reported.write(&mut json, at);
        self.telemetry.push((reported.reply.id, at, json));
        let event = faults_event(&reported.reply, reported.faults_changed?);
        self.put_event(at, &event, put);
        Some((at, event))
    }

    /// Takes an event between frames. Changes of faults are derived from replies, so they are ignored here.
    pub fn event(&mut self, at: Instant, event: &Event, put: &mut dyn FnMut(Message<'_>)) {
        if matches!(event.kind, EventKind::Connected | EventKind::Disconnected)
            && let Some(rover) = &mut self.rover
        {
            rover.cut_off();
        }
        if event.kind != EventKind::Fault {
            self.put_event(at, event, put);
        }
    }

    fn put_event(&mut self, at: Instant, event: &Event, put: &mut dyn FnMut(Message<'_>)) {
        self.flush(put);
        put(Message {
            channel: Channel::Events,
            log_ns: self.utc_ns(at),
            json: &events::json(at, event),
        });
    }

    fn second(&self, second: &Second, put: &mut dyn FnMut(Message<'_>)) {
        put(Message {
            channel: Channel::Link,
            log_ns: self.utc_ns(second.began()),
            json: &second.json(),
        });
    }

    /// Tells the frames so far, and their telemetry.
    pub fn flush(&mut self, put: &mut dyn FnMut(Message<'_>)) {
        let zero_unix_us = self.zero_unix_us;
        let mut put = |channel, at, json: &str| {
            put(Message {
                channel,
                log_ns: utc_ns(zero_unix_us, at),
                json,
            });
        };
        if let Some((at, json)) = self.batch.end() {
            put(Channel::Wire, at, json);
        }
        for (id, at, json) in self.telemetry.drain(..) {
            put(Channel::Telemetry(id), at, &json);
            self.spare.push(json);
        }
        for moved in self.rover.iter_mut().flat_map(Rover::take) {
            let channel = match moved {
                Moved::Odometry(_) => Channel::Odometry,
                Moved::Command(..) => Channel::CommandedMotion,
            };
            let at = moved.at();
            put(channel, at, &moved.json(utc_ns(zero_unix_us, at)));
        }
    }

    /// Tells what is left at the end.
    pub(crate) fn end(&mut self, put: &mut dyn FnMut(Message<'_>)) {
        self.flush(put);
        if let Some(second) = self.meter.end() {
            self.second(&second, put);
        }
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

#[cfg(test)]
mod tests {
    use motorlink_protocol::Layout;

    use super::*;

    fn event(at_ms: u64, kind: LineEventKind) -> LineEvent {
        let at = Instant::from_millis(at_ms);
        LineEvent { at, kind }
    }

    fn exchange(at_ms: u64) -> [LineEvent; 2] {
        let sent = "01 64 00 64 00 00 00 00 00 4F".parse().unwrap();
        let frame = "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap();
        let mode = Some(motorlink_protocol::Mode::Velocity);
        let asked = Some(Layout::Drive);
        [
            event(at_ms, LineEventKind::Sent { frame: sent, mode }),
            event(at_ms + 2, LineEventKind::Received { frame, asked }),
        ]
    }

    #[test]
    fn followed_events_have_no_message_and_what_follows_knows_them() {
        let mut messages = Messages::new(0);
        let [sent, received] = exchange(0);
        assert_eq!(messages.follow(&sent), None);
        assert_eq!(messages.follow(&received), Some(MotorId::FIRST));
        let [_, received] = exchange(10);
        let mut told = Vec::new();
        let mut put = |message: Message<'_>| {
            told.push((message.channel, message.log_ns, message.json.to_owned()));
        };
        assert_eq!(messages.line(&received, &mut put), None);
        messages.flush(&mut put);
        let [wire, telemetry] = &told[..] else {
            panic!("{told:?}")
        };
        assert_eq!(
            (wire.0, wire.2.matches("after_us").count()),
            (Channel::Wire, 1)
        );
        let channel = Channel::Telemetry(MotorId::FIRST);
        assert_eq!((telemetry.0, telemetry.1), (channel, 12_000_000));
        assert!(telemetry.2.contains(r#""setpoint":100"#), "{}", telemetry.2);
    }

    #[test]
    fn what_was_not_told_is_dropped_by_what_is_only_followed() {
        let mut messages = Messages::new(0);
        let [sent, received] = exchange(0);
        let mut put = |message: Message<'_>| panic!("{message:?}");
        messages.line(&sent, &mut put);
        messages.follow(&received);
        messages.flush(&mut put);
    }
}
