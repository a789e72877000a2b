//! Reads records from any time on.

use std::{
    collections::{BTreeMap, VecDeque},
    ops::Range,
};

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_protocol::family::Model;

use super::{Problem, Problems, Session};
use crate::{
    channels::{Topic, events, state::Replies, wire},
    clock::{utc_ns, zero_unix_us},
    mcap::{
        CRC,
        compression::{self, LZ4},
        fields::Fields,
        op,
        summary::ChunkHead,
    },
    record::{Record, What},
};

/// Maximal bytes per message. The messages of the writer have 40 kB.
const MESSAGE_BYTES_MAX: usize = 1 << 20;

/// Reads records in the order of the file.
#[derive(Debug)]
pub struct Cursor {
    next_chunk: usize,
    /// Whether the requested bytes are messages outside of chunks.
    is_loose: bool,
    chunk: Vec<u8>,
    /// Number of bytes of the chunk that were read.
    read: usize,
    records: VecDeque<Record>,
    /// Records before this time are skipped, up to the first one at or after it.
    from_ns: Option<u64>,
    topics: BTreeMap<u16, Topic>,
    /// The model of the motors in the last message.
    model: Model,
    /// The replies of the next state.
    replies: Replies,
    problems: Problems,
}

/// The next result of a cursor.
#[derive(Clone, Debug, PartialEq)]
pub enum Next {
    /// A record.
    Record(Record),
    /// It needs these bytes: see [`Cursor::supply`].
    Read(Range<u64>),
    /// There are no more records.
    End,
}

impl Cursor {
    /// A cursor at the first record.
    #[must_use]
    pub fn new(session: &Session) -> Self {
        Self {
            next_chunk: 0,
            is_loose: false,
            chunk: Vec::new(),
            read: 0,
            records: VecDeque::new(),
            from_ns: None,
            topics: session.topics.clone(),
            model: Model::default(),
            replies: Replies::default(),
            problems: Problems::default(),
        }
    }

    /// A cursor at this time, in nanoseconds since 1970, UTC.
    #[must_use]
    pub fn at(session: &Session, utc_ns: u64) -> Self {
        let before = session
            .chunks
            .iter()
            .take_while(|chunk| chunk.to_ns < utc_ns);
        Self {
            next_chunk: before.count(),
            from_ns: Some(utc_ns),
            ..Self::new(session)
        }
    }

    /// The problems found so far.
    #[must_use]
    pub const fn problems(&self) -> &Problems {
        &self.problems
    }

    /// Returns the next record, or the bytes that are needed for it.
    pub fn next(&mut self, session: &Session) -> Next {
        loop {
            while let Some(record) = self.records.pop_front() {
                // The model is needed for every record behind it.
                if let What::Line(LineEventKind::ModelSelected(_)) = record.what {
                    return Next::Record(record);
                }
                if self.from_ns.is_none_or(|from| record.utc_ns >= from) {
                    self.from_ns = None;
                    return Next::Record(record);
                }
            }
            if !self.read_message() {
                let Some(chunk) = session.chunks.get(self.next_chunk) else {
                    // A summary need not repeat the channels, so only here it is known that none is ours.
                    if self.topics.is_empty() && !session.is_known() && self.problems.is_empty() {
                        self.problems.add(Problem::NoSession);
                    }
                    return Next::End;
                };
                self.is_loose = chunk.is_loose;
                return Next::Read(chunk.offset..chunk.offset + chunk.length);
            }
        }
    }

    /// Takes the requested bytes.
    pub fn supply(&mut self, bytes: &[u8]) {
        self.next_chunk += 1;
        self.read = 0;
        self.chunk.clear();
        if self.is_loose {
            self.chunk.extend(bytes);
            return;
        }
        match decompressed(bytes) {
            Ok(chunk) => self.chunk = chunk,
            Err(problem) => self.problems.add(problem),
        }
    }

