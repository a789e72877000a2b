//! Every sample of telemetry: the last ten minutes always, and what a person records for as long as
//! they record it.

use std::time::Duration;

use motorlink_bus::{Passed, Traffic};
use motorlink_messages::journal::RecordingStatus;
use motorlink_protocol::{FRAME_AIRTIME, Frame, Instant, Layout, Reply};

use crate::chunks::Chunks;

/// How long a sample is kept without being recorded.
pub const ROLLING: Duration = Duration::from_secs(600);

/// Samples of [`ROLLING`] that the line can carry: an exchange is two frames of 868 us, so there are at
/// most 576 a second. They take 8.3 MB.
pub const ROLLING_MAX: u64 =
    ROLLING.as_secs() * 1_000_000 / (2 * FRAME_AIRTIME.subsec_micros() as u64) + 1;

/// Samples that are recorded at most: two hours of 500 Hz, in 96 MB.
pub const RECORDED_MAX: u64 = 4_000_000;

/// One reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sample {
    pub(crate) at: Instant,
    pub(crate) frame: Frame,
    /// What its bytes 6 and 7 mean; `None` where that is not certain.
    pub(crate) asked: Option<Layout>,
}

const _: () = assert!(size_of::<Sample>() == 24);

/// Which samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Which {
    /// The last ten minutes.
    Rolling,
    /// What was recorded.
    Recorded,
}

/// Whether samples are recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Off,
    On {
        /// The newest sample since Record was pressed.
        newest: Option<Instant>,
    },
    /// There is no more room.
    Full,
}

/// Samples, as many as are kept.
#[derive(Debug)]
pub struct Recording {
    rolling: Chunks<Sample>,
    recorded: Chunks<Sample>,
    recorded_max: u64,
    state: State,
    /// Time between the samples, without that in which nothing was recorded.
    recorded_for: Duration,
    /// The number behind that of the newest sample that is in a file.
    exported_until: u64,
}

impl Default for Recording {
    fn default() -> Self {
        Self::with_capacity(RECORDED_MAX)
    }
}

impl Recording {
    /// Records so many samples at most.
    #[must_use]
    pub const fn with_capacity(recorded_max: u64) -> Self {
        Self {
            rolling: Chunks::new(),
            recorded: Chunks::new(),
            recorded_max,
            state: State::Off,
            recorded_for: Duration::ZERO,
            exported_until: 0,
        }
    }

    /// Takes the sample out of what has passed, where it is a good reply.
    pub fn passed(&mut self, traffic: &Traffic) {
        let Passed::Heard { frame, asked } = traffic.passed else {
            return;
        };
        if Reply::decode(&frame, asked).is_err() {
            return;
        }
        let at = traffic.at;
        let sample = Sample { at, frame, asked };
        // Ten minutes up to the newest sample, not up to now: what a motor did before its plug was
        // pulled can be exported half an hour later.
        let kept_from = at - ROLLING;
        while self.rolling.len() >= ROLLING_MAX
            || self.rolling.oldest().is_some_and(|old| old.at < kept_from)
        {
            self.rolling.pop();
        }
        self.rolling.push(sample);
        self.record_sample(sample);
    }

    fn record_sample(&mut self, sample: Sample) {
        let State::On { newest } = &mut self.state else {
            return;
        };
        let before = newest.replace(sample.at);
        self.recorded_for += sample.at.since(before.unwrap_or(sample.at));
        self.recorded.push(sample);
        if self.recorded.len() >= self.recorded_max {
            self.state = State::Full;
        }
    }

    /// Begins or ends the recording. It goes on behind what is there, unless all of that was exported:
    /// then it begins anew. What is full has to be exported first.
    pub fn record(&mut self, on: bool) {
        if on && self.is_exported() {
            self.recorded.clear();
            self.recorded_for = Duration::ZERO;
            self.state = State::Off;
        }
        self.state = match (on, self.state) {
            (_, State::Full) => State::Full,
            (true, State::Off) => State::On { newest: None },
            (true, on @ State::On { .. }) => on,
            (false, _) => State::Off,
        };
    }

    fn is_exported(&self) -> bool {
        self.recorded.len() > 0 && self.exported_until == self.recorded.end()
    }

    /// How it stands.
    #[must_use]
    pub fn status(&self) -> RecordingStatus {
        RecordingStatus {
            recording: matches!(self.state, State::On { .. }),
            recorded: self.recorded.len(),
            recorded_ms: u64::try_from(self.recorded_for.as_millis()).unwrap_or(u64::MAX),
            full: self.state == State::Full,
            exported: self.is_exported(),
            rolling: self.rolling.len(),
        }
    }

    /// What an export is of: the recording, or the last ten minutes where there is none.
    pub(crate) const fn to_export(&self) -> (Which, std::ops::Range<u64>) {
        if self.recorded.len() > 0 {
            (Which::Recorded, self.recorded.first()..self.recorded.end())
        } else {
            (Which::Rolling, self.rolling.first()..self.rolling.end())
        }
    }

