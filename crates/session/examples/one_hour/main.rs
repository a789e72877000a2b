//! Writes and reads one hour of a motor that is driven 500 times a second, and prints figures as rows of a table:
//! `cargo xtask bench session`.

mod line;
mod page;
mod replaying;
mod saving;

use std::{
    env,
    fs::{self, File},
    io::{self, Read, Seek, SeekFrom, Write},
    ops::Range,
    path::{Path, PathBuf},
    process::Command,
    time::{Duration, Instant},
};

use line::Line;
use motorlink_bus::{LineEvent, LineEventKind};
use motorlink_messages::stored_state;
use motorlink_session::{Cursor, Next, Session, Source, Writer, for_each_record, open, overview};
use page::Page;

const HOUR: &str = "session of one hour at 500 exchanges a second";
const ZERO_US: i64 = 1_795_266_936_962_000;

fn main() -> io::Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    match arguments.as_slice() {
        [saving] if saving == "--saving" => {
            saving::measure();
            Ok(())
        }
        // A process of its own, so that its memory is that of reading alone.
        [read, file, sum] if read == "--read" => read_hour(Path::new(file), sum),
        [write, file] if write == "--write" => write_file(Path::new(file)).map(|_| ()),
        [file] => write_hour(&PathBuf::from(file)),
        _ => {
            let file = env::temp_dir().join(format!("one-hour-{}.mcap", std::process::id()));
            let result = write_hour(&file);
            let removed = fs::remove_file(&file);
            saving::measure();
            result.and(removed)
        }
    }
}

/// FNV-1a over the bytes of every frame, and their number.
#[derive(Debug, Default, PartialEq, Eq)]
struct Sum(u64, u64);

impl Sum {
    fn add(&mut self, kind: &LineEventKind) {
        if let LineEventKind::Sent { frame, .. } | LineEventKind::Received { frame, .. } = kind {
            self.1 += 1;
            for byte in frame.bytes() {
                self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3);
            }
        }
    }
}

/// Writes the file. Returns the sum of its frames, and the time that the writer took.
fn write_file(path: &Path) -> io::Result<(Sum, Duration)> {
    let mut sum = Sum::default();
    let mut file = File::create(path)?;
    let mut writer = Writer::new(ZERO_US, &[("page", "bench")]);
    let mut took = Duration::ZERO;
    let mut events: Vec<(LineEvent, Option<Vec<u8>>)> = Vec::new();
    let mut page = Page::new();
    let mut line = Line::new().map(|event| (event, page.add(&event)));
    loop {
        // The simulator takes longer than the writer, and is not measured.
        events.clear();
        events.extend(line.by_ref().take(10_000));
        if events.is_empty() {
            break;
        }
        for (event, _) in &events {
            sum.add(&event.kind);
        }
        let began = Instant::now();
        for (event, update) in events.drain(..) {
            writer.line(&event);
            if let Some((at, stored)) = update.and_then(stored_state::of_message) {
                writer.state(at, &stored);
            }
        }
        let bytes = writer.take();
        took += began.elapsed();
        file.write_all(&bytes)?;
    }
    let began = Instant::now();
    let last = writer.finish();
    took += began.elapsed();
    file.write_all(&last)?;
    file.sync_all()?;
    Ok((sum, took))
}

fn write_hour(path: &Path) -> io::Result<()> {
    let (sum, took) = write_file(path)?;
    let size = fs::metadata(path)?.len();
    let megabytes = f64::from(u32::try_from(size).unwrap_or(u32::MAX)) / 1e6;
    let frames = sum.1;
    row(
        "file size",
        "under 60 MB",
        &format!("{megabytes:.1} MB, {frames} frames"),
        megabytes < 60.0,
    );
    let limit = Duration::from_secs(10);
    row(
        "computing time of writing it, native",
        "under 10 s",
        &seconds(took),
        took < limit,
    );
    let status = Command::new(env::current_exe()?)
        .arg("--read")
        .arg(path)
        .arg(format!("{sum:?}"))
        .status()?;
    if status.success() {
        Ok(())
    } else {
        Err(io::Error::other("reading failed"))
    }
}

