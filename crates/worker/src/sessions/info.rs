//! What the page shows of an open session.

use std::time::Duration;

use motorlink_kept_runs::RUNS_MAX;
use motorlink_messages::sessions::{SessionInfo, SessionMark, SessionMotor};
use motorlink_protocol::MotorId;
use motorlink_session::{EventKind, Mark, MotorOverview, Session};

use super::{open_session::OpenSession, saving::SETUP};

/// The content of an open session.
pub(super) async fn info(open: &OpenSession) -> SessionInfo {
    let overview = &open.overview;
    let mut runs = open.session.runs().map(|run| run.name);
    let from_ns = overview.span_ns().map(|(from, _)| from);
    SessionInfo {
        name: open.name.clone(),
        bytes: open.source.len(),
        version: open
            .session
            .about()
            .get("page")
            .cloned()
            .unwrap_or_default(),
        setup: setup(open).await.unwrap_or_default(),
        from_unix_us: i64::try_from(from_ns.unwrap_or_default() / 1_000).unwrap_or_default(),
        duration_us: micros(overview.duration()),
        bucket_us: micros(overview.bucket()),
        sent: overview.sent,
        received: overview.received,
        lost: overview.lost,
        junk: overview.junk,
        motors: overview.motors().map(motor).collect(),
        marks: overview.marks().iter().map(mark).collect(),
        marks_left_out: overview.marks_left_out,
        runs: runs.by_ref().take(RUNS_MAX).collect(),
        runs_left_out: runs.count() as u64,
        problems: open.problems.iter().collect(),
    }
}

/// The setup that is attached to the session, if it can be read.
async fn setup(open: &OpenSession) -> Option<String> {
    let range = open.session.attachment_range(SETUP)?;
    let bytes = open.source.read(range).await.ok()?;
    let setup = Session::attachment(&bytes).ok()?;
    String::from_utf8(setup.to_vec()).ok()
}

fn motor((id, motor): (MotorId, &MotorOverview)) -> SessionMotor {
    let buckets = motor.buckets().iter();
    let speeds = buckets.clone().map(|bucket| {
        let (least, most) = (*bucket)?.speed;
        Some([least.rpm(), most.rpm()])
    });
    let currents = buckets.map(|bucket| {
        let (least, most) = (*bucket)?.current?;
        Some([least.raw(), most.raw()])
    });
    SessionMotor {
        id,
        replies: motor.replies,
        lost: motor.lost,
        faults: motor.faults,
        temperature_max_c: motor.temperature_max_c,
        speeds: speeds.collect(),
        currents: currents.collect(),
    }
}

fn mark(mark: &Mark) -> SessionMark {
    SessionMark {
        after_us: micros(mark.after),
        error: mark.error,
        text: mark.text.clone(),
        is_bookmark: mark.kind == EventKind::Bookmark,
    }
}

fn micros(duration: Duration) -> u64 {
    u64::try_from(duration.as_micros()).unwrap_or(u64::MAX)
}
