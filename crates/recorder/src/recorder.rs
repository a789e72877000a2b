//! The recorder as a whole: messages and traffic go in, messages and parts of files come out.

use std::{collections::VecDeque, time::Duration};

use motorlink_bus::LineEvent;
use motorlink_i18n::Language;
use motorlink_messages::recorder::{
    Export, Filter, FromRecorder, RecordingStatus, ToRecorder, Window,
};
use motorlink_protocol::Instant;

use crate::{
    csv_file::CsvFile,
    kept::{Act, Keeper, Segment, Stream, Summary, Timeline},
    local_time::LocalTime,
    log::Log,
    recording::Recording,
    restoring::{Past, Restoring, Wants},
    wall_clock::WallClock,
};

/// A page of the log at most 30 times a second.
const PAGE_PERIOD: Duration = Duration::from_micros(33_400);
/// The state of the recording at most five times a second.
const STATUS_PERIOD: Duration = Duration::from_millis(200);
/// How far an export is, ten times a second: a bar that moves.
const PROGRESS_PERIOD: Duration = Duration::from_millis(100);

/// A part of a file, in bytes: some fifty for a full log, each copied in a millisecond.
const PART: usize = 2 << 20;

/// What the recorder wants of whoever calls it.
#[derive(Debug)]
pub enum Output {
    /// Tell the page.
    Tell(FromRecorder),
    /// Keep this behind the parts that are kept.
    Part(Vec<u8>),
    /// The parts that are kept are the file that this message names: give it to the page with it.
    File(FromRecorder),
    /// Give the parts that are kept up, and tell the page why.
    NoFile(FromRecorder),
    /// Do this with the files of the session.
    Keep(Act),
    /// Give the next file of the session that is restored: see [`Recorder::restore`].
    NextKept,
    /// There is work: see [`Recorder::work`]. Between two of these, let messages in.
    Work,
    /// Nothing is to be done until something comes, or until then.
    Wait(Option<Instant>),
}

/// The packet log, the recording, and what the page wants of them.
///
/// Two clocks go in. Traffic, and what the page says, carries the time of the worker that owns the port;
/// `now` is the caller's own, and decides only when something is told again.
#[derive(Debug)]
pub struct Recorder {
    log: Log,
    recording: Recording,
    /// The caller's clock.
    own_clock: WallClock,
    window: Option<Window>,
    page_changed: bool,
    page_told: Option<Instant>,
    status: RecordingStatus,
    status_told: Option<Instant>,
    /// Puts the times that come in on the log's clock.
    timeline: Timeline,
    /// The epoch of the times that come in, in microseconds since 1970.
    epoch_us: Option<i64>,
    filter: Filter,
    /// Where the session is kept.
    keeper: Option<Keeper>,
    restoring: Option<Box<Restoring>>,
    /// What was restored and the page does not have yet.
    past: Option<Past>,
    /// Files that were asked for while a session was being restored.
    put_off: Vec<Export>,
    /// Files that are wanted, of which the first is being made.
    files: VecDeque<CsvFile>,
    progress_told: Option<Instant>,
    /// What is to be told at once.
    outgoing: VecDeque<Output>,
}

impl Recorder {
    /// An empty recorder. `own_clock` is that of `now` in every other call.
    #[must_use]
    pub fn new(own_clock: WallClock) -> Self {
        Self::with(own_clock, Log::default(), Recording::default())
    }

