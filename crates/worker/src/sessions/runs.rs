//! The runs of experiments: from the browser's database into a file that is saved, and from an open file into it.

use motorlink_kept_runs::{BYTES_MAX, Database, RUNS_MAX};
use motorlink_messages::{
    experiments::{
        kept::RunHeader,
        runner::{Record, RecordPart},
    },
    sessions::{FromSessions, NotSaved, RunsKept, RunsSaved},
};
use motorlink_session::{RunEvents, Session};

use super::{
    open_session::{NotOpened, OpenSession},
    state::{Reporter, Shared, is_ended, post, post_not_opened},
};

/// Passes every kept run of this session to `write`, the oldest first. Returns how many there were.
pub(super) async fn attach(
    events: &RunEvents,
    mut write: impl AsyncFnMut(&RunHeader, &Record) -> Result<(), NotSaved>,
) -> Result<RunsSaved, NotSaved> {
    if events.is_empty() {
        return Ok(RunsSaved::All(0));
    }
    let Ok(database) = Database::open(|| {}).await else {
        return Ok(RunsSaved::NotRead);
    };
    let Ok(headers) = database.headers().await else {
        return Ok(RunsSaved::NotRead);
    };
    let mut runs = headers.read;
    runs.retain(|run| events.have(run));
    runs.sort_by_key(|run| run.number);
    let mut number = 0;
    for header in runs {
        let Ok(parts) = database.parts(header.number).await else {
            return Ok(RunsSaved::NotRead);
        };
        let mut record = header.record();
        for part in parts {
            record.add_part(part);
        }
        write(&header, &record).await?;
        number += 1;
    }
    Ok(RunsSaved::All(number))
}

/// Adds the runs of an open session to those that the browser keeps, and posts what became of them.
pub(super) async fn keep(shared: &Shared, task: u32, open: &OpenSession) {
    match try_keep(shared, task, open).await {
        Ok(kept) => post(&FromSessions::RunsKept(kept)),
        Err(why) => post_not_opened(&why),
    }
}

async fn try_keep(
    shared: &Shared,
    task: u32,
    open: &OpenSession,
) -> Result<Option<RunsKept>, NotOpened> {
    let mut reporter = Reporter::new(shared, FromSessions::Reading);
    let Ok(database) = Database::open(|| {}).await else {
        return Ok(None);
    };
    let Ok(headers) = database.headers().await else {
        return Ok(None);
    };
    let mut all = headers.read;
    let mut kept = RunsKept::default();
    let names: Vec<String> = open.session.runs().map(|run| run.attachment.name).collect();
    for (place, name) in names.iter().enumerate() {
        reporter.report(place as u64, names.len() as u64);
        // A file that is too large cannot be read.
        let Some(range) = open.session.attachment_range(name) else {
            kept.unreadable += 1;
            continue;
        };
        let bytes = open.source.read(range).await;
        if is_ended(shared, task) {
            return Err(NotOpened::Ended);
        }
        let bytes = bytes.map_err(|_| NotOpened::Unreadable)?;
        let Ok((mut header, record)) = Session::run(&bytes) else {
            kept.unreadable += 1;
            continue;
        };
        // Its name may be another one by now.
        let is_same = |other: &RunHeader| {
            (other.began_unix_ms - header.began_unix_ms).abs() < 1.0 && other.study == header.study
        };
        if all.iter().any(is_same) {
            kept.known += 1;
            continue;
        }
        // Two browsers may have given out the same number.
        while all.iter().any(|other| other.number == header.number) {
            header.number += 1;
        }
        if store(&database, &mut header, record, &all).await {
            kept.added += 1;
            all.push(header);
        } else {
            kept.no_room += 1;
        }
    }
    Ok(Some(kept))
}

/// Stores a run beside all others, if there is room for it. Returns whether it is stored.
async fn store(
    database: &Database,
    header: &mut RunHeader,
    record: Record,
    all: &[RunHeader],
) -> bool {
    if all.len() >= RUNS_MAX {
        return false;
    }
    let part = RecordPart {
        samples: record.samples().to_vec(),
        sent: record.sent_setpoints().to_vec(),
        marks: record.marks().to_vec(),
    };
    let number = header.number;
    let Ok(bytes) = database.add_part(number, 0, &part).await else {
        return false;
    };
    header.bytes = bytes;
    let stored: u64 = all.iter().map(|run| u64::from(run.bytes)).sum();
    let fits = stored + u64::from(bytes) <= BYTES_MAX;
    if fits && database.put_header(header).await.is_ok() {
        return true;
    }
    // Without a header nothing reads the part. The next run with this number replaces it.
    let _ = database.delete(number).await;
    false
}
