//! Opens a session file, or a CSV file that becomes one.

use motorlink_messages::sessions::{FromSessions, Progress};
use motorlink_session::{Import, NotASession, Opening, Overview, Problems, Session, Step};
use web_sys::{Blob, File};

use super::{
    info::info,
    open_session::{NotOpened, OpenSession},
    reading::for_each_record,
    source::Source,
    state::{Reporter, Shared, is_ended, post, post_not_opened},
};
use crate::blob_parts::Parts;

/// Bytes of a CSV file that are read at once.
const CSV_PIECE: u64 = 1 << 20;

/// Opens a file, and posts what is in it. Until then, and if it is not a session, the one before stays open.
pub(super) async fn open(shared: &Shared, task: u32, name: String, file: File) {
    let opened = try_open(shared, task, name, file).await;
    if is_ended(shared, task) {
        return;
    }
    match opened {
        Ok(open) => {
            let about = info(&open).await;
            {
                let worker = &mut *shared.borrow_mut();
                (worker.open, worker.replay) = (Some(open.into()), None);
            }
            post(&FromSessions::Opened(Box::new(about)));
        }
        Err(why) => post_not_opened(&why),
    }
}

async fn try_open(
    shared: &Shared,
    task: u32,
    name: String,
    file: File,
) -> Result<OpenSession, NotOpened> {
    post(&FromSessions::Reading(Progress::default()));
    let file: Blob = file.into();
    let mut source = Source::new(file);
    let mut problems = Problems::default();
    let session = match index(shared, task, &source).await {
        Err(NotOpened::NotASession(NotASession::Text)) => {
            (source, problems) = import(shared, task, &source).await?;
            index(shared, task, &source).await?
        }
        session => session?,
    };
    let mut overview = None;
    if let Some(range) = session.overview_range() {
        let bytes = source.read(range).await;
        let bytes = bytes.map_err(|_| NotOpened::Unreadable)?;
        overview = Session::stored_overview(&bytes);
    }
    problems = problems.and(session.problems());
    let overview = if let Some(overview) = overview {
        overview
    } else {
        let mut overview = Overview::default();
        let read = for_each_record(shared, task, &source, &session, |record| {
            overview.add(&record);
        });
        problems = problems.and(&read.await?);
        overview
    };
    Ok(OpenSession {
        name,
        session,
        source,
        overview,
        problems,
    })
}

/// Reads the index of a session file. Without one it finds every record, which takes longer.
async fn index(shared: &Shared, task: u32, source: &Source) -> Result<Session, NotOpened> {
    let mut reporter = Reporter::new(shared, FromSessions::Reading);
    let mut opening = Opening::new(source.len());
    while let Step::Read(range) = opening.step() {
        let bytes = source.read(range).await;
        if is_ended(shared, task) {
            return Err(NotOpened::Ended);
        }
        if let Some(scanned) = opening.scanned() {
            reporter.report(scanned, source.len());
        }
        opening.supply(&bytes.map_err(|_| NotOpened::Unreadable)?);
    }
    opening.finish().map_err(NotOpened::NotASession)
}

/// Converts a CSV file to a session, in memory of the browser.
async fn import(shared: &Shared, task: u32, csv: &Source) -> Result<(Source, Problems), NotOpened> {
    let mut reporter = Reporter::new(shared, FromSessions::Reading);
    let mut import = Import::default();
    let mut parts = Parts::default();
    let mut at = 0;
    while at < csv.len() && !import.is_unknown() {
        let end = csv.len().min(at + CSV_PIECE);
        let bytes = csv.read(at..end).await;
        import.feed(&bytes.map_err(|_| NotOpened::Unreadable)?);
        let piece = import.take();
        parts.push(&piece).map_err(|_| NotOpened::NoRoom)?;
        at = end;
        reporter.report(at, csv.len());
        if is_ended(shared, task) {
            return Err(NotOpened::Ended);
        }
    }
    let (rest, problems) = import.finish().map_err(NotOpened::NotASession)?;
    parts.push(&rest).map_err(|_| NotOpened::NoRoom)?;
    let session = parts.take_file("").map_err(|_| NotOpened::NoRoom)?;
    Ok((Source::new(session), problems))
}
