//! Writes the runs of experiments in a session to files.

use std::{fs, path::Path};

use motorlink_messages::experiments::kept::{record_to_csv, run_to_json};
use motorlink_session::{Session, Source};

use crate::{
    failure::{DONE, Failure, NOT_DONE},
    output::{print, say},
    session::{
        file::{self, Opened},
        info::{exit_code, one_line},
    },
};

/// Writes each run as `run-NUMBER.json` and `run-NUMBER.csv`, and prints its name. Exit code 1 if one is unreadable, or a
/// part of the file is missing.
pub fn write(opened: &mut Opened, folder: &Path) -> Result<u8, Failure> {
    let failed = |error| file::Failure::Io(folder.display().to_string(), error);
    let source = opened.name.clone();
    let unread = |error| file::Failure::Io(source.clone(), error);
    let mut written = Vec::new();
    let problems = opened.problems();
    let mut code = exit_code(&problems);
    if code != DONE {
        say(format_args!(
            "{}: {}",
            opened.name,
            problems.to_string().trim_end()
        ));
    }
    let runs: Vec<_> = opened.session.runs().collect();
    if runs.is_empty() {
        let place = if code == DONE {
            "it"
        } else {
            "the part that was read"
        };
        say(format_args!(
            "{}: no runs of experiments in {place}",
            opened.name
        ));
        return Ok(code);
    }
    fs::create_dir_all(folder).map_err(failed)?;
    for run in runs {
        let name = &run.attachment.name;
        let range = opened.session.attachment_range(name);
        let bytes = range.map(|range| opened.bytes.read(range)).transpose();
        let bytes = bytes.map_err(unread)?.unwrap_or_default();
        let Ok((header, record)) = Session::read_run(&bytes) else {
            say(format_args!("{}: cannot be read", one_line(name)));
            code = NOT_DONE;
            continue;
        };
        // Not the name in the file: that can be a path.
        let mut stem = format!("run-{}", header.number);
        while written.contains(&stem) {
            stem.push_str("-again");
        }
        let path = folder.join(format!("{stem}.json"));
        written.push(stem);
        fs::write(&path, run_to_json(&header, &record)).map_err(failed)?;
        let table = path.with_extension("csv");
        fs::write(&table, record_to_csv(&record)).map_err(failed)?;
        let (path, table) = (path.display(), table.display());
        print(format_args!("{}: {path}, {table}", one_line(&run.name)))?;
    }
    Ok(code)
}
