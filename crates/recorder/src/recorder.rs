//! The recorder: messages and line events go in, messages and parts of files come out.

use std::{collections::VecDeque, time::Duration};

use motorlink_bus::LineEvent;
use motorlink_i18n::Language;
use motorlink_messages::{
    recorder::{Export, Filter, FromRecorder, RecordingStatus, ToRecorder, Window},
    sessions::{Kept, NotSaved, SaveRange},
    stored_state,
};
use motorlink_protocol::Instant;

use crate::{
    csv_file::CsvFile,
    kept::KeptReader,
    local_time::LocalTime,
    log::Log,
    recording::{Recording, Sample},
    restoring::{Need, Past, Restoring},
    saved::{Segment, SessionWriter, StoreAction, Stream, Summary, Timeline},
    states::State,
    wall_clock::WallClock,
};

/// A page of the log is sent at most 30 times a second.
const PAGE_PERIOD: Duration = Duration::from_micros(33_400);
/// The state of the recording is sent at most five times a second.
const STATUS_PERIOD: Duration = Duration::from_millis(200);
/// The progress of an export is sent ten times a second, so that the bar moves smoothly.
const PROGRESS_PERIOD: Duration = Duration::from_millis(100);

/// Bytes of a part of a file: a full log has about fifty parts, each copied in a millisecond.
const PART: usize = 2 << 20;

/// What the caller of the recorder has to do next.
#[derive(Debug)]
pub enum Output {
    /// Post a message to the page.
    Post(FromRecorder),
    /// Append this part to the file that is being written.
    Part(Vec<u8>),
    /// The file is complete: post it to the page with this message.
    File(FromRecorder),
    /// Discard the parts, and post this message.
    NoFile(FromRecorder),
    /// Do this with the files of the saved session.
    Store(StoreAction),
    /// Read the next file of the restored session: see [`Recorder::restore`].
    NextFile,
    /// Call [`Recorder::work`]. Receive messages in between.
    Work,
    /// Wait for input, at most until this time.
    Wait(Option<Instant>),
}

/// The packet log, the recording, and the requests of the page.
///
/// There are two clocks. Line events and messages have the time of the port worker; `now` is the caller's
/// time and decides only when to post again.
#[derive(Debug)]
pub struct Recorder {
    log: Log,
    recording: Recording,
    /// The caller's clock.
    own_clock: WallClock,
    window: Option<Window>,
    page_changed: bool,
    page_sent_at: Option<Instant>,
    status: RecordingStatus,
    status_sent_at: Option<Instant>,
    /// Converts the times of inputs to the clock of the log.
    timeline: Timeline,
    /// The epoch of the times of inputs, in microseconds since 1970.
    epoch_us: Option<i64>,
    filter: Filter,
    /// Writes the saved session; `None` if it is not saved.
    writer: Option<SessionWriter>,
    restoring: Option<Box<Restoring>>,
    /// Restored samples that the page does not have yet.
    past: Option<Past>,
    /// Exports that were requested while a session is being restored.
    postponed_exports: Vec<Export>,
    /// The requested files; the first is being written.
    files: VecDeque<CsvFile>,
    progress_sent_at: Option<Instant>,
    /// Reads what is kept, for a session file.
    kept: Option<KeptReader>,
    /// Outputs that are due at once.
    outgoing: VecDeque<Output>,
}

impl Recorder {
    /// An empty recorder. `own_clock` is the clock of `now` in all other calls.
    #[must_use]
    pub fn new(own_clock: WallClock) -> Self {
        Self::with(own_clock, Log::default(), Recording::default())
    }

    /// A recorder with this log and recording.
    #[must_use]
    pub fn with(own_clock: WallClock, log: Log, recording: Recording) -> Self {
        Self {
            log,
            recording,
            own_clock,
            window: None,
            page_changed: false,
            page_sent_at: None,
            status: RecordingStatus::default(),
            status_sent_at: None,
            timeline: Timeline::default(),
            epoch_us: None,
            filter: Filter::default(),
            writer: None,
            restoring: None,
            past: None,
            postponed_exports: Vec::new(),
            files: VecDeque::new(),
            progress_sent_at: None,
            kept: None,
            outgoing: VecDeque::new(),
        }
    }