/// A file that is read where it is asked for.
struct OnDisk(File, u64);

impl Source for OnDisk {
    type Error = io::Error;

    fn len(&self) -> u64 {
        self.1
    }

    fn read(&mut self, range: Range<u64>) -> io::Result<Vec<u8>> {
        self.0.seek(SeekFrom::Start(range.start))?;
        let mut bytes = Vec::new();
        (&self.0)
            .take(range.end - range.start)
            .read_to_end(&mut bytes)?;
        Ok(bytes)
    }
}

fn read_hour(path: &Path, sum: &str) -> io::Result<()> {
    let file = File::open(path)?;
    let len = file.metadata()?.len();
    let mut source = OnDisk(file, len);

    let began = Instant::now();
    let session = open(&mut source)?.map_err(io::Error::other)?;
    let opened = began.elapsed();
    row(
        "time to open",
        "at most 3 s",
        &millis(opened),
        opened < Duration::from_secs(3),
    );
    let (whole, _) = overview(&mut source, &session)?;
    let pictured = began.elapsed();
    let buckets = whole
        .motors()
        .map(|(_, motor)| motor.buckets().len())
        .sum::<usize>();
    let measured = format!("{}, {buckets} columns", millis(pictured));
    row(
        "time to the first picture, without drawing",
        "at most 1 s",
        &measured,
        pictured < Duration::from_secs(1),
    );

    let (first, last) = session.span_ns().unwrap_or_default();
    let mut jumps: Vec<Duration> = (0..1_000_u64)
        .map(|n| {
            let at = first + (last - first) / 1_000 * (n * 377 % 1_000);
            let began = Instant::now();
            jump(&mut source, &session, at).map(|()| began.elapsed())
        })
        .collect::<io::Result<_>>()?;
    jumps.sort();
    let (median, worst) = (jumps.get(500), jumps.last());
    let (median, worst) = (
        median.copied().unwrap_or_default(),
        worst.copied().unwrap_or_default(),
    );
    let measured = format!("median {}, worst {} of 1000", millis(median), millis(worst));
    row(
        "a jump anywhere, to its first record",
        "at most 50 ms",
        &measured,
        worst < Duration::from_millis(50),
    );

    replaying::measure(&mut source, &session, &whole)?;

    let began = Instant::now();
    let mut read = Sum::default();
    let problems = for_each_record(&mut source, &session, |record| {
        if let Some(line) = record.line() {
            read.add(&line.kind);
        }
    })?;
    let took = began.elapsed();
    let is_same = format!("{read:?}") == sum && problems.is_empty();
    let measured = format!(
        "{} frames, {}",
        read.1,
        if is_same { "identical" } else { "OTHERS" }
    );
    row(
        "bytes of every frame read against those written",
        "identical",
        &measured,
        is_same,
    );
    println!(
        "| {HOUR}: reading every record, native | | {} | |",
        seconds(took)
    );

    let peak = peak_kilobytes();
    let measured = format!("{} MB", peak / 1_024);
    row(
        "memory of the program that reads it, at most",
        "under 150 MB",
        &measured,
        peak < 150 * 1_024,
    );
    Ok(())
}

/// Reads up to the first record from this moment on.
fn jump(source: &mut OnDisk, session: &Session, at: u64) -> io::Result<()> {
    let mut cursor = Cursor::at(session, at);
    loop {
        match cursor.next(session) {
            Next::Read(range) => cursor.supply(&source.read(range)?),
            Next::Record(_) | Next::End => return Ok(()),
        }
    }
}

/// The most memory that this process has had; Linux only.
fn peak_kilobytes() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let number = line.and_then(|line| line.split_whitespace().next());
    number.and_then(|number| number.parse().ok()).unwrap_or(0)
}

fn row(figure: &str, must: &str, measured: &str, reached: bool) {
    let reached = if reached { "yes" } else { "NO" };
    println!("| {HOUR}: {figure} | {must} | {measured} | {reached} |");
}

fn seconds(time: Duration) -> String {
    format!("{:.2} s", time.as_secs_f64())
}

fn millis(time: Duration) -> String {
    format!("{:.1} ms", time.as_secs_f64() * 1e3)
}
