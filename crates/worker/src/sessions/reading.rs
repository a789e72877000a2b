//! Reads every record of an open session, in steps, and writes other files from them.

use motorlink_messages::sessions::{FromSessions, SessionExport};
use motorlink_recorder::Charset;
use motorlink_session::{About, Cursor, Next, Problems, Record, Session, Table, What, report};

use super::{
    open_session::{NotOpened, OpenSession},
    source::Source,
    state::{Reporter, Shared, is_ended, post, post_file, post_not_opened},
};
use crate::blob_parts::{CSV, Parts};

/// Bytes of a part of a file.
const PART: usize = 1 << 20;

/// Passes every record to `each`. Between two chunks of the file, messages are received.
pub(super) async fn for_each_record(
    shared: &Shared,
    task: u32,
    source: &Source,
    session: &Session,
    mut each: impl FnMut(Record),
) -> Result<Problems, NotOpened> {
    let mut reporter = Reporter::new(shared, FromSessions::Reading);
    let mut cursor = Cursor::new(session);
    loop {
        match cursor.next(session) {
            Next::Record(record) => each(record),
            Next::Read(range) => {
                reporter.report(range.start, source.len());
                let bytes = source.read(range).await;
                if is_ended(shared, task) {
                    return Err(NotOpened::Ended);
                }
                cursor.supply(&bytes.map_err(|_| NotOpened::Unreadable)?);
            }
            Next::End => return Ok(cursor.problems().clone()),
        }
    }
}

/// Writes a file, and posts it.
pub(super) async fn export(shared: &Shared, task: u32, open: &OpenSession, what: SessionExport) {
    let mut parts = Parts::default();
    let (written, media_type) = match what {
        SessionExport::Report => {
            let about = About {
                name: &open.name,
                problems: &open.problems,
            };
            let pushed = parts.push(report(&open.overview, about).as_bytes());
            let written = pushed.map_err(|_| NotOpened::NoRoom);
            (
                written.map(|()| Problems::default()),
                "text/html;charset=utf-8",
            )
        }
        // It comes with its bookmarks, in a message of its own.
        SessionExport::Copy => return post(&FromSessions::Cancelled),
        SessionExport::Log => (log(shared, task, open, &mut parts).await, CSV),
        SessionExport::Plot => {
            let table = Table::of_plot(&open.overview);
            (rows(shared, task, open, table, &mut parts).await, CSV)
        }
    };
    let posted = written.and_then(|problems| {
        let problems = problems.iter().collect();
        let message = FromSessions::Exported { what, problems };
        post_file(&message, &mut parts, media_type).map_err(|_| NotOpened::NoRoom)
    });
    if let Err(why) = posted {
        post_not_opened(&why);
    }
}

/// The packet log. Its first bytes depend on the texts of all events.
async fn log(
    shared: &Shared,
    task: u32,
    open: &OpenSession,
    parts: &mut Parts,
) -> Result<Problems, NotOpened> {
    let mut charset = Charset::default();
    let read = for_each_record(shared, task, &open.source, &open.session, |record| {
        if let What::Event(event) = &record.what {
            charset.add(&event.text);
        }
    });
    read.await?;
    rows(shared, task, open, Table::of_log(charset), parts).await
}

async fn rows(
    shared: &Shared,
    task: u32,
    open: &OpenSession,
    mut table: Table,
    parts: &mut Parts,
) -> Result<Problems, NotOpened> {
    let mut lines = Vec::new();
    table.head(&mut lines);
    let mut pushed = Ok(());
    let read = for_each_record(shared, task, &open.source, &open.session, |record| {
        table.record(&mut lines, &record);
        if lines.len() >= PART {
            pushed = std::mem::replace(&mut pushed, Ok(())).and_then(|()| parts.push(&lines));
            lines.clear();
        }
    });
    let problems = read.await?;
    let pushed = pushed.and_then(|()| parts.push(&lines));
    pushed.map(|()| problems).map_err(|_| NotOpened::NoRoom)
}
