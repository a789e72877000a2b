//! Samples of telemetry: always those of the last ten minutes, and those that the user records.

use std::time::Duration;

use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_messages::recorder::RecordingStatus;
use motorlink_protocol::{FRAME_AIRTIME, Frame, Instant, Layout, Reply};

use crate::chunks::Chunks;

/// How long samples are kept that are not recorded.
pub const ROLLING: Duration = Duration::from_secs(600);

/// The samples that the line can carry within [`ROLLING`]: an exchange is two frames of 868 us, so there
/// are at most 576 a second. They take 8.3 MB.
pub const ROLLING_MAX: u64 =
    ROLLING.as_secs() * 1_000_000 / (2 * FRAME_AIRTIME.subsec_micros() as u64) + 1;

/// The maximal number of recorded samples: two hours at 500 Hz, in 96 MB.
pub const RECORDED_MAX: u64 = 4_000_000;

/// One reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sample {
    pub(crate) at: Instant,
    pub(crate) frame: Frame,
    /// What its bytes 6 and 7 mean; `None` if that is uncertain.
    pub(crate) asked: Option<Layout>,
}

const _: () = assert!(size_of::<Sample>() == 24);

impl Sample {
    /// The sample of a line event, if it is a valid reply.
    fn of(traffic: &LineEvent) -> Option<Self> {
        let LineEventKind::Received { frame, asked } = traffic.kind else {
            return None;
        };
        let at = traffic.at;
        let is_reply = Reply::decode(&frame, asked).is_ok();
        is_reply.then_some(Self { at, frame, asked })
    }
}

/// A set of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SampleSet {
    /// The last ten minutes.
    Rolling,
    /// The recorded samples.
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
    /// The recording has reached its maximal size.
    Full,
}

/// The rolling and the recorded samples.
#[derive(Debug)]
pub struct Recording {
    rolling: Chunks<Sample>,
    recorded: Chunks<Sample>,
    recorded_max: u64,
    state: State,
    /// Recorded time, without pauses.
    recorded_for: Duration,
    /// The number after the newest exported sample.
    exported_until: u64,
}

impl Default for Recording {
    fn default() -> Self {
        Self::with_capacity(RECORDED_MAX)
    }
}

impl Recording {
    /// An empty recording with room for this number of recorded samples.
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

    /// Adds the sample of a line event, if it is a valid reply. Returns whether it was recorded.
    pub fn add_event(&mut self, traffic: &LineEvent) -> bool {
        let Some(sample) = Sample::of(traffic) else {
            return false;
        };
        self.roll_sample(sample);
        self.record_sample(sample)
    }

    /// The same, but adds only to the rolling samples.
    pub(crate) fn roll(&mut self, traffic: &LineEvent) {
        if let Some(sample) = Sample::of(traffic) {
            self.roll_sample(sample);
        }
    }

    /// The same, but adds only to the recorded samples.
    pub(crate) fn record_again(&mut self, traffic: &LineEvent) {
        if let Some(sample) = Sample::of(traffic) {
            self.record_sample(sample);
        }
    }

    fn roll_sample(&mut self, sample: Sample) {
        // Ten minutes before the newest sample, not before now: the last samples before a motor was
        // unplugged can be exported half an hour later.
        let kept_from = sample.at - ROLLING;
        while self.rolling.len() >= ROLLING_MAX
            || self.rolling.oldest().is_some_and(|old| old.at < kept_from)
        {
            self.rolling.pop();
        }
        self.rolling.push(sample);
    }

    fn record_sample(&mut self, sample: Sample) -> bool {
        let State::On { newest } = &mut self.state else {
            return false;
        };
        let before = newest.replace(sample.at);
        self.recorded_for += sample.at.since(before.unwrap_or(sample.at));
        self.recorded.push(sample);
        if self.recorded.len() >= self.recorded_max {
            self.state = State::Full;
        }
        true
    }