    /// Sets the local time for the log and for file names. It has to be valid from [`Self::begins_ms`] on, or
    /// from the beginning of the session to restore.
    pub const fn set_local_time(&mut self, local_time: LocalTime) {
        self.own_clock = self.own_clock.with_local_time(local_time);
        self.log
            .set_clock(self.log.clock().with_local_time(local_time));
    }

    /// The zero of the log's clock, in milliseconds since 1970; `None` before its epoch is known.
    #[must_use]
    pub fn begins_ms(&self) -> Option<i64> {
        let zero_us = self.log.clock().zero_us();
        self.epoch_us.map(|_| zero_us / 1_000)
    }

    /// The same recorder, but it saves the session: see [`Output::Store`].
    #[must_use]
    pub fn saving(mut self) -> Self {
        self.writer = Some(SessionWriter::default());
        self
    }

    /// Stops saving the session.
    pub fn stop_saving(&mut self) {
        self.writer = None;
    }

    /// Whether it saves the session.
    #[must_use]
    pub const fn is_saving(&self) -> bool {
        self.writer.is_some()
    }

    /// Adds a line event.
    pub fn add_event(&mut self, traffic: &LineEvent) {
        let at = self.timeline.at(traffic.at);
        let placed = LineEvent { at, ..*traffic };
        self.log.add_event(&placed);
        let recorded = self.recording.add(&placed);
        if let Some(writer) = &mut self.writer {
            if let Some(sample) = recorded {
                let at = traffic.at;
                writer.mark(&Sample { at, ..sample });
            }
            writer.add_event(traffic, recorded.is_some());
        }
        self.page_changed = true;
    }

    /// Adds what the page shows from now on: the bytes of an update to it.
    pub fn add_state(&mut self, update: Vec<u8>) {
        let Some((at, stored)) = stored_state::of_message(update) else {
            return;
        };
        if let Some(writer) = &mut self.writer {
            writer.add_state(at, &stored);
        }
        let at = self.timeline.at(at);
        self.log.add_state(State { at, stored });
    }

    /// Restores the session in these files, which are in order, with their sizes. Requests them one after the
    /// other by [`Output::NextFile`]; the caller answers with [`Recorder::next_file`]. The recorder works as
    /// usual meanwhile. The files of this session continue after them.
    #[inline(never)]
    pub fn restore(&mut self, summary: &Summary, files: &[(Segment, usize)]) {
        if self.restoring.is_some() {
            return;
        }
        if let Some(writer) = &mut self.writer {
            writer.adopt(files);
        }
        let clock = WallClock::from_us(summary.first_epoch_us(), self.own_clock.local_time());
        self.restoring = Some(Box::new(Restoring::new(clock, &self.log, &self.recording)));
    }

    /// The requested file; `None` when there are no more.
    pub fn next_file(&mut self, file: Option<(Stream, Vec<u8>)>) {
        if let Some(restoring) = &mut self.restoring {
            restoring.take(file);
        }
    }

    /// Replaces this session by the restored one, followed by this one.
    #[inline(never)]
    fn finish_restoring(&mut self) {
        let Some(restoring) = self.restoring.take() else {
            return;
        };
        let past;
        (self.log, self.recording, self.timeline, past) =
            restoring.finish(&mut self.log, &self.recording, &self.filter);
        self.past = Some(past);
        self.kept = None;
        self.page_changed = true;
        self.outgoing
            .push_back(Output::Post(FromRecorder::Restored));
        for what in std::mem::take(&mut self.postponed_exports) {
            self.begin_export(what);
        }
    }

    /// Clears log and recording, and removes all saved sessions.
    #[inline(never)]
    fn erase(&mut self) {
        if let Some(writer) = &mut self.writer {
            writer.erase();
        }
        self.restoring = None;
        self.past = None;
        self.postponed_exports.clear();
        self.cancel_exports();
        self.kept = None;
        self.log.clear();
        self.log.forget_cleared();
        self.recording = Recording::with_capacity(self.recording.capacity());
    }

