//! The same for callers that can read at once: programs, tests.

use std::ops::Range;

use super::{Cursor, Next, NotASession, Opening, Problems, Session, Step};
use crate::{overview::Overview, record::Record};

/// Something that gives bytes of a file.
pub trait Source {
    /// Why it cannot.
    type Error;

    /// The length of the file.
    fn len(&self) -> u64;

    /// Whether the file is empty.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// These bytes; fewer where the file ends before.
    ///
    /// # Errors
    /// The file cannot be read.
    fn read(&mut self, range: Range<u64>) -> Result<Vec<u8>, Self::Error>;
}

/// Bytes in memory.
impl Source for &[u8] {
    type Error = std::convert::Infallible;

    fn len(&self) -> u64 {
        (**self).len() as u64
    }

    fn read(&mut self, range: Range<u64>) -> Result<Vec<u8>, Self::Error> {
        let at = |place: u64| usize::try_from(place.min(Source::len(self))).unwrap_or_default();
        let bytes = self.get(at(range.start)..at(range.end));
        Ok(bytes.unwrap_or_default().to_vec())
    }
}

/// Opens a session.
///
/// # Errors
/// The outer error is that of the source, the inner one says why the file is no session.
pub fn open<S: Source>(source: &mut S) -> Result<Result<Session, NotASession>, S::Error> {
    let mut opening = Opening::new(source.len());
    while let Step::Read(range) = opening.step() {
        let bytes = source.read(range)?;
        opening.supply(&bytes);
    }
    Ok(opening.finish())
}

/// Gives every record. Says what was missing.
///
/// # Errors
/// Those of the source.
pub fn for_each_record<S: Source>(
    source: &mut S,
    session: &Session,
    mut each: impl FnMut(Record),
) -> Result<Problems, S::Error> {
    let mut cursor = Cursor::new(session);
    loop {
        match cursor.next(session) {
            Next::Record(record) => each(record),
            Next::Read(range) => cursor.supply(&source.read(range)?),
            Next::End => return Ok(cursor.problems().clone()),
        }
    }
}

/// The overview: the stored one, or one of every record where there is none.
///
/// # Errors
/// Those of the source.
pub fn overview<S: Source>(source: &mut S, session: &Session) -> Result<Overview, S::Error> {
    if let Some(range) = session.overview_range() {
        let bytes = source.read(range)?;
        if let Some(overview) = Session::stored_overview(&bytes) {
            return Ok(overview);
        }
    }
    let mut overview = Overview::default();
    for_each_record(source, session, |record| overview.add(&record))?;
    Ok(overview)
}
