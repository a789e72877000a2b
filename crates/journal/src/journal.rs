//! The journal as a whole: messages and traffic go in, messages and parts of files come out.

use std::{collections::VecDeque, time::Duration};

use motorlink_bus::Traffic;
use motorlink_messages::journal::{Export, FromJournal, RecordingStatus, ToJournal, Window};
use motorlink_protocol::Instant;

use crate::{csv_file::CsvFile, log::Log, recording::Recording, wall_clock::WallClock};

/// A page of the log at most 30 times a second.
const PAGE_PERIOD: Duration = Duration::from_micros(33_400);
/// The state of the recording at most five times a second.
const STATUS_PERIOD: Duration = Duration::from_millis(200);
/// How far an export is, ten times a second: a bar that moves.
const PROGRESS_PERIOD: Duration = Duration::from_millis(100);

/// A part of a file, in bytes: some fifty for a full log, each copied in a millisecond.
const PART: usize = 2 << 20;

/// What the journal wants of whoever calls it.
#[derive(Debug)]
pub enum Output {
    /// Tell the page.
    Tell(FromJournal),
    /// Keep this behind the parts that are kept.
    Part(Vec<u8>),
    /// The parts that are kept are the file that this message names: give it to the page with it.
    File(FromJournal),
    /// Give the parts that are kept up, and tell the page why.
    NoFile(FromJournal),
    /// There is work: see [`Journal::work`]. Between two of these, let messages in.
    Work,
    /// Nothing is to be done until something comes, or until then.
    Wait(Option<Instant>),
}

/// The packet log, the recording, and what the page wants of them.
///
/// Two clocks go in. Traffic, and what the page says, carries the time of the worker that owns the port;
/// `now` is the caller's own, and decides only when something is told again.
#[derive(Debug)]
pub struct Journal {
    log: Log,
    recording: Recording,
    /// The caller's clock.
    own_clock: WallClock,
    window: Option<Window>,
    page_changed: bool,
    page_told: Option<Instant>,
    status: RecordingStatus,
    status_told: Option<Instant>,
    /// Files that are wanted, of which the first is being made.
    files: VecDeque<CsvFile>,
    progress_told: Option<Instant>,
    /// What is to be told at once.
    outgoing: VecDeque<Output>,
}

impl Journal {
    /// An empty journal. `own_clock` is that of `now` in every other call.
    #[must_use]
    pub fn new(own_clock: WallClock) -> Self {
        Self::with(own_clock, Log::default(), Recording::default())
    }

    /// A journal that keeps what these keep.
    #[must_use]
    pub fn with(own_clock: WallClock, log: Log, recording: Recording) -> Self {
        Self {
            log,
            recording,
            own_clock,
            window: None,
            page_changed: false,
            page_told: None,
            status: RecordingStatus::default(),
            status_told: None,
            files: VecDeque::new(),
            progress_told: None,
            outgoing: VecDeque::new(),
        }
    }

    /// Local time is so many minutes ahead of UTC, in the log and in the names of files.
    pub const fn set_utc_offset(&mut self, minutes: i32) {
        self.own_clock = self.own_clock.with_utc_offset(minutes);
        self.log
            .set_clock(self.log.clock().with_utc_offset(minutes));
    }

    /// Takes what has passed on the line.
    pub fn passed(&mut self, traffic: &Traffic) {
        self.log.passed(traffic);
        self.recording.passed(traffic);
        self.page_changed = true;
    }

    /// Does what the page asks.
    pub fn handle(&mut self, message: ToJournal) {
        self.page_changed |= !matches!(
            message,
            ToJournal::ExportLog
                | ToJournal::ExportTelemetry
                | ToJournal::CancelExport
                | ToJournal::Record(_)
        );
        match message {
            ToJournal::Epoch { unix_ms } => {
                let offset = self.own_clock.utc_offset_minutes();
                self.log.set_clock(WallClock::new(unix_ms, offset));
            }
            ToJournal::Say { at, error, text } => self.log.say(at, error, &text),
            ToJournal::Look(window) => self.window = Some(window),
            ToJournal::Filter(filter) => self.log.filter(&filter),
            ToJournal::Clear => self.log.clear(),
            ToJournal::ExportLog => self.make(Export::Log),
            ToJournal::ExportTelemetry => self.make(Export::Telemetry),
            ToJournal::CancelExport => {
                for file in std::mem::take(&mut self.files) {
                    self.no_file(file.what(), true);
                }
            }
            ToJournal::Record(on) => self.recording.record(on),
        }
    }

