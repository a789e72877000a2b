//! The commands `info` and `check`.

use std::io;

use motorlink_recorder::push_iso;
use motorlink_session::{Overview, Problem, Problems, Source, What, for_each_record, overview};

use crate::{
    failure::{DONE, Failure, NOT_DONE},
    output::print,
    session::file::{self, Opened},
};

/// Prints the content of a file by its index.
pub fn info(opened: &mut Opened) -> Result<u8, Failure> {
    let name = opened.name.clone();
    let io = |error: io::Error| file::Failure::Io(name.clone(), error);
    let (overview, read) = overview(&mut opened.bytes, &opened.session).map_err(io)?;
    print(format_args!(
        "file        {}, {} bytes",
        opened.name,
        opened.bytes.len()
    ))?;
    for (key, value) in opened.session.about() {
        print(format_args!("{key:11} {}", one_line(value)))?;
    }
    print_overview(&overview)?;
    print(format_args!("chunks      {}", opened.session.chunks()))?;
    for attachment in opened.session.attachments() {
        let size = attachment.size;
        print(format_args!(
            "attachment  {}, {size} bytes",
            one_line(&attachment.name)
        ))?;
    }
    print_problems(&opened.problems().and(&read))?;
    Ok(DONE)
}

fn print_overview(overview: &Overview) -> Result<(), Failure> {
    if let Some((from_ns, to_ns)) = overview.span_ns() {
        print(format_args!("from        {}", iso(from_ns)))?;
        print(format_args!("to          {}", iso(to_ns)))?;
        print(format_args!(
            "duration    {:.3} s",
            overview.duration().as_secs_f64()
        ))?;
    }
    print(format_args!(
        "frames      {} sent, {} received",
        overview.sent, overview.received
    ))?;
    print(format_args!(
        "faulty      {} lost, {} pieces of invalid bytes, {} not sent",
        overview.lost, overview.junk, overview.not_sent
    ))?;
    print(format_args!(
        "events      {}",
        overview.marks().len() as u64 + overview.marks_left_out
    ))?;
    for (id, motor) in overview.motors() {
        let extent = motor.extent().map_or_else(String::new, |extent| {
            let current = extent
                .current
                .map(|(least, most)| format!(", {least} to {most}"));
            let (least, most) = extent.speed;
            format!(", {least} to {most}{}", current.unwrap_or_default())
        });
        let (id, replies, lost) = (id.get(), motor.replies, motor.lost);
        print(format_args!(
            "motor {id:<5} {replies} replies, {lost} lost{extent}, faults: {}",
            motor.faults
        ))?;
    }
    Ok(())
}

/// Each is a line.
fn print_problems(problems: &Problems) -> Result<(), Failure> {
    if problems.is_empty() {
        return Ok(());
    }
    print(problems.to_string().trim_end())
}

/// Reads every record and prints the problems.
pub fn check(opened: &mut Opened) -> Result<u8, Failure> {
    let name = opened.name.clone();
    let (mut lines, mut events, mut states) = (0_u64, 0_u64, 0_u64);
    let read = for_each_record(&mut opened.bytes, &opened.session, |record| {
        match record.what {
            What::Line(_) => lines += 1,
            What::Event(_) => events += 1,
            What::State(_) => states += 1,
        }
    });
    let read = read.map_err(|error| file::Failure::Io(name, error))?;
    print(format_args!(
        "{lines} entries of the line, {events} events and {states} states of the page read"
    ))?;
    let problems = opened.problems().and(&read);
    if problems.is_empty() {
        print(format_args!("no damage found"))?;
    }
    print_problems(&problems)?;
    Ok(exit_code(&problems))
}

/// Exit code 1 if something is missing or damaged. Times without a date are as they were written.
pub fn exit_code(problems: &Problems) -> u8 {
    let mut missing = problems
        .iter()
        .filter(|(problem, _)| *problem != Problem::NoDate);
    missing.next().map_or(DONE, |_| NOT_DONE)
}

fn iso(ns: u64) -> String {
    let mut text = String::new();
    push_iso(&mut text, i64::try_from(ns / 1_000).unwrap_or_default());
    text
}

/// A text of the file without control characters, which a terminal would execute.
pub fn one_line(text: &str) -> String {
    let harmless = text.chars().filter(|letter| !letter.is_control());
    harmless.take(600).collect()
}
