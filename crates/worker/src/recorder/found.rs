//! Finds sessions that have ended and whose files still exist.

use std::time::Duration;

use gloo_timers::future::sleep;
use motorlink_messages::recorder::SavedSession;
use motorlink_recorder::saved::{Segment, Summary};

use super::disk::{Dir, OpenFile, Result};

/// The file that a session keeps open while its tab is open.
pub(super) const ALIVE: &str = "alive";

/// Bytes of all ended sessions. With the current one, whose recording takes 80 MB and whose packets take
/// 22 MB, a quarter of a gigabyte. The oldest are removed first.
const BYTES_MAX: usize = 150_000_000;

/// Number of ended sessions, however small: each is opened when the page is loaded.
const SESSIONS_MAX: usize = 20;

/// A reloaded page may start before the previous one has closed its files: tenths of a second after a
/// reload, seconds after a crash on a slow machine. So the search is repeated.
const SEARCH_PERIOD: Duration = Duration::from_secs(1);

/// Number of searches; a session that is open after the last one belongs to another tab.
const SEARCHES: u32 = 6;

/// A session without packets is removed at this age; a younger one may just have been begun by another
/// tab.
const EMPTY_AGE_MAX_MS: u64 = 10_000;

/// A session that has ended. Its open file keeps other tabs from using it.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) name: String,
    pub(super) dir: Dir,
    pub(super) alive: OpenFile,
    /// In the order in which to read them.
    pub(super) files: Vec<(Segment, usize)>,
    pub(super) summary: Summary,
    pub(super) session: SavedSession,
}

/// The name of a session that begins now. Names sort by age.
pub(super) fn new_name(unix_ms: f64) -> String {
    let random = whole(js_sys::Math::random() * 1e6);
    format!("{:015}-{random:06}", whole(unix_ms))
}

/// As an integer: code that formats fractions would be larger than this whole file.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float cast saturates"
)]
const fn whole(number: f64) -> u64 {
    number as u64
}

/// The newest ended session other than `own`. Removes the sessions beyond the limits.
pub(super) async fn newest(sessions: &Dir, own: &str, now_ms: f64) -> Result<Option<Found>> {
    let mut newest = None;
    for search in 1..=SEARCHES {
        let is_last = search == SEARCHES;
        let mut is_open = false;
        let mut bytes = 0;
        for (place, name) in newest_first(sessions, own).await?.into_iter().enumerate() {
            let dir = sessions.dir(&name).await?;
            let Ok(alive) = dir.open(ALIVE).await else {
                is_open = true;
                continue;
            };
            let files = files_of(&dir).await?;
            bytes += files.iter().map(|(_, size)| size).sum::<usize>();
            // The newest one is offered at any size.
            let exceeds_limit = bytes > BYTES_MAX && newest.is_some();
            if exceeds_limit || place >= SESSIONS_MAX {
                drop(alive);
                sessions.remove(&name).await?;
            } else if newest.is_none() && (is_last || !is_open) {
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
                    .is_none_or(|begun| whole(now_ms).saturating_sub(begun) > EMPTY_AGE_MAX_MS)
                {
                    drop(alive);
                    sessions.remove(&name).await?;
                }
            }
        }
        if newest.is_some() || (is_last || !is_open) {
            break;
        }
        sleep(SEARCH_PERIOD).await;
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

/// The files of a session, the packets first.
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

/// Inserts in order. The library's sort would add too much code for a few dozen items.
fn insert<T>(sorted: &mut Vec<T>, one: T, is_before: fn(&T, &T) -> bool) {
    let place = sorted.iter().position(|other| is_before(&one, other));
    sorted.insert(place.unwrap_or(sorted.len()), one);
}

async fn summary(dir: &Dir, files: &[(Segment, usize)]) -> Summary {
    let mut summary = Summary::default();
    for (segment, _) in files {
        // An unreadable file is skipped.
        if let Ok(bytes) = dir.read(&segment.name()).await {
            summary.add(segment.stream, bytes);
        }
    }
    summary
}
