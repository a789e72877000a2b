//! Missing and unreadable parts of a file.

use std::{collections::BTreeMap, fmt};

/// One kind of problem. All readable parts are returned nevertheless.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Problem {
    /// The file was written by a later version of the page.
    NewerVersion,
    /// The file has no channel of a session.
    NoSession,
    /// The end is missing: the file was not closed, or truncated.
    Cut,
    /// The index at the end is damaged.
    IndexDamaged,
    /// Bytes that are not a record: everything after them is unknown.
    RecordDamaged,
    /// There are more chunks than can be read.
    TooManyChunks,
    /// A chunk is damaged.
    ChunkDamaged,
    /// A chunk has an unsupported compression, such as zstd.
    CompressionUnknown,
    /// A message could not be read.
    MessageDamaged,
    /// An attachment is damaged.
    AttachmentDamaged,
    /// A line of a CSV file could not be read.
    LineDamaged,
    /// The times of a CSV file have no date, so they begin in 1970.
    NoDate,
}

/// A text with a hint what to do, if something can be done.
impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NewerVersion => {
                "A later version of MotorLink wrote this file. What this version does not know is left out. Update MotorLink to see it."
            }
            Self::NoSession => {
                "This MCAP file has no channel of MotorLink. Open it in Foxglove instead."
            }
            Self::Cut => "The end of the file is missing. Everything before it was read.",
            Self::IndexDamaged => {
                "The index at the end of the file is damaged. The file was read from its start instead."
            }
            Self::RecordDamaged => {
                "The file is damaged in the middle, and its index is missing. What lies behind the damage could not be read."
            }
            Self::TooManyChunks => {
                "The file has more parts than can be read. Only the first ones were read."
            }
            Self::ChunkDamaged => "A part of the file is damaged and was left out.",
            Self::CompressionUnknown => {
                "A part of the file has a compression that MotorLink does not read. Convert the file with: mcap compress --compression lz4"
            }
            Self::MessageDamaged => "A message could not be read and was left out.",
            Self::AttachmentDamaged => "An attached file is damaged and was left out.",
            Self::LineDamaged => "A line of the CSV file could not be read and was left out.",
            Self::NoDate => "The file has times of day without a date. They are shown as of 1 January 1970.",
        })
    }
}

/// All problems and how often each occurred.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Problems(BTreeMap<Problem, u64>);

impl Problems {
    pub(crate) fn add(&mut self, problem: Problem) {
        self.add_all(problem, 1);
    }

    pub(crate) fn add_all(&mut self, problem: Problem, times: u64) {
        if times > 0 {
            *self.0.entry(problem).or_default() += times;
        }
    }

    /// The problems of both.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        let mut all = self.clone();
        for (problem, times) in other.iter() {
            all.add_all(problem, times);
        }
        all
    }

    /// Whether there are no problems.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// How often this problem occurred.
    #[must_use]
    pub fn times(&self, problem: Problem) -> u64 {
        self.0.get(&problem).copied().unwrap_or_default()
    }

    /// Each problem and how often it occurred.
    pub fn iter(&self) -> impl Iterator<Item = (Problem, u64)> {
        self.0.iter().map(|(problem, times)| (*problem, *times))
    }
}

/// One line per problem.
impl fmt::Display for Problems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (problem, times) in self.iter() {
            write!(f, "{problem}")?;
            if times > 1 {
                write!(f, " ({times} times)")?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}