    /// Reads the next message of the chunk. Returns whether there was one.
    fn read_message(&mut self) -> bool {
        let rest = self.chunk.get(self.read..).unwrap_or_default();
        let mut fields = Fields(rest);
        let Some((opcode, content)) = fields.record() else {
            if !rest.is_empty() {
                self.problems.add(Problem::ChunkDamaged);
            }
            // Frees the memory: the chunk is not needed any more.
            self.chunk = Vec::new();
            self.read = 0;
            return false;
        };
        self.read = self.chunk.len() - fields.0.len();
        if opcode == op::CHANNEL {
            Topic::read_channel(&mut self.topics, content);
        } else if opcode == op::MESSAGE {
            let mut fields = Fields(content);
            let content = fields.message_head().and_then(|(channel, log_ns)| {
                let topic = self.topics.get(&channel).copied();
                read(&mut self.replies, topic, log_ns, fields.0)
            });
            self.take(content);
        }
        true
    }

    fn take(&mut self, content: Option<Content>) {
        let Some(Content {
            model,
            records,
            is_complete,
        }) = content
        else {
            return self.problems.add(Problem::MessageDamaged);
        };
        if let (Some(model), Some(first)) = (model, records.first())
            && model != self.model
        {
            self.model = model;
            self.records.push_back(Record {
                what: What::Line(LineEventKind::ModelSelected(model)),
                ..first.clone()
            });
        }
        self.records.extend(records);
        self.problems
            .add_all(Problem::MessageDamaged, u64::from(!is_complete));
    }
}

/// The content of a message.
#[derive(Default)]
struct Content {
    /// The model of the motors, if it has frames.
    model: Option<Model>,
    records: Vec<Record>,
    /// Whether all records could be parsed.
    is_complete: bool,
}

/// Parses a message; `None` if it is damaged.
fn read(replies: &mut Replies, topic: Option<Topic>, log_ns: u64, data: &[u8]) -> Option<Content> {
    let mut content = Content {
        is_complete: true,
        ..Content::default()
    };
    let Some(topic) = topic else {
        return Some(content);
    };
    if data.len() > MESSAGE_BYTES_MAX {
        return None;
    }
    match topic {
        Topic::Wire => {
            let wire = wire::read(data)?;
            let first = wire.events.first().map(|event| event.at);
            let zero_us = zero_unix_us(first.unwrap_or_default(), log_ns);
            replies.set_model(wire.model);
            for event in &wire.events {
                replies.add_event(event);
            }
            let records = wire
                .events
                .into_iter()
                .map(|LineEvent { at, kind }| Record {
                    at,
                    utc_ns: utc_ns(zero_us, at),
                    what: What::Line(kind),
                });
            content.records = records.collect();
            content.is_complete = wire.is_complete;
            content.model = Some(wire.model);
        }
        Topic::Events => {
            let (at, event) = events::read(data)?;
            content.records.push(Record {
                at,
                utc_ns: log_ns,
                what: What::Event(event),
            });
        }
        Topic::State => {
            let (at, state) = replies.read(data)?;
            // One of another version is no damage: what the frames tell is shown.
            content.records.extend(state.map(|state| Record {
                at,
                utc_ns: log_ns,
                what: What::State(state.into()),
            }));
        }
    }
    Some(content)
}

/// The records in the record of a chunk.
pub(crate) fn decompressed(record: &[u8]) -> Result<Vec<u8>, Problem> {
    let Some((op::CHUNK, content)) = Fields(record).record() else {
        return Err(Problem::ChunkDamaged);
    };
    let mut fields = Fields(content);
    let head = ChunkHead::read(&mut fields).ok_or(Problem::ChunkDamaged)?;
    let bytes = fields
        .take(head.compressed_size)
        .ok_or(Problem::ChunkDamaged)?;
    let raw = match head.compression {
        "" => (bytes.len() as u64 == head.size).then(|| bytes.to_vec()),
        LZ4 => compression::decompress(bytes, head.size),
        _ => return Err(Problem::CompressionUnknown),
    };
    // Zero means that the writer computed none.
    raw.filter(|raw| head.crc == 0 || head.crc == CRC.checksum(raw))
        .ok_or(Problem::ChunkDamaged)
}
