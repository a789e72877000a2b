//! A blocking interface to the reader, for programs and tests.

use std::ops::Range;

use super::{Cursor, Next, NotASession, Opening, Problems, Session, Step};
use crate::{overview::Overview, record::Record};

/// A source of a file's bytes.
pub trait Source {
    /// Why reading failed.
    type Error;

    /// The length of the file.
    fn len(&self) -> u64;

    /// Whether the file is empty.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Reads these bytes; fewer if the file ends before.
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
/// The outer error comes from the source, the inner one tells why the file is not a session.
pub fn open<S: Source>(source: &mut S) -> Result<Result<Session, NotASession>, S::Error> {
    let mut opening = Opening::new(source.len());
    while let Step::Read(range) = opening.step() {
        let bytes = source.read(range)?;
        opening.supply(&bytes);
    }
    Ok(opening.finish())
}

/// Passes every record to `each`. Returns the problems of the file.
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

/// The stored overview. If there is none, it is computed from every record; then what could not be read is returned too.
///
/// # Errors
/// Those of the source.
pub fn overview<S: Source>(
    source: &mut S,
    session: &Session,
) -> Result<(Overview, Problems), S::Error> {
    if let Some(range) = session.overview_range() {
        let bytes = source.read(range)?;
        if let Some(overview) = Session::stored_overview(&bytes) {
            return Ok((overview, Problems::default()));
        }
    }
    let mut overview = Overview::default();
    let problems = for_each_record(source, session, |record| overview.add(&record))?;
    Ok((overview, problems))
}
