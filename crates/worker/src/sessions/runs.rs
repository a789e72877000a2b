//! The runs of experiments: from the browser's database into a file that is saved, and from an open file into it.

use motorlink_kept_runs::{Database, Placing, RUNS_MAX};
use motorlink_messages::{
    encode,
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

/// Passes every kept run of this session to `write`, the oldest first.
pub(super) async fn attach(
    events: &RunEvents,
    mut write: impl AsyncFnMut(&RunHeader, &Record) -> Result<(), NotSaved>,
) -> Result<RunsSaved, NotSaved> {
    let mut outcome = RunsSaved::default();
    if events.is_empty() {
        return Ok(outcome);
    }
    let Ok((database, mut runs)) = database().await else {
        outcome.is_incomplete = true;
        return Ok(outcome);
    };
    runs.retain(|run| events.have(run));
    runs.sort_by_key(|run| run.number);
    for header in runs {
        let Ok((record, is_whole)) = database.record(&header).await else {
            outcome.is_incomplete = true;
            continue;
        };
        outcome.is_incomplete |= !is_whole;
        write(&header, &record).await?;
        outcome.saved += 1;
    }
    Ok(outcome)
}

/// The database, and the headers that this version can read.
async fn database() -> Result<(Database, Vec<RunHeader>), wasm_bindgen::JsValue> {
    let database = Database::open(|| {}).await?;
    let headers = database.headers().await?;
    Ok((database, headers.read))
}

/// Adds the runs of an open session to those that the browser keeps, and posts what became of them.
pub(super) async fn keep(shared: &Shared, task: u32, open: &OpenSession) {
    match try_keep(shared, task, open).await {
        Ok(_) if is_ended(shared, task) => {}
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
    let Ok((database, mut kept)) = database().await else {
        return Ok(None);
    };
    let Ok(mut numbers) = database.numbers().await else {
        return Ok(None);
    };
    let mut outcome = RunsKept::default();
    let names: Vec<String> = open
        .session
        .runs()
        .map(|run| run.attachment.name)
        .take(RUNS_MAX)
        .collect();
    for (place, name) in names.iter().enumerate() {
        reporter.report(place as u64, names.len() as u64);
        // What is too large cannot be read.
        let Some(range) = open.session.attachment_range(name) else {
            outcome.unreadable += 1;
            continue;
        };
        let bytes = open.source.read(range).await;
        if is_ended(shared, task) {
            return Err(NotOpened::Ended);
        }
        let bytes = bytes.map_err(|_| NotOpened::Unreadable)?;
        let Ok((mut header, record)) = Session::read_run(&bytes) else {
            outcome.unreadable += 1;
            continue;
        };
        let Ok(part) = encode(&RecordPart {
            samples: record.samples().to_vec(),
            sent: record.sent_setpoints().to_vec(),
            marks: record.marks().to_vec(),
        }) else {
            outcome.not_stored += 1;
            continue;
        };
        header.bytes = u32::try_from(part.len()).unwrap_or(u32::MAX);
        header.number = match Placing::of(&header, header.bytes, &kept, &numbers, now_s()) {
            Placing::Known => {
                outcome.known += 1;
                continue;
            }
            Placing::NoRoom => {
                outcome.no_room += 1;
                continue;
            }
            Placing::Add(number) | Placing::Replace(number) => number,
        };
        if database.put_run(&header, &part).await.is_err() {
            outcome.not_stored += 1;
            continue;
        }
        outcome.added += 1;
        kept.retain(|other| other.number != header.number);
        if !numbers.contains(&header.number) {
            numbers.push(header.number);
        }
        kept.push(header);
    }
    Ok(Some(outcome))
}

/// Seconds since 1970.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "seconds since 1970 fit until 2106"
)]
fn now_s() -> u32 {
    (js_sys::Date::now() / 1_000.0) as u32
}
