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
        put::{self, record},
        whole_chunk::{MessageIndexes, WholeChunk},
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
    raw: Vec<u8>,
    times: Option<(u64, u64)>,
    pub(super) indexes: MessageIndexes,
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
            let mut fields = Fields(content);
            if matches!(opcode, op::SCHEMA | op::CHANNEL)
                && let Some(id) = fields.u16()
            {
                chunk.declared.push((opcode, id, content.to_vec()));
                let topic = fields.u16().and_then(|_schema| fields.text());
                let topic = topic.and_then(Topic::from_name);
                if let Some(topic) = topic.filter(|_| opcode == op::CHANNEL) {
                    topics.insert(id, topic);
                }
            }
            if opcode == op::MESSAGE
                && let Some((channel, log_ns, data)) = message(content)
            {
                let topic = topics.get(&channel);
                if topic == Some(&Topic::Events) && is_bookmark(data) {
                    chunk.is_changed = true;
                    continue;
                }
                if topic.is_some()
                    && let Some(at) = time(data)
                {
                    chunk.add_due(events, pending, Some(at));
                    pending.pass(at, log_ns);
                }
                chunk.index(channel, log_ns);
            }
            chunk.raw.extend(whole.unwrap_or_default());
        }
        // Bytes that are no record stay too.
        chunk.raw.extend(records.0);
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
                    record(&mut self.raw, opcode, |out| out.extend(&content));
                    self.declared.push((opcode, id, content));
                }
            }
            self.index(events.channel, utc_ns);
            let json = events::json(at, &Event::new(EventKind::Bookmark, text));
            record(&mut self.raw, op::MESSAGE, |out| {
                put::u16(out, events.channel);
                // The writer of the bookmark does not count the messages of the channel.
                put::u32(out, 0);
                put::u64(out, utc_ns);
                put::u64(out, utc_ns);
                out.extend(json.as_bytes());
            });
        }
    }

    /// A message of this channel follows.
    fn index(&mut self, channel: u16, log_ns: u64) {
        let (from, to) = self.times.unwrap_or((log_ns, log_ns));
        self.times = Some((from.min(log_ns), to.max(log_ns)));
        let index = self.indexes.entry(channel).or_default();
        index.push((log_ns, self.raw.len() as u64));
    }

    /// The chunk to write; `None` without a message.
    pub(super) fn whole(&self) -> Option<WholeChunk<'_>> {
        Some(WholeChunk {
            raw: &self.raw,
            times: self.times?,
            indexes: &self.indexes,
        })
    }
}

/// Channel, time and data of a message.
fn message(content: &[u8]) -> Option<(u16, u64, &[u8])> {
    let mut fields = Fields(content);
    let channel = fields.u16()?;
    fields.u32()?;
    let log_ns = fields.u64()?;
    fields.u64()?;
    Some((channel, log_ns, fields.0))
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