    /// Handles a message of the page.
    pub fn handle(&mut self, message: ToRecorder) {
        self.page_changed |= !matches!(
            message,
            ToRecorder::Export(_) | ToRecorder::CancelExport | ToRecorder::Record(_)
        );
        match message {
            ToRecorder::Epoch { unix_ms } => {
                let clock = WallClock::new(unix_ms, 0);
                self.set_epoch(clock.with_local_time(self.own_clock.local_time()));
            }
            ToRecorder::AddMessage { at, error, text } => {
                self.log.add_message(self.timeline.at(at), error, &text);
                if let Some(writer) = &mut self.writer {
                    writer.add_message(at, error, &text);
                }
            }
            ToRecorder::Show(window) => self.window = Some(window),
            ToRecorder::SetLanguage { language, texts } => {
                let language = Language::from_tag(&language).unwrap_or_default();
                if let Some(texts) = texts {
                    // Texts of another version are refused; the rows stay in English then.
                    let _ = motorlink_i18n::load_texts(language, texts);
                }
                motorlink_i18n::set_language(language);
                // In the new language, the search may match other entries.
                self.log.filter(&self.filter);
            }
            ToRecorder::Filter(filter) => {
                self.log.filter(&filter);
                self.filter = filter;
            }
            ToRecorder::Toggle(row) => self.log.toggle(row),
            ToRecorder::Clear => {
                self.log.clear();
                // The file would end in the middle.
                self.kept = None;
                if let Some(restoring) = &mut self.restoring {
                    restoring.clear();
                }
                if let Some(writer) = &mut self.writer {
                    writer.clear();
                }
            }
            // A restored session is followed by the log as it is.
            ToRecorder::EndClear { undo: true } if self.restoring.is_none() => {
                // Entries get other numbers.
                self.cancel_exports();
                self.kept = None;
                if self.log.undo_clear(&self.filter)
                    && let Some(writer) = &mut self.writer
                {
                    writer.undo_clear();
                }
            }
            ToRecorder::EndClear { .. } => self.log.forget_cleared(),
            ToRecorder::Export(what) => self.begin_export(what),
            ToRecorder::CancelExport => self.cancel_exports(),
            ToRecorder::Record(on) => {
                let restarted = self.recording.record(on);
                if let Some(writer) = &mut self.writer {
                    writer.record(on, restarted);
                }
            }
            ToRecorder::Erase => self.erase(),
            // The caller handles them: see `Self::restore`.
            ToRecorder::Restore | ToRecorder::Forget => {}
        }
    }

    fn set_epoch(&mut self, clock: WallClock) {
        let epoch_us = clock.zero_us();
        if let Some(writer) = &mut self.writer {
            writer.set_epoch(epoch_us);
        }
        if self.timeline.has_runs() {
            self.timeline.begin(epoch_us);
        } else {
            self.log.set_clock(clock);
        }
        self.epoch_us = Some(epoch_us);
    }

    /// Begins an export, unless one of the same kind is in progress.
    fn begin_export(&mut self, what: Export) {
        if self.files.iter().any(|file| file.what() == what) {
            return;
        }
        if self.restoring.is_some() && self.files.is_empty() {
            self.postponed_exports.push(what);
            return;
        }
        let line = self.log.states().lines.span(false);
        let file = match what {
            Export::Log => CsvFile::of_log(&mut self.log),
            Export::Telemetry => CsvFile::of_telemetry(&self.recording, &line),
            Export::Plot => CsvFile::of_plot(&self.recording, &line),
        };
        if file.rows_in_all() == 0 {
            self.no_file(what, false);
        } else {
            self.files.push_back(file);
        }
    }

    fn cancel_exports(&mut self) {
        for file in std::mem::take(&mut self.files) {
            self.no_file(file.what(), true);
        }
    }

    fn no_file(&mut self, what: Export, cancelled: bool) {
        let message = FromRecorder::NotExported { what, cancelled };
        self.outgoing.push_back(Output::NoFile(message));
    }

    /// Why nothing that is kept can be saved now.
    #[must_use]
    pub fn not_kept(&self) -> Option<NotSaved> {
        if self.restoring.is_some() {
            return Some(NotSaved::Restoring);
        }
        let is_empty = self.log.entries().len() == 0 && self.recording.is_empty();
        is_empty.then_some(NotSaved::Nothing)
    }

    /// The first part of what is kept now of a line, of at most this number of entries and samples.
    pub fn first_kept(&mut self, range: SaveRange, most: u64) -> Kept {
        if self.restoring.is_none() {
            self.kept = Some(KeptReader::new(&mut self.log, &self.recording, range));
        }
        self.next_kept(most)
    }

