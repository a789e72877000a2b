//! The messages while an open session is replayed.
//!
//! The page shows a replayed session by the messages of a live one: [`FromReplay::Update`] has the state and the replies
//! as the port worker would send them, [`FromReplay::Log`] the rows of the packet log.

use motorlink_bus::{Activity, Sample};
use motorlink_protocol::{Faults, Instant, MotorId};
use serde::{Deserialize, Serialize};

use crate::{
    Update,
    recorder::{Filter, LogPage, Row, Window},
};

/// From the page to the session worker, about the open session.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ToReplay {
    /// Begin to replay the open session, paused at its first record. Answered by [`FromReplay::Begun`].
    Begin,
    /// End it. No message of a replay follows.
    End,
    /// Play from the present place, at this speed.
    Play(PlaySpeed),
    /// Pause.
    Pause,
    /// Go to this time, in microseconds since the first record. Whether it plays stays as it is.
    Seek {
        /// The time. A time after the end is the end.
        after_us: u64,
    },
    /// Pause, and go to the next frame of the line, or to the one before.
    Step {
        /// Whether to the next one.
        forward: bool,
    },
    /// Go to the time of this row of the packet log.
    SeekRow(u64),
    /// Show these rows of the packet log of the replay, as [`ToRecorder::Show`](crate::recorder::ToRecorder::Show).
    ShowRows(Window),
    /// Set the filter of the packet log of the replay.
    Filter(Filter),
    /// Open or hide routine entries, as [`ToRecorder::Toggle`](crate::recorder::ToRecorder::Toggle).
    Toggle(u64),
    /// Use this language for the rows, as [`ToRecorder::SetLanguage`](crate::recorder::ToRecorder::SetLanguage).
    SetLanguage {
        /// The language: `en`, `zh` or `de`.
        language: String,
        /// The file of its texts, unless the program contains them.
        texts: Option<String>,
    },
}

/// A speed of playing, in thousandths of real time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlaySpeed(u32);

impl PlaySpeed {
    /// Those to choose from, in thousandths of real time.
    pub const CHOICES: [u32; 5] = [100, 500, 1_000, 10_000, 100_000];

    /// Real time.
    pub const REAL_TIME: Self = Self(1_000);

    /// From a tenth of real time to a hundred times; anything else becomes the nearer of both.
    #[must_use]
    pub fn from_per_mille(per_mille: u32) -> Self {
        Self(per_mille.clamp(100, 100_000))
    }

    /// In thousandths of real time.
    #[must_use]
    pub const fn per_mille(self) -> u32 {
        self.0
    }
}

/// From the session worker to the page, while a session is replayed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FromReplay {
    /// The replay has begun.
    Begun {
        /// The time of the first record on the clock of all [`Instant`]s of this replay.
        first: Instant,
        /// The wall clock at [`Instant::ZERO`] of that clock, in microseconds since 1970, UTC.
        zero_unix_us: i64,
        /// Time from the first to the last record, in microseconds.
        duration_us: u64,
    },
    /// The replay jumps: everything that the page shows of it is dropped. [`FromReplay::Update`] follows at once,
    /// then [`FromReplay::Faults`] and [`FromReplay::Past`].
    Jumped,
    /// The state at the present place, and what has happened since the last update.
    /// [`Update::connection`] is [`Adapter::Recording`](crate::Adapter::Recording).
    Update {
        /// The place.
        place: Place,
        /// The state; [`Update::now`] is the place on the clock of the replay.
        update: Box<Update>,
    },
    /// Replies from before a jump, for the graph. The newest part comes first; each part has at most
    /// [`PAST_SAMPLES_MAX`](crate::recorder::PAST_SAMPLES_MAX) samples, oldest first.
    Past(Vec<Sample>),
    /// What the motors did before a jump, oldest first: for the targets in the graph.
    PastActivities(Vec<ActivityChange>),
    /// The changes of faults up to a place to which it has jumped, oldest first; of a long session the newest.
    Faults(Vec<FaultChange>),
    /// The packet log of the replay.
    Log {
        /// Rows, as in [`FromRecorder::Log`](crate::recorder::FromRecorder::Log).
        rows: Box<LogPage>,
        /// The last frame before the present place, whether the log shows it or not.
        frame: Option<Box<Row>>,
    },
    /// Bytes of the file could not be read; the replay is paused. What is damaged is skipped without this message.
    Unreadable,
}

/// What a motor does from a time on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ActivityChange {
    /// From when.
    pub at: Instant,
    /// Which motor.
    pub id: MotorId,
    /// What it does.
    pub activity: Activity,
}

/// A motor reports other faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultChange {
    /// When.
    pub at: Instant,
    /// Which motor.
    pub id: MotorId,
    /// What it reports from then on; `None` if it stopped answering.
    pub faults: Option<Faults>,
}

/// The present place of a replay.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Place {
    /// Microseconds since the first record.
    pub after_us: u64,
    /// Whether it plays; it ends playing at the last record.
    pub plays: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speed_is_between_a_tenth_and_a_hundred_times() {
        let speeds = [0, 100, 1_000, 2_500, u32::MAX];
        let limited = speeds.map(|speed| PlaySpeed::from_per_mille(speed).per_mille());
        assert_eq!(limited, [100, 100, 1_000, 2_500, 100_000]);
    }
}
