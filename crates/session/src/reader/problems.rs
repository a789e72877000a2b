//! Missing and unreadable parts of a file.

use std::{collections::BTreeMap, fmt};

use motorlink_messages::sessions::Problem;

/// All problems and how often each occurred.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Problems(BTreeMap<Problem, u64>);

impl Problems {
    /// Adds a problem.
    pub fn add(&mut self, problem: Problem) {
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