    /// A file has been made of the recording up to this sample.
    pub(crate) fn exported(&mut self, until: u64) {
        self.exported_until = self.exported_until.max(until);
    }

    pub(crate) const fn samples(&self, which: Which) -> &Chunks<Sample> {
        match which {
            Which::Rolling => &self.rolling,
            Which::Recorded => &self.recorded,
        }
    }
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::MotorId;

    use super::*;

    fn reply_at(at: Instant) -> Traffic {
        Traffic {
            at,
            passed: Passed::Heard {
                frame: "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap(),
                asked: Some(Layout::Drive),
            },
        }
    }

    fn hear(recording: &mut Recording, millis: impl IntoIterator<Item = u64>) {
        for at in millis {
            recording.passed(&reply_at(Instant::from_millis(at)));
        }
    }

    #[test]
    fn samples_older_than_ten_minutes_are_dropped() {
        let mut recording = Recording::default();
        hear(&mut recording, [0, 1, 599_999, 600_000]);
        assert_eq!(recording.status().rolling, 4);
        hear(&mut recording, [600_001]);
        assert_eq!(recording.status().rolling, 4, "the one at 0 is too old");
        hear(&mut recording, [1_200_001]);
        assert_eq!(recording.status().rolling, 2);
    }

    #[test]
    fn no_more_samples_are_kept_than_the_line_carries_in_ten_minutes() {
        let mut recording = Recording::default();
        hear(&mut recording, std::iter::repeat_n(5, 400_000));
        assert_eq!(recording.status().rolling, ROLLING_MAX);
        assert_eq!(ROLLING_MAX, 345_623);
        let reserved = recording.rolling.reserved();
        hear(&mut recording, std::iter::repeat_n(6, 400_000));
        assert!(recording.rolling.reserved() <= reserved + 1024);
    }

    #[test]
    fn only_good_replies_are_samples() {
        let mut recording = Recording::default();
        let at = Instant::ZERO;
        let frame = "01 74 00 00 00 00 00 00 00 04".parse().unwrap();
        let silence = Passed::Silence {
            id: MotorId::FIRST,
            waited_us: 1,
        };
        for passed in [
            Passed::Sent { frame, mode: None },
            Passed::Heard { frame, asked: None },
            silence,
        ] {
            recording.passed(&Traffic { at, passed });
        }
        assert_eq!(recording.status().rolling, 0);
    }

    #[test]
    fn a_recording_goes_on_until_it_was_exported() {
        let mut recording = Recording::default();
        hear(&mut recording, [0, 10]);
        recording.record(true);
        hear(&mut recording, [20, 30, 45]);
        recording.record(false);
        hear(&mut recording, [1_000]);
        recording.record(true);
        hear(&mut recording, [5_000, 5_005]);
        let status = recording.status();
        assert_eq!(
            (status.recorded, status.recorded_ms, status.rolling),
            (5, 30, 8)
        );
        assert!(status.recording && !status.exported);

        let (which, range) = recording.to_export();
        assert_eq!(which, Which::Recorded);
        recording.exported(range.end);
        assert!(recording.status().exported);
        hear(&mut recording, [5_010]);
        assert!(!recording.status().exported, "one more came");
        recording.record(false);
        recording.record(true);
        assert_eq!(
            recording.status().recorded,
            6,
            "it was not exported as it is"
        );

        let (_, range) = recording.to_export();
        recording.exported(range.end);
        recording.record(false);
        assert_eq!(recording.status().recorded, 6, "it is kept until the next");
        recording.record(true);
        hear(&mut recording, [6_000]);
        let status = recording.status();
        assert_eq!((status.recorded, status.recorded_ms), (1, 0));
    }

    #[test]
    fn a_full_recording_ends_by_itself_and_keeps_what_it_has() {
        let mut recording = Recording::with_capacity(3);
        recording.record(true);
        hear(&mut recording, 0..10);
        let status = recording.status();
        assert!(status.full && !status.recording);
        assert_eq!((status.recorded, status.rolling), (3, 10));
        recording.record(true);
        hear(&mut recording, 10..12);
        assert_eq!(recording.status().recorded, 3, "it is exported first");
        let (_, range) = recording.to_export();
        recording.exported(range.end);
        recording.record(true);
        hear(&mut recording, 12..14);
        let status = recording.status();
        assert!(status.recording && !status.full);
        assert_eq!(status.recorded, 2);
    }

    #[test]
    fn without_a_recording_the_last_ten_minutes_are_exported() {
        let mut recording = Recording::default();
        hear(&mut recording, 0..5);
        assert_eq!(recording.to_export(), (Which::Rolling, 0..5));
    }
}
