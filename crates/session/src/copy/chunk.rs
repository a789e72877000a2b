//! The bookmarks in one chunk.

use std::collections::BTreeMap;

use motorlink_protocol::Instant;
use nojson::RawJson;

use super::bookmarks::Pending;
use crate::{
    channels::{Topic, events, integer, schemas},
    mcap::{
        container::{JSON, channel_content, schema_content},
        fields::Fields,
        op,
        open_chunk::OpenChunk,
        put::record,
    },
    record::{Event, EventKind},
};

/// The channel and the schema of events in a file without them.
const OWN_ID: u16 = u16::MAX;

/// The records of the channel `/events`.
#[derive(Debug)]
pub(super) struct Events {
    channel: u16,
    /// The content of its record, and of its schema, where they were seen.
    declared: BTreeMap<(u8, u16), Vec<u8>>,
}

impl Events {
    pub(super) fn of(topics: &BTreeMap<u16, Topic>) -> Self {
        let mut known = topics.iter();
        let channel = known.find(|(_, topic)| **topic == Topic::Events);
        let Some((channel, _)) = channel else {
            let channel = channel_content(OWN_ID, OWN_ID, Topic::EVENTS, JSON);
            let schema = schema_content(OWN_ID, schemas::EVENT);
            return Self {
                channel: OWN_ID,
                declared: [
                    ((op::SCHEMA, OWN_ID), schema),
                    ((op::CHANNEL, OWN_ID), channel),
                ]
                .into(),
            };
        };
        Self {
            channel: *channel,
            declared: BTreeMap::new(),
        }
    }

    /// Takes the record of a schema or a channel.
    pub(super) fn see(&mut self, opcode: u8, content: &[u8]) {
        if let Some(id) = Fields(content).u16() {
            self.declared.insert((opcode, id), content.to_vec());
        }
    }

    /// The records that a message of the channel needs: its schema, then itself.
    fn needed(&self) -> Vec<(u8, u16, Vec<u8>)> {
        let Some(channel) = self.declared.get(&(op::CHANNEL, self.channel)) else {
            return Vec::new();
        };
        let mut fields = Fields(channel);
        let schema = fields.u16().and(fields.u16()).unwrap_or_default();
        let content = self.declared.get(&(op::SCHEMA, schema));
        let schema = content.map(|content| (op::SCHEMA, schema, content.clone()));
        let channel = (op::CHANNEL, self.channel, channel.clone());
        schema.into_iter().chain([channel]).collect()
    }
}

/// The records of a chunk of the copy.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    pub(super) open: OpenChunk,
    /// Opcode, ID and content of its schemas and channels.
    pub(super) declared: Vec<(u8, u16, Vec<u8>)>,
    /// Whether it differs from the one in the file.
    pub(super) is_changed: bool,
}

impl Chunk {
    /// The records of a chunk: without its bookmarks, and with those that are due in it.
    pub(super) fn copy(
        raw: &[u8],
        topics: &mut BTreeMap<u16, Topic>,
        events: &Events,
        pending: &mut Pending,
    ) -> Self {
        let mut chunk = Self::default();
        let mut records = Fields(raw);
        loop {
            let before = records.0;
            let Some((opcode, content)) = records.record() else {
                break;
            };
            let whole = before.get(..before.len() - records.0.len());
            if matches!(opcode, op::SCHEMA | op::CHANNEL)
                && let Some(id) = Fields(content).u16()
            {
                chunk.declared.push((opcode, id, content.to_vec()));
            }
            if opcode == op::CHANNEL {
                Topic::read_channel(topics, content);
            }
            let mut data = Fields(content);
            if opcode == op::MESSAGE
                && let Some((channel, log_ns)) = data.message_head()
            {
                let topic = topics.get(&channel);
                if topic == Some(&Topic::Events) && is_bookmark(data.0) {
                    chunk.is_changed = true;
                    continue;
                }
                if topic.is_some()
                    && let Some(at) = time(data.0)
                {
                    chunk.add_due(events, pending, Some(at));
                    pending.pass(at, log_ns);
                }
                chunk.open.index(channel, log_ns);
            }
            chunk.open.raw.extend(whole.unwrap_or_default());
        }
        // Bytes that are no record stay too.
        chunk.open.raw.extend(records.0);
        chunk
    }

    /// A chunk of the bookmarks behind the last record.
    pub(super) fn of_rest(events: &Events, pending: &mut Pending) -> Self {
        let mut chunk = Self::default();
        chunk.add_due(events, pending, None);
        chunk
    }

    /// Adds the bookmarks before this time, or all.
    fn add_due(&mut self, events: &Events, pending: &mut Pending, before: Option<Instant>) {
        while let Some((at, utc_ns, text)) = pending.next(before) {
            self.is_changed = true;
            for (opcode, id, content) in events.needed() {
                let mut known = self.declared.iter();
                if !known.any(|(other, of, _)| (*other, *of) == (opcode, id)) {
                    record(&mut self.open.raw, opcode, |out| out.extend(&content));
                    self.declared.push((opcode, id, content));
                }
            }
            let json = events::json(at, &Event::new(EventKind::Bookmark, text));
            self.open.message(events.channel, utc_ns, json.as_bytes());
        }
    }
}

fn is_bookmark(data: &[u8]) -> bool {
    events::read(data).is_some_and(|(_, event)| event.kind == EventKind::Bookmark)
}

/// The time of a message on the monotonic clock. Our writer puts it first, so that the rest need not be parsed.
fn time(data: &[u8]) -> Option<Instant> {
    let text = std::str::from_utf8(data).ok()?;
    let first = text.strip_prefix("{\"mono_us\":");
    let digits = first.and_then(|rest| rest.split(',').next());
    let micros = digits.and_then(|digits| digits.parse().ok()).or_else(|| {
        let json = RawJson::parse(text).ok()?;
        integer(json.value(), "mono_us")
    });
    micros.map(Instant::from_micros)
}
