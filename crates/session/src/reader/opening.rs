//! Opens a file as a [`Session`]: requests parts of the file until the index is complete.

use std::ops::Range;

use motorlink_messages::sessions::NotASession;

use super::{
    Problem, Session,
    scan::Scan,
    summary::{Footer, read_summary},
};
use crate::{
    format,
    mcap::{MAGIC, TAIL_LEN},
};

/// Maximal bytes of the summary. The summary of an hour has 100 kB.
const SUMMARY_BYTES_MAX: u64 = 32 << 20;

/// Maximal bytes of a metadata record.
const METADATA_BYTES_MAX: u64 = 1 << 20;

/// Bytes that identify the kind of a file.
const HEAD_LEN: u64 = 64;

/// Opens a file part by part, so that the caller may wait for each of them.
#[derive(Debug)]
pub struct Opening {
    len: u64,
    stage: Stage,
    session: Session,
}

#[derive(Debug)]
enum Stage {
    Head,
    Tail,
    Summary(Range<u64>),
    /// The metadata record with the version.
    Metadata(Range<u64>),
    Scan(Scan),
    Done(Result<(), NotASession>),
}

/// The next request of an opening.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// These bytes of the file: see [`Opening::supply`].
    Read(Range<u64>),
    /// Nothing: see [`Opening::finish`].
    Done,
}

impl Opening {
    /// Starts to open a file of `len` bytes.
    #[must_use]
    pub fn new(len: u64) -> Self {
        let stage = if len == 0 {
            Stage::Done(Err(NotASession::Empty))
        } else {
            Stage::Head
        };
        Self {
            len,
            stage,
            session: Session::default(),
        }
    }

    /// The next request.
    #[must_use]
    pub fn step(&self) -> Step {
        match &self.stage {
            Stage::Head => Step::Read(0..HEAD_LEN.min(self.len)),
            Stage::Tail => Step::Read(self.len.saturating_sub(TAIL_LEN)..self.len),
            Stage::Summary(range) | Stage::Metadata(range) => Step::Read(range.clone()),
            Stage::Scan(scan) => Step::Read(scan.range(self.len)),
            Stage::Done(_) => Step::Done,
        }
    }

    /// Bytes in which records were searched; `None` while an index is read.
    #[must_use]
    pub const fn scanned(&self) -> Option<u64> {
        match &self.stage {
            Stage::Scan(scan) => Some(scan.at()),
            _ => None,
        }
    }

    /// Takes the requested bytes. Fewer bytes mean that the file is shorter than `len`.
    pub fn supply(&mut self, bytes: &[u8]) {
        let stage = std::mem::replace(&mut self.stage, Stage::Done(Ok(())));
        self.stage = match stage {
            Stage::Head => match sort(bytes) {
                Ok(()) => Stage::Tail,
                Err(other) => Stage::Done(Err(other)),
            },
            Stage::Tail => self.tail(bytes),
            Stage::Summary(range) => self.summary(&range, bytes),
            Stage::Metadata(_) => {
                self.session.read_metadata(bytes);
                Stage::Done(Ok(()))
            }
            Stage::Scan(mut scan) => {
                if scan.supply(self.len, bytes, &mut self.session) {
                    self.session.record_problems(scan.is_whole);
                    Stage::Done(Ok(()))
                } else {
                    Stage::Scan(scan)
                }
            }
            done @ Stage::Done(_) => done,
        };
    }

    fn tail(&mut self, bytes: &[u8]) -> Stage {
        let summary = Footer::read(bytes).map(|footer| footer.summary_start);
        let end = self.len.saturating_sub(MAGIC.len() as u64);
        match summary {
            Some(start) if start > 0 && start < end && end - start <= SUMMARY_BYTES_MAX => {
                Stage::Summary(start..end)
            }
            // A file need not have a summary.
            Some(0) => self.scan(None),
            Some(_) => self.scan(Some(Problem::IndexDamaged)),
            None => self.scan(Some(Problem::Cut)),
        }
    }

    fn scan(&mut self, because: Option<Problem>) -> Stage {
        self.session = Session::default();
        if let Some(problem) = because {
            self.session.problems.add(problem);
        }
        Stage::Scan(Scan::default())
    }

    fn summary(&mut self, range: &Range<u64>, bytes: &[u8]) -> Stage {
        let Some(metadata) = read_summary(bytes, range.start, &mut self.session) else {
            return self.scan(Some(Problem::IndexDamaged));
        };
        // Nor need it have chunks, or an index of them.
        let may_be_ours = !self.session.topics.is_empty() || !self.session.has_channels;
        if self.session.chunks.is_empty() && may_be_ours {
            return self.scan(None);
        }
        let metadata = metadata
            .iter()
            .rfind(|index| index.name == format::METADATA);
        let range = metadata.and_then(|index| {
            let end = index.offset.checked_add(index.length)?;
            let fits = index.length <= METADATA_BYTES_MAX && end <= self.len;
            fits.then_some(index.offset..end)
        });
        range.map_or(Stage::Done(Ok(())), Stage::Metadata)
    }

    /// The session, after [`Step::Done`].
    ///
    /// # Errors
    /// The file is not a session, or not all of it was supplied.
    pub fn finish(self) -> Result<Session, NotASession> {
        let Self { stage, session, .. } = self;
        match stage {
            Stage::Done(result) => result?,
            _ => return Err(NotASession::Other),
        }
        let mut session = session;
        if session.topics.is_empty() && session.about.is_empty() && session.is_known() {
            session.problems.add(Problem::NoSession);
        }
        Ok(session)
    }
}

/// Checks whether a file begins like a session.
fn sort(head: &[u8]) -> Result<(), NotASession> {
    if head.starts_with(&MAGIC) {
        return Ok(());
    }
    let (name, behind) = MAGIC.split_at(5);
    let is_utf_16 = matches!(head, [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..]);
    let is_text = is_utf_16
        || !head
            .iter()
            .any(|byte| *byte < b' ' && !byte.is_ascii_whitespace());
    Err(match head {
        [] => NotASession::Empty,
        [b'P', b'K', 3 | 5 | 7, 4 | 6 | 8, ..] => NotASession::Zip,
        _ if head.starts_with(name) && head.get(6..8) == behind.get(1..) => {
            NotASession::NewerContainer
        }
        _ if is_text => NotASession::Text,
        _ => NotASession::Other,
    })
}
