//! Copies the open session with other bookmarks.

use motorlink_messages::sessions::{Bookmark, FromSessions, SessionExport};
use motorlink_session::{CopyStep, Copying};

use super::{
    open_session::{NotOpened, OpenSession},
    saving::MCAP,
    state::{Reporter, Shared, is_ended, post_file, post_not_opened},
};
use crate::blob_parts::Parts;

/// Writes the copy, and posts it.
pub(super) async fn copy(shared: &Shared, task: u32, open: &OpenSession, bookmarks: &[Bookmark]) {
    let mut parts = Parts::default();
    let copied = write(shared, task, open, bookmarks, &mut parts).await;
    let posted = copied.and_then(|()| {
        let message = FromSessions::Exported {
            what: SessionExport::Copy,
            problems: Vec::new(),
        };
        post_file(&message, &mut parts, MCAP).map_err(|_| NotOpened::NoRoom)
    });
    if let Err(why) = posted {
        post_not_opened(&why);
    }
}

async fn write(
    shared: &Shared,
    task: u32,
    open: &OpenSession,
    bookmarks: &[Bookmark],
    parts: &mut Parts,
) -> Result<(), NotOpened> {
    let mut reporter = Reporter::new(shared, FromSessions::Reading);
    let source = &open.source;
    let mut copying = Copying::new(&open.session, &open.overview, source.len(), bookmarks);
    loop {
        match copying.step() {
            CopyStep::Read(range) => {
                reporter.report(copying.at(), source.len());
                let bytes = source.read(range.clone()).await;
                if is_ended(shared, task) {
                    return Err(NotOpened::Ended);
                }
                copying.supply(&range, &bytes.map_err(|_| NotOpened::Unreadable)?);
            }
            CopyStep::Write(bytes) => parts.push(&bytes).map_err(|_| NotOpened::NoRoom)?,
            CopyStep::Done => return Ok(()),
        }
    }
}
