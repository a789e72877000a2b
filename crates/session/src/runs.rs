//! The runs of experiments in a session file: each is an attachment, in the format of the page's own export of a run.

use motorlink_messages::experiments::{
    kept::{Outcome, RunHeader, run_from_json, run_to_json},
    runner::{End, Record as RunRecord},
    sequence::NAME_MAX,
};
use motorlink_protocol::Instant;

use crate::{
    reader::{Attachment, Problem, Session},
    record::{Event, EventKind},
    writer::Writer,
};

/// Every such attachment has a name of this form: `run-1764041529 Step response.json`.
const START: &str = "run-";
const END: &str = ".json";

/// The page reads the wall clock at the start of a run, the recorder at its events. They differ by milliseconds, and after
/// a restored session by more.
const CLOCKS_DIFFER_MS: f64 = 2_000.0;
/// If the wall clock is set during a session, both can differ by any time. Then the monotonic clock decides, which begins
/// again with each visit.
const DAY_MS: f64 = 86_400_000.0;

/// Maximal letters of a text of a run, such as the name of its model.
const TEXT_MAX: usize = 64;
/// Maximal number of motors of a run: there are fewer IDs.
const MOTORS_MAX: usize = 255;
/// Maximal bytes of the setup and of the study of a run. A sequence of ten thousand steps has a megabyte.
const SETUP_BYTES_MAX: usize = 1 << 20;
const STUDY_BYTES_MAX: usize = 4 << 20;

/// When the runs of a session began and ended, by its events. Other tabs of the page keep their runs in the same browser,
/// and those have no events here.
#[derive(Debug, Default)]
pub struct RunEvents {
    began: Vec<Moment>,
    ended: Vec<Moment>,
}

/// A time on the monotonic clock, and on the wall clock in milliseconds since 1970.
#[derive(Clone, Copy, Debug)]
struct Moment(Instant, f64);

impl Moment {
    fn is(self, at: Option<Instant>, unix_ms: f64) -> bool {
        let apart_ms = (self.1 - unix_ms).abs();
        apart_ms <= CLOCKS_DIFFER_MS || apart_ms <= DAY_MS && at == Some(self.0)
    }
}

impl RunEvents {
    /// Adds an event of the session. `zero_unix_us` is the wall clock at [`Instant::ZERO`], in microseconds since 1970.
    #[allow(
        clippy::cast_precision_loss,
        reason = "microseconds since 1970 are exact in a double until 2255"
    )]
    pub fn add(&mut self, at: Instant, zero_unix_us: i64, event: &Event) {
        if event.kind == EventKind::Run {
            let unix_ms = (zero_unix_us as f64 + at.as_micros() as f64) / 1_000.0;
            let moments = if event.begins_run() {
                &mut self.began
            } else {
                &mut self.ended
            };
            moments.push(Moment(at, unix_ms));
        }
    }

    /// Whether there is no run in the session.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.began.is_empty() && self.ended.is_empty()
    }

    /// Whether the start or the end of this run is in the session.
    #[must_use]
    pub fn have(&self, run: &RunHeader) -> bool {
        let starts = |moment: &Moment| moment.is(run.began, run.began_unix_ms);
        if self.began.iter().any(starts) {
            return true;
        }
        let (Some(began), Outcome::Ended(end)) = (run.began, run.outcome) else {
            return false;
        };
        let (End::Finished { at } | End::Aborted { at, .. }) = end;
        let ended_unix_ms = run.began_unix_ms + at.since(began).as_secs_f64() * 1_000.0;
        // The event is logged when the page gets to know of the end, so only the wall clock can agree.
        self.ended
            .iter()
            .any(|moment| moment.is(None, ended_unix_ms))
    }
}

/// A run of an experiment in an open session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AttachedRun {
    /// Its name, as the user gave it, or its number if it has none. Letters that no file name may have are `-`.
    pub name: String,
    /// The attachment.
    pub attachment: Attachment,
}

impl Session {
    /// The runs of experiments, in the order of the file.
    pub fn runs(&self) -> impl Iterator<Item = AttachedRun> {
        self.attachments().filter_map(|attachment| {
            let stem = attachment.name.strip_prefix(START)?.strip_suffix(END)?;
            let (number, name) = stem.split_once(' ').unwrap_or((stem, ""));
            number.parse::<u32>().ok()?;
            let shown = if name.is_empty() { number } else { name };
            Some(AttachedRun {
                name: shown.chars().take(NAME_MAX).collect(),
                attachment,
            })
        })
    }

    /// The run in these bytes, which were read at [`Self::attachment_range`].
    ///
    /// # Errors
    /// The bytes are damaged, or of a later version.
    pub fn read_run(bytes: &[u8]) -> Result<(RunHeader, RunRecord), Problem> {
        let damaged = Problem::AttachmentDamaged;
        let text = std::str::from_utf8(Self::attachment(bytes)?).map_err(|_| damaged)?;
        let (mut header, record) = run_from_json(text).map_err(|_| damaged)?;
        header.name = header.name.chars().take(NAME_MAX).collect();
        let is_short = |text: &String| text.chars().count() <= TEXT_MAX;
        let fits = is_short(&header.model)
            && is_short(&header.page_version)
            && header.motors.iter().all(|(_, name)| is_short(name))
            && header.motors.len() <= MOTORS_MAX
            && header.setup.len() <= SETUP_BYTES_MAX
            && header.study.len() <= STUDY_BYTES_MAX;
        if fits {
            Ok((header, record))
        } else {
            Err(damaged)
        }
    }
}

impl Writer {
    /// Adds a run of an experiment as an attachment.
    pub fn attach_run(&mut self, header: &RunHeader, record: &RunRecord) {
        let json = run_to_json(header, record);
        self.attach(&file_name(header), "application/json", json.as_bytes());
    }
}

fn file_name(header: &RunHeader) -> String {
    let is_forbidden = |letter: char| letter.is_control() || r#"/\:*?"<>|"#.contains(letter);
    let letters = header.name.trim().chars().take(NAME_MAX);
    let name: String = letters
        .map(|letter| if is_forbidden(letter) { '-' } else { letter })
        .collect();
    let space = if name.is_empty() { "" } else { " " };
    format!("{START}{}{space}{name}{END}", header.number)
}