    /// Starts or stops recording. New samples are appended, unless all samples were exported: then a new
    /// recording begins, and this returns true. A full recording has to be exported first.
    pub fn record(&mut self, on: bool) -> bool {
        let anew = on && self.is_exported();
        if anew {
            self.recorded.clear();
            self.recorded_for = Duration::ZERO;
            self.state = State::Off;
        }
        self.record_on(on);
        anew
    }

    /// The same, but always appends.
    pub(crate) fn record_on(&mut self, on: bool) {
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

    /// The state of the recording.
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

    /// The samples to export: the recorded ones, or the last ten minutes if none were recorded.
    pub(crate) const fn to_export(&self) -> (SampleSet, std::ops::Range<u64>) {
        if self.recorded.len() > 0 {
            (
                SampleSet::Recorded,
                self.recorded.first()..self.recorded.end(),
            )
        } else {
            (SampleSet::Rolling, self.rolling.first()..self.rolling.end())
        }
    }

    /// The number after the newest rolling sample.
    pub(crate) const fn rolling_end(&self) -> u64 {
        self.rolling.end()
    }

    /// At most this many rolling samples before this number, oldest first.
    pub(crate) fn rolling_before(&self, until: u64, most: u16) -> Vec<motorlink_bus::Sample> {
        let from = until.saturating_sub(most.into()).max(self.rolling.first());
        let samples = (from..until).filter_map(|number| {
            let Sample { at, frame, asked } = self.rolling.get(number)?;
            let reply = Reply::decode(&frame, asked).ok()?;
            Some(motorlink_bus::Sample { at, reply })
        });
        samples.collect()
    }

    /// The recorded samples before this number have been exported.
    pub(crate) fn exported(&mut self, until: u64) {
        self.exported_until = self.exported_until.max(until);
    }

    /// All recorded samples have been exported.
    pub(crate) fn all_exported(&mut self) {
        self.exported_until = self.recorded.end();
    }

    /// Appends samples of another recording, from these numbers on and at most this many of each set.
    /// Returns whether all have been copied.
    pub(crate) fn copy(
        &mut self,
        other: &Self,
        from: &mut [u64; 2],
        most: u64,
        mut at: impl FnMut(Instant) -> Instant,
    ) -> bool {
        let [rolling, recorded] = from;
        let mut copied =
            |samples: &Chunks<Sample>, next: &mut u64, keep: &mut dyn FnMut(Sample)| {
                *next = (*next).max(samples.first());
                let until = samples.end().min(*next + most);
                while let Some(sample) = samples.get(*next).filter(|_| *next < until) {
                    let at = at(sample.at);
                    keep(Sample { at, ..sample });
                    *next += 1;
                }
                *next >= samples.end()
            };
        let rolled = copied(&other.rolling, rolling, &mut |sample| {
            self.roll_sample(sample);
        });
        let recorded_all = copied(&other.recorded, recorded, &mut |sample| {
            if self.recorded.len() < self.recorded_max {
                self.recorded.push(sample);
            }
        });
        rolled && recorded_all
    }

    /// Takes over the state of another recording whose samples have been appended to this one.
    pub(crate) fn continue_from(&mut self, other: &Self, mut at: impl FnMut(Instant) -> Instant) {
        let own = self.recorded.len() - other.recorded.len().min(self.recorded.len());
        if other.is_exported() && own == 0 {
            self.all_exported();
        }
        self.recorded_for += other.recorded_for;
        self.state = match other.state {
            _ if self.recorded.len() >= self.recorded_max => State::Full,
            State::On { newest } => State::On {
                newest: newest.map(&mut at),
            },
            State::Off | State::Full => State::Off,
        };
    }

    /// The maximal number of recorded samples.
    pub(crate) const fn capacity(&self) -> u64 {
        self.recorded_max
    }

    pub(crate) const fn samples(&self, which: SampleSet) -> &Chunks<Sample> {
        match which {
            SampleSet::Rolling => &self.rolling,
            SampleSet::Recorded => &self.recorded,
        }
    }
}

#[cfg(test)]
mod tests {
    use motorlink_protocol::MotorId;

    use super::*;