    /// A recorder that keeps what these keep.
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
            timeline: Timeline::default(),
            epoch_us: None,
            filter: Filter::default(),
            keeper: None,
            restoring: None,
            past: None,
            put_off: Vec::new(),
            files: VecDeque::new(),
            progress_told: None,
            outgoing: VecDeque::new(),
        }
    }

    /// Local time, in the log and in the names of files: it has to be right from [`Self::begins_ms`] on, or
    /// from the beginning of the session to restore.
    pub const fn set_local_time(&mut self, local_time: LocalTime) {
        self.own_clock = self.own_clock.with_local_time(local_time);
        self.log
            .set_clock(self.log.clock().with_local_time(local_time));
    }

    /// When the log begins, in milliseconds since 1970; `None` before its epoch is known.
    #[must_use]
    pub fn begins_ms(&self) -> Option<i64> {
        let zero_us = self.log.clock().zero_us();
        self.epoch_us.map(|_| zero_us / 1_000)
    }

    /// The same recorder, which from now on keeps what comes in: see [`Output::Keep`].
    #[must_use]
    pub fn keeping(mut self) -> Self {
        self.keeper = Some(Keeper::default());
        self
    }

    /// From now on nothing is kept, whatever comes in.
    pub fn keep_no_more(&mut self) {
        self.keeper = None;
    }

    /// Whether it keeps what comes in.
    #[must_use]
    pub const fn is_keeping(&self) -> bool {
        self.keeper.is_some()
    }

    /// Takes what has passed on the line.
    pub fn passed(&mut self, traffic: &LineEvent) {
        let at = self.timeline.at(traffic.at);
        let placed = LineEvent { at, ..*traffic };
        self.log.passed(&placed);
        let recorded = self.recording.passed(&placed);
        if let Some(keeper) = &mut self.keeper {
            keeper.passed(traffic, recorded);
        }
        self.page_changed = true;
    }

    /// Takes in a session that is kept in these files, in order, of these sizes. Asks for them one after the other by
    /// [`Output::NextKept`], to be answered by [`Recorder::next_kept`], those of the packets first; meanwhile
    /// it goes on as it was. What is kept of this session goes behind them.
    #[inline(never)]
    pub fn restore(&mut self, summary: &Summary, files: &[(Segment, usize)]) {
        if self.restoring.is_some() {
            return;
        }
        if let Some(keeper) = &mut self.keeper {
            keeper.adopt(files);
        }
        let clock = WallClock::from_us(summary.first_epoch_us(), self.own_clock.local_time());
        self.restoring = Some(Box::new(Restoring::new(clock, &self.log, &self.recording)));
    }

    /// The file that was asked for; `None` when there is no more.
    pub fn next_kept(&mut self, file: Option<(Stream, Vec<u8>)>) {
        if let Some(restoring) = &mut self.restoring {
            restoring.take(file);
        }
    }

    /// Puts the session that was restored, with this one behind it, in the place of this one.
    #[inline(never)]
    fn finish_restoring(&mut self) {
        let Some(restoring) = self.restoring.take() else {
            return;
        };
        let past;
        (self.log, self.recording, self.timeline, past) =
            restoring.finish(&mut self.log, &self.recording, &self.filter);
        self.past = Some(past);
        self.page_changed = true;
        self.outgoing
            .push_back(Output::Tell(FromRecorder::Restored));
        for what in std::mem::take(&mut self.put_off) {
            self.make(what);
        }
    }

    /// Forgets everything, and has everything removed that is kept.
    #[inline(never)]
    fn erase(&mut self) {
        if let Some(keeper) = &mut self.keeper {
            keeper.erase();
        }
        self.restoring = None;
        self.past = None;
        self.put_off.clear();
        for file in std::mem::take(&mut self.files) {
            self.no_file(file.what(), true);
        }
        self.log.clear();
        self.recording = Recording::with_capacity(self.recording.capacity());
    }

    /// Does what the page asks.
    pub fn handle(&mut self, message: ToRecorder) {
        self.page_changed |= !matches!(
            message,
            ToRecorder::ExportLog
                | ToRecorder::ExportTelemetry
                | ToRecorder::CancelExport
                | ToRecorder::Record(_)
        );
        match message {
            ToRecorder::Epoch { unix_ms } => {
                let clock = WallClock::new(unix_ms, 0);
                self.set_epoch(clock.with_local_time(self.own_clock.local_time()));
            }
            ToRecorder::Say { at, error, text } => {
                self.log.say(self.timeline.at(at), error, &text);
                if let Some(keeper) = &mut self.keeper {
                    keeper.say(at, error, &text);
                }
            }
            ToRecorder::Look(window) => self.window = Some(window),
            ToRecorder::Speak { language, texts } => {
                let language = Language::from_tag(&language).unwrap_or_default();
                if let Some(texts) = texts {
                    // Texts of another version are refused: the rows are in English then.
                    let _ = motorlink_i18n::give(language, texts);
                }
                motorlink_i18n::speak(language);
                // What is searched for may be in other entries now.
                self.log.filter(&self.filter);
            }
            ToRecorder::Filter(filter) => {
                self.log.filter(&filter);
                self.filter = filter;
            }
            ToRecorder::Clear => {
                self.log.clear();
                if let Some(restoring) = &mut self.restoring {
                    restoring.clear();
                }
                if let Some(keeper) = &mut self.keeper {
                    keeper.clear();
                }
            }
            ToRecorder::ExportLog => self.make(Export::Log),
            ToRecorder::ExportTelemetry => self.make(Export::Telemetry),
            ToRecorder::CancelExport => {
                for file in std::mem::take(&mut self.files) {
                    self.no_file(file.what(), true);
                }
            }
            ToRecorder::Record(on) => {
                let anew = self.recording.record(on);
                if let Some(keeper) = &mut self.keeper {
                    keeper.record(on, anew);
                }
            }
            ToRecorder::Erase => self.erase(),
            // They are about files, and for the caller: see `Self::restore`.
            ToRecorder::Restore | ToRecorder::Forget => {}
        }
    }

    fn set_epoch(&mut self, clock: WallClock) {
        let epoch_us = clock.zero_us();
        if let Some(keeper) = &mut self.keeper {
            keeper.set_epoch(epoch_us);
        }
        if self.timeline.has_runs() {
            self.timeline.begin(epoch_us);
        } else {
            self.log.set_clock(clock);
        }
        self.epoch_us = Some(epoch_us);
    }

    /// Begins a file, unless such a one is being made.
    fn make(&mut self, what: Export) {
        if self.files.iter().any(|file| file.what() == what) {
            return;
        }
        if self.restoring.is_some() && self.files.is_empty() {
            self.put_off.push(what);
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
        let message = FromRecorder::NotExported { what, cancelled };
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
            return Output::Tell(FromRecorder::Log(self.log.page(window)));
        }
        let status = self.recording.status();
        let status_due = due(now, self.status_told, STATUS_PERIOD);
        if status != self.status && status_due <= now {
            self.status = status;
            self.status_told = Some(now);
            return Output::Tell(FromRecorder::Recording(status));
        }
        if let Some(progress) = self.progress(now) {
            return Output::Tell(progress);
        }
        if let Some(act) = self.keeper.as_mut().and_then(|keeper| keeper.poll(now)) {
            return Output::Keep(act);
        }
        if !self.log.is_filtered() || self.past.is_some() || !self.files.is_empty() {
            return Output::Work;
        }
        // Before the epoch is known, nothing of this session has a time.
        let restoring = self.restoring.as_mut().filter(|_| self.epoch_us.is_some());
        match restoring.map(|restoring| restoring.wants()) {
            Some(Wants::File) => return Output::NextKept,
            Some(Wants::Work) => return Output::Work,
            Some(Wants::Nothing) | None => {}
        }
        let page_due = (self.page_changed && self.window.is_some()).then_some(page_due);
        let status_due = (status != self.status).then_some(status_due);
        let keep_due = self.keeper.as_ref().and_then(Keeper::due);
        let dues = [page_due, status_due, keep_due];
        Output::Wait(dues.into_iter().flatten().min())
    }

    fn progress(&mut self, now: Instant) -> Option<FromRecorder> {
        let file = self.files.front()?;
        (due(now, self.progress_told, PROGRESS_PERIOD) <= now).then(|| {
            self.progress_told = Some(now);
            FromRecorder::Exporting {
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
        if let Some(past) = &mut self.past {
            match past.next(&self.recording) {
                Some(samples) => self.outgoing.push_back(Output::Tell(samples)),
                None => self.past = None,
            }
            return;
        }
        let Some(file) = self.files.front_mut() else {
            if let Some(restoring) = &mut self.restoring
                && restoring.advance(&mut self.log, &self.recording, self.epoch_us, entries)
            {
                self.finish_restoring();
            }
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
            if let Some(keeper) = &mut self.keeper
                && self.recording.status().exported
            {
                keeper.exported();
            }
        }
        let mut name = String::from(match what {
            Export::Log => "motorlink-log-",
            Export::Telemetry => "motorlink-telemetry-",
        });
        self.own_clock.push_file_stamp(&mut name, now);
        name.push_str(".csv");
        let rows = file.rows();
        self.outgoing
            .push_back(Output::File(FromRecorder::Exported { what, name, rows }));
        self.progress_told = None;
    }
}

/// When something may be told again.
fn due(now: Instant, told: Option<Instant>, period: Duration) -> Instant {
    told.map_or(now, |told| told + period)
}
