//! Samples of telemetry: always those of the last ten minutes, and those that the user records.

use std::{ops::Range, time::Duration};

use motorlink_bus::{LineEvent, LineEventKind, LineSamples, reported_current};
use motorlink_messages::recorder::RecordingStatus;
use motorlink_protocol::{
    FRAME_AIRTIME, Frame, Instant, Layout, Mode, Reply,
    family::{Current, Model},
};

use crate::{
    chunks::{Chunks, within},
    commanded::{Commanded, Commands},
};

/// How long samples are kept that are not recorded.
pub const ROLLING: Duration = Duration::from_secs(600);

/// The samples that the line can carry within [`ROLLING`]: an exchange is two frames of 868 us, so there
/// are at most 576 a second. They take 8.3 MB.
pub const ROLLING_MAX: u64 =
    ROLLING.as_secs() * 1_000_000 / (2 * FRAME_AIRTIME.subsec_micros() as u64) + 1;

/// The maximal number of recorded samples: two hours at 500 Hz, in 96 MB.
pub const RECORDED_MAX: u64 = 4_000_000;

/// One reply, as it was on the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sample {
    pub(crate) at: Instant,
    pub(crate) frame: Frame,
    /// What bytes 6 and 7 of a combined frame mean; `None` if that is uncertain.
    pub(crate) asked: Option<Layout>,
    pub(crate) model: Model,
    /// The loop of the motor, which separate frames do not name.
    pub(crate) mode: Mode,
    /// What the motor was told before it; `None` without a command.
    pub(crate) commanded: Option<Commanded>,
}

const _: () = assert!(size_of::<Sample>() == 24);

impl Sample {
    /// The motor's ID.
    pub(crate) const fn address(&self) -> u8 {
        let [address, ..] = *self.frame.bytes();
        address
    }

    /// What it says, behind the samples that were read before.
    pub(crate) fn read(&self, before: &mut LineSamples) -> Option<Reply> {
        let read_in = (self.model, self.mode);
        let sample = before.read(self.at, read_in, &self.frame, self.asked)?;
        Some(sample.reply)
    }

    /// Its current as the motor reports it.
    pub(crate) fn current(&self) -> Option<Current> {
        reported_current(self.model, &self.frame)
    }

    /// Its current, if it is certain how many amps that is.
    pub(crate) fn certain_current(&self) -> Option<Current> {
        self.current()
            .filter(|current| current.scale().is_certain())
    }
}

/// Follows a line by its events.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    samples: LineSamples,
    commands: Commands,
}

impl Line {
    pub(crate) const fn new() -> Self {
        Self {
            samples: LineSamples::of(Model::Ddsm115),
            commands: Commands::new(),
        }
    }

    /// The model of the line.
    pub(crate) const fn model(&self) -> Model {
        self.samples.model()
    }

    /// Takes the next event. Returns the sample of a reply with the command that was sent before it, and what it says.
    #[inline(never)]
    pub(crate) fn add_event(&mut self, traffic: &LineEvent) -> Option<(Sample, Reply)> {
        self.commands.add_event(self.model(), traffic);
        let reply = self.samples.add_event(traffic)?.reply;
        let LineEventKind::Received { frame, asked } = traffic.kind else {
            return None;
        };
        let at = traffic.at;
        let sample = Sample {
            at,
            frame,
            asked,
            model: self.model(),
            mode: reply.mode,
            commanded: self.commands.at(reply.id.get(), at),
        };
        Some((sample, reply))
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
    /// What its events say.
    line: Line,
    /// What those of a saved recording say that is being restored.
    marks: Line,
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
            line: Line::new(),
            marks: Line::new(),
        }
    }

    /// Adds a line event: the sample of a valid reply, and what motors are told.
    pub fn add_event(&mut self, traffic: &LineEvent) {
        self.add(traffic);
    }

    /// The same. Returns the sample if it was recorded.
    pub(crate) fn add(&mut self, traffic: &LineEvent) -> Option<Sample> {
        let (sample, _) = self.line.add_event(traffic)?;
        self.roll_sample(sample);
        self.record_sample(sample).then_some(sample)
    }

    /// The same, but adds only to the rolling samples.
    pub(crate) fn roll(&mut self, traffic: &LineEvent) {
        if let Some((sample, _)) = self.line.add_event(traffic) {
            self.roll_sample(sample);
        }
    }

    /// Begins a batch of a saved recording. Each batch repeats its marks, so that it can be read alone.
    pub(crate) fn begin_batch(&mut self) {
        self.marks = Line::new();
    }

    /// Adds a line event of a saved recording: a sample to the recorded ones, or a mark before it.
    pub(crate) fn record_again(&mut self, traffic: &LineEvent) {
        if let Some((mut sample, _)) = self.marks.add_event(traffic) {
            // However long ago: the next mark says when it ends.
            sample.commanded = self.marks.commands.marked(sample.address());
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
        let restarted = on && self.is_exported();
        if restarted {
            self.recorded = self.recorded.continued();
            self.recorded_for = Duration::ZERO;
            self.state = State::Off;
        }
        self.record_on(on);
        restarted
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

    /// The samples of this time to export: the recorded ones, or the last ten minutes if none were recorded.
    pub(crate) fn to_export(&self, time: &Range<Instant>) -> (SampleSet, Range<u64>) {
        let part = |which| {
            let samples = self.samples(which);
            let at = |number| Some(samples.get(number)?.at);
            (which, within(time, samples.first()..samples.end(), at))
        };
        let recorded = part(SampleSet::Recorded);
        if recorded.1.is_empty() {
            part(SampleSet::Rolling)
        } else {
            recorded
        }
    }

    /// The number after the newest rolling sample.
    pub(crate) const fn rolling_end(&self) -> u64 {
        self.rolling.end()
    }

    /// At most this many rolling samples before this number, oldest first.
    pub(crate) fn rolling_before(&self, until: u64, most: u16) -> Vec<motorlink_bus::Sample> {
        let from = until.saturating_sub(most.into()).max(self.rolling.first());
        let mut before = LineSamples::default();
        let samples = (from..until).filter_map(|number| {
            let sample = self.rolling.get(number)?;
            let (at, reply) = (sample.at, sample.read(&mut before)?);
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
        self.line = other.line.clone();
        self.line.commands.set_clock(&mut at);
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

    pub(crate) const fn is_empty(&self) -> bool {
        self.rolling.len() + self.recorded.len() == 0
    }

    pub(crate) const fn samples(&self, which: SampleSet) -> &Chunks<Sample> {
        match which {
            SampleSet::Rolling => &self.rolling,
            SampleSet::Recorded => &self.recorded,
        }
    }
}

#[cfg(test)]
#[path = "recording_tests.rs"]
mod tests;
