//! Exports a session to another file format.

use std::{
    fs::File,
    io::{self, BufWriter, Write},
    path::Path,
};

use motorlink_recorder::Charset;
use motorlink_session::{
    About, Problems, Record, Source, Table, What, Writer, for_each_record, overview, report,
};

use crate::{
    failure::Failure,
    output::say,
    session::{arguments::Format, file::Opened, info::exit_code},
};

/// Bytes per write.
const PIECE: usize = 64 << 10;

/// Writes a session in this format, to a file or the standard output. Exit code 1 if something of it is missing.
pub fn export(opened: &mut Opened, format: Format, out: Option<&Path>) -> Result<u8, Failure> {
    let read = write(opened, format, out).map_err(|error| match out {
        Some(out) => Failure::file(out)(error),
        None => Failure::output(error),
    })?;
    let problems = opened.problems().and(&read);
    if !problems.is_empty() {
        say(problems.to_string().trim_end());
    }
    Ok(exit_code(&problems))
}

/// Returns what could not be read.
fn write(opened: &mut Opened, format: Format, out: Option<&Path>) -> io::Result<Problems> {
    let mut out: Box<dyn Write> = match out {
        Some(path) => Box::new(BufWriter::new(File::create(path)?)),
        None => Box::new(io::stdout().lock()),
    };
    let read = match format {
        Format::Telemetry => table(opened, &mut out, Table::of_telemetry())?,
        Format::Log => {
            let charset = charset(opened)?;
            table(opened, &mut out, Table::of_log(charset))?
        }
        Format::Plot => {
            let (overview, _) = overview(&mut opened.bytes, &opened.session)?;
            table(opened, &mut out, Table::of_plot(&overview))?
        }
        Format::Report => {
            let (overview, read) = overview(&mut opened.bytes, &opened.session)?;
            let problems = opened.problems().and(&read);
            let about = About {
                name: &opened.name,
                problems: &problems,
            };
            out.write_all(report(&overview, about).as_bytes())?;
            read
        }
        Format::Mcap => mcap(opened, &mut out)?,
    };
    out.flush()?;
    Ok(read)
}

/// The character set of a log, by the texts of all events.
fn charset(opened: &mut Opened) -> io::Result<Charset> {
    let mut charset = Charset::default();
    each(opened, |record| {
        if let What::Event(event) = &record.what {
            charset.add(&event.text);
        }
        Ok(())
    })?;
    Ok(charset)
}

fn table(opened: &mut Opened, out: &mut impl Write, mut table: Table) -> io::Result<Problems> {
    let mut lines = Vec::new();
    table.head(&mut lines);
    let read = each(opened, |record| {
        table.record(&mut lines, record);
        pass_on(&mut lines, out)
    })?;
    out.write_all(&lines)?;
    Ok(read)
}

/// Writes the session to a new session file: of a CSV file, or of the readable part of a damaged one. It keeps the
/// setup and the experiment runs.
fn mcap(opened: &mut Opened, out: &mut impl Write) -> io::Result<Problems> {
    let about = opened.session.about().clone();
    let about = about.iter().filter(|(name, _)| *name != "version");
    let about: Vec<(&str, &str)> = about.map(|(n, v)| (n.as_str(), v.as_str())).collect();
    let mut writer = Writer::new(0, &about);
    let mut problems = each(opened, |record| {
        writer.record(record);
        if writer.written() >= PIECE {
            out.write_all(&writer.take())?;
        }
        Ok(())
    })?;
    let attachments: Vec<_> = opened.session.attachments().collect();
    for attachment in attachments {
        let name = &attachment.name;
        let range = opened.session.attachment_range(name);
        let is_made_again = opened.session.overview_range() == range;
        let Some(range) = range.filter(|_| !is_made_again) else {
            continue;
        };
        let bytes = opened.bytes.read(range)?;
        match motorlink_session::Session::attachment(&bytes) {
            Ok(data) => writer.attach(name, &attachment.media_type, data),
            Err(problem) => problems.add(problem),
        }
    }
    out.write_all(&writer.finish())?;
    Ok(problems)
}

/// Passes every record to `write`, up to the first that cannot be written. Returns what could not be read.
fn each(
    opened: &mut Opened,
    mut write: impl FnMut(&Record) -> io::Result<()>,
) -> io::Result<Problems> {
    let mut written = Ok(());
    let read = for_each_record(&mut opened.bytes, &opened.session, |record| {
        if written.is_ok() {
            written = write(&record);
        }
    })?;
    written.map(|()| read)
}

fn pass_on(lines: &mut Vec<u8>, out: &mut impl Write) -> io::Result<()> {
    if lines.len() >= PIECE {
        out.write_all(lines)?;
        lines.clear();
    }
    Ok(())
}
