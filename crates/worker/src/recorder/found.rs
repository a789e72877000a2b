//! Sessions that ended, and whose files are still there.

use std::time::Duration;

use gloo_timers::future::sleep;
use motorlink_messages::recorder::KeptSession;
use motorlink_recorder::kept::{Segment, Summary};

use super::disk::{Dir, OpenFile, Result};

/// The file that a session has open for as long as it lives.
pub(super) const ALIVE: &str = "alive";

/// Bytes of all sessions that ended: with the living one, whose recording takes 80 MB and whose packets
/// 22, a quarter of a gigabyte. The oldest go first.
const BYTES_MAX: usize = 150_000_000;

/// So many of them, however small: each is opened when the page is loaded.
const SESSIONS_MAX: usize = 20;

/// A page that was loaded again may be up before its predecessor has let go of its files: after a reload
/// by tenths of a second, after a crash on a machine that is held up by seconds. So it looks again.
const LOOK_AGAIN_AFTER: Duration = Duration::from_secs(1);

/// How often it looks before what is held must be another living tab's.
const LOOKS: u32 = 6;

/// A session without packets is removed when it is so old; before, it may just have been begun by another
/// tab.
const BEGUN_WITHIN_MS: u64 = 10_000;

/// A session that ended. While this is held, nobody else takes it.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) name: String,
    pub(super) dir: Dir,
    pub(super) alive: OpenFile,
    /// In the order in which they are to be read.
    pub(super) files: Vec<(Segment, usize)>,
    pub(super) summary: Summary,
    pub(super) session: KeptSession,
}

/// The name of a session that begins now: they sort by their age.
pub(super) fn new_name(unix_ms: f64) -> String {
    let random = whole(js_sys::Math::random() * 1e6);
    format!("{:015}-{random:06}", whole(unix_ms))
}

/// Formatting and reading fractions would weigh more than all of this.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float cast saturates"
)]
const fn whole(number: f64) -> u64 {
    number as u64
}

/// The newest session that ended, but for `own`. Removes what is too much.
pub(super) async fn newest(sessions: &Dir, own: &str, now_ms: f64) -> Result<Option<Found>> {
    let mut newest = None;
    for look in 1..=LOOKS {
        let waits = look < LOOKS;
        let mut is_held = false;
        let mut bytes = 0;
        for (place, name) in newest_first(sessions, own).await?.into_iter().enumerate() {
            let dir = sessions.dir(&name).await?;
            let Ok(alive) = dir.open(ALIVE).await else {
                is_held = true;
                continue;
            };
            let files = files_of(&dir).await?;
            bytes += files.iter().map(|(_, size)| size).sum::<usize>();
            // The newest is offered, however large.
            let is_too_much = bytes > BYTES_MAX && newest.is_some();
            if is_too_much || place >= SESSIONS_MAX {
                drop(alive);
                sessions.remove(&name).await?;
            } else if newest.is_none() && !(is_held && waits) {
                let summary = summary(&dir, &files).await;
                if let Some(session) = summary.session() {
                    newest = Some(Found {
                        name,
                        dir,
                        alive,
                        files,
                        summary,
                        session,
                    });
                } else if begun_ms(&name)
                    .is_none_or(|begun| whole(now_ms).saturating_sub(begun) > BEGUN_WITHIN_MS)
                {
                    drop(alive);
                    sessions.remove(&name).await?;
                }
            }
        }
        if newest.is_some() || !(is_held && waits) {
            break;
        }
        sleep(LOOK_AGAIN_AFTER).await;
    }
    Ok(newest)
}

async fn newest_first(sessions: &Dir, own: &str) -> Result<Vec<String>> {
    let mut sorted: Vec<String> = Vec::new();
    for name in sessions.names().await? {
        if name != own {
            insert(&mut sorted, name, |a, b| a > b);
        }
    }
    Ok(sorted)
}

fn begun_ms(name: &str) -> Option<u64> {
    name.split_once('-')?.0.parse().ok()
}

/// The files of a session, those of the packets first.
async fn files_of(dir: &Dir) -> Result<Vec<(Segment, usize)>> {
    let mut files = Vec::new();
    for name in dir.names().await? {
        if let Some(segment) = Segment::from_name(&name) {
            let size = dir.size(&name).await?;
            insert(&mut files, (segment, size), |a, b| a < b);
        }
    }
    Ok(files)
}

/// Puts something where it belongs: a few dozen, for which a sort of the library weighs too much.
fn insert<T>(sorted: &mut Vec<T>, one: T, is_before: fn(&T, &T) -> bool) {
    let place = sorted.iter().position(|other| is_before(&one, other));
    sorted.insert(place.unwrap_or(sorted.len()), one);
}

async fn summary(dir: &Dir, files: &[(Segment, usize)]) -> Summary {
    let mut summary = Summary::default();
    for (segment, _) in files {
        // A file that does not read costs only itself.
        if let Ok(bytes) = dir.read(&segment.name()).await {
            summary.add(segment.stream, bytes);
        }
    }
    summary
}