    /// The next part, of at most this number of entries and samples.
    pub fn next_kept(&mut self, most: u64) -> Kept {
        if self.restoring.is_some() {
            return Kept::Restoring;
        }
        let Some(reader) = &mut self.kept else {
            return Kept::Changed;
        };
        let mut records = Vec::new();
        let is_last = !reader.read(&self.log, &self.recording, most, &mut records);
        let progress = reader.progress();
        if is_last {
            self.kept = None;
        }
        Kept::Part {
            zero_us: self.log.clock().zero_us(),
            progress,
            records,
            is_last,
        }
    }

    /// What to do next. Call it until it returns [`Output::Wait`].
    pub fn poll(&mut self, now: Instant) -> Output {
        if let Some(output) = self.outgoing.pop_front() {
            return output;
        }
        let page_due = due(now, self.page_sent_at, PAGE_PERIOD);
        if self.page_changed
            && page_due <= now
            && let Some(window) = self.window
        {
            self.page_changed = false;
            self.page_sent_at = Some(now);
            return Output::Post(FromRecorder::Log(self.log.page(window)));
        }
        let status = self.recording.status();
        let status_due = due(now, self.status_sent_at, STATUS_PERIOD);
        if status != self.status && status_due <= now {
            self.status = status;
            self.status_sent_at = Some(now);
            return Output::Post(FromRecorder::Recording(status));
        }
        if let Some(progress) = self.progress(now) {
            return Output::Post(progress);
        }
        if let Some(action) = self.writer.as_mut().and_then(|writer| writer.poll(now)) {
            return Output::Store(action);
        }
        if !self.log.is_filtered() || self.past.is_some() || !self.files.is_empty() {
            return Output::Work;
        }
        // Before the epoch is known, the times of this session are not.
        let restoring = self.restoring.as_mut().filter(|_| self.epoch_us.is_some());
        match restoring.map(|restoring| restoring.need()) {
            Some(Need::File) => return Output::NextFile,
            Some(Need::Work) => return Output::Work,
            Some(Need::Nothing) | None => {}
        }
        let page_due = (self.page_changed && self.window.is_some()).then_some(page_due);
        let status_due = (status != self.status).then_some(status_due);
        let keep_due = self.writer.as_ref().and_then(SessionWriter::due);
        let dues = [page_due, status_due, keep_due];
        Output::Wait(dues.into_iter().flatten().min())
    }

    fn progress(&mut self, now: Instant) -> Option<FromRecorder> {
        let file = self.files.front()?;
        (due(now, self.progress_sent_at, PROGRESS_PERIOD) <= now).then(|| {
            self.progress_sent_at = Some(now);
            FromRecorder::Exporting {
                what: file.what(),
                done: file.rows(),
                of: file.rows_in_all(),
            }
        })
    }

    /// Continues the long tasks: filters this number of entries, or writes this number of lines. `now` is
    /// for the name of a completed file.
    pub fn work(&mut self, now: Instant, entries: u64) {
        // Rows first, because the user is looking at them.
        if !self.log.is_filtered() {
            self.log.advance(entries);
            self.page_changed = true;
            return;
        }
        if let Some(past) = &mut self.past {
            match past.next(&self.recording) {
                Some(samples) => self.outgoing.push_back(Output::Post(samples)),
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
        // All entries may have been cleared meanwhile.
        if file.rows() == 0 {
            return self.no_file(what, false);
        }
        if let Some(until) = file.recorded_until() {
            self.recording.exported(until);
            if let Some(writer) = &mut self.writer
                && self.recording.status().exported
            {
                writer.exported();
            }
        }
        let mut name = String::from(match what {
            Export::Log => "motorlink-log-",
            Export::Telemetry => "motorlink-telemetry-",
            Export::Plot => "motorlink-plot-",
        });
        self.own_clock.push_file_stamp(&mut name, now);
        name.push_str(".csv");
        let rows = file.rows();
        self.outgoing
            .push_back(Output::File(FromRecorder::Exported { what, name, rows }));
        self.progress_sent_at = None;
    }
}

/// When something may be told again.
fn due(now: Instant, told: Option<Instant>, period: Duration) -> Instant {
    told.map_or(now, |told| told + period)
}