    /// Begins a file, unless such a one is being made.
    fn make(&mut self, what: Export) {
        if self.files.iter().any(|file| file.what() == what) {
            return;
        }
        let file = match what {
            Export::Log => CsvFile::of_log(&mut self.log),
            Export::Telemetry => CsvFile::of_telemetry(&self.recording),
        };
        if file.rows_in_all() == 0 {
            self.no_file(what, false);
        } else {
            self.files.push_back(file);
        }
    }

    fn no_file(&mut self, what: Export, cancelled: bool) {
        let message = FromJournal::NotExported { what, cancelled };
        self.outgoing.push_back(Output::NoFile(message));
    }

    /// What is to be done next. Call it until it says [`Output::Wait`].
    pub fn poll(&mut self, now: Instant) -> Output {
        if let Some(output) = self.outgoing.pop_front() {
            return output;
        }
        let page_due = due(now, self.page_told, PAGE_PERIOD);
        if self.page_changed
            && page_due <= now
            && let Some(window) = self.window
        {
            self.page_changed = false;
            self.page_told = Some(now);
            return Output::Tell(FromJournal::Log(self.log.page(window)));
        }
        let status = self.recording.status();
        let status_due = due(now, self.status_told, STATUS_PERIOD);
        if status != self.status && status_due <= now {
            self.status = status;
            self.status_told = Some(now);
            return Output::Tell(FromJournal::Recording(status));
        }
        if let Some(progress) = self.progress(now) {
            return Output::Tell(progress);
        }
        if !self.log.is_filtered() || !self.files.is_empty() {
            return Output::Work;
        }
        let page_due = (self.page_changed && self.window.is_some()).then_some(page_due);
        let status_due = (status != self.status).then_some(status_due);
        Output::Wait(page_due.into_iter().chain(status_due).min())
    }

    fn progress(&mut self, now: Instant) -> Option<FromJournal> {
        let file = self.files.front()?;
        (due(now, self.progress_told, PROGRESS_PERIOD) <= now).then(|| {
            self.progress_told = Some(now);
            FromJournal::Exporting {
                what: file.what(),
                done: file.rows(),
                of: file.rows_in_all(),
            }
        })
    }

    /// Goes on with what takes long: looks at so many entries, or writes so many lines. `now` is for the
    /// name of a file that is ready.
    pub fn work(&mut self, now: Instant, entries: u64) {
        // A person waits for the rows; a file waits for itself.
        if !self.log.is_filtered() {
            self.log.advance(entries);
            self.page_changed = true;
            return;
        }
        let Some(file) = self.files.front_mut() else {
            return;
        };
        let is_whole = file.advance(&self.log, &self.recording, entries);
        if is_whole || file.written() >= PART {
            self.outgoing.push_back(Output::Part(file.take()));
        }
        if is_whole && let Some(file) = self.files.pop_front() {
            self.finish(now, &file);
        }
    }

    fn finish(&mut self, now: Instant, file: &CsvFile) {
        let what = file.what();
        // All of it may have been cleared meanwhile.
        if file.rows() == 0 {
            return self.no_file(what, false);
        }
        if let Some(until) = file.recorded_until() {
            self.recording.exported(until);
        }
        let mut name = String::from(match what {
            Export::Log => "motorlink-log-",
            Export::Telemetry => "motorlink-telemetry-",
        });
        self.own_clock.push_file_stamp(&mut name, now);
        name.push_str(".csv");
        let rows = file.rows();
        self.outgoing
            .push_back(Output::File(FromJournal::Exported { what, name, rows }));
        self.progress_told = None;
    }
}

/// When something may be told again.
fn due(now: Instant, told: Option<Instant>, period: Duration) -> Instant {
    told.map_or(now, |told| told + period)
}