    fn reply_at(at: Instant) -> LineEvent {
        LineEvent {
            at,
            kind: LineEventKind::Received {
                frame: "01 02 02 CD 00 64 17 CF 00 8F".parse().unwrap(),
                asked: Some(Layout::Drive),
            },
        }
    }

    fn receive(recording: &mut Recording, millis: impl IntoIterator<Item = u64>) {
        for at in millis {
            recording.add_event(&reply_at(Instant::from_millis(at)));
        }
    }

    #[test]
    fn samples_older_than_ten_minutes_are_dropped() {
        let mut recording = Recording::default();
        receive(&mut recording, [0, 1, 599_999, 600_000]);
        assert_eq!(recording.status().rolling, 4);
        receive(&mut recording, [600_001]);
        assert_eq!(recording.status().rolling, 4, "the one at 0 is too old");
        receive(&mut recording, [1_200_001]);
        assert_eq!(recording.status().rolling, 2);
    }

    #[test]
    fn no_more_samples_are_kept_than_the_line_carries_in_ten_minutes() {
        let mut recording = Recording::default();
        receive(&mut recording, std::iter::repeat_n(5, 400_000));
        assert_eq!(recording.status().rolling, ROLLING_MAX);
        assert_eq!(ROLLING_MAX, 345_623);
        let reserved = recording.rolling.reserved();
        receive(&mut recording, std::iter::repeat_n(6, 400_000));
        assert!(recording.rolling.reserved() <= reserved + 1024);
    }

    #[test]
    fn only_good_replies_are_samples() {
        let mut recording = Recording::default();
        let at = Instant::ZERO;
        let frame = "01 74 00 00 00 00 00 00 00 04".parse().unwrap();
        let silence = LineEventKind::Silence {
            id: MotorId::FIRST,
            waited_us: 1,
        };
        for passed in [
            LineEventKind::Sent { frame, mode: None },
            LineEventKind::Received { frame, asked: None },
            silence,
        ] {
            recording.add_event(&LineEvent { at, kind: passed });
        }
        assert_eq!(recording.status().rolling, 0);
    }

    #[test]
    fn a_recording_goes_on_until_it_was_exported() {
        let mut recording = Recording::default();
        receive(&mut recording, [0, 10]);
        recording.record(true);
        receive(&mut recording, [20, 30, 45]);
        recording.record(false);
        receive(&mut recording, [1_000]);
        recording.record(true);
        receive(&mut recording, [5_000, 5_005]);
        let status = recording.status();
        assert_eq!(
            (status.recorded, status.recorded_ms, status.rolling),
            (5, 30, 8)
        );
        assert!(status.recording && !status.exported);

        let (which, range) = recording.to_export();
        assert_eq!(which, SampleSet::Recorded);
        recording.exported(range.end);
        assert!(recording.status().exported);
        receive(&mut recording, [5_010]);
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
        receive(&mut recording, [6_000]);
        let status = recording.status();
        assert_eq!((status.recorded, status.recorded_ms), (1, 0));
    }

    #[test]
    fn a_full_recording_ends_by_itself_and_keeps_what_it_has() {
        let mut recording = Recording::with_capacity(3);
        recording.record(true);
        receive(&mut recording, 0..10);
        let status = recording.status();
        assert!(status.full && !status.recording);
        assert_eq!((status.recorded, status.rolling), (3, 10));
        recording.record(true);
        receive(&mut recording, 10..12);
        assert_eq!(recording.status().recorded, 3, "it is exported first");
        let (_, range) = recording.to_export();
        recording.exported(range.end);
        recording.record(true);
        receive(&mut recording, 12..14);
        let status = recording.status();
        assert!(status.recording && !status.full);
        assert_eq!(status.recorded, 2);
    }

    #[test]
    fn without_a_recording_the_last_ten_minutes_are_exported() {
        let mut recording = Recording::default();
        receive(&mut recording, 0..5);
        assert_eq!(recording.to_export(), (SampleSet::Rolling, 0..5));
    }
}
