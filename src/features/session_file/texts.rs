//! The texts of session files.

use motorlink_i18n::tr;
use motorlink_messages::sessions::{
    NotASession, NotSaved, Problem, RunsKept, RunsSaved, SaveRange, SessionExport,
};

use crate::{
    features::session_file::bookmarks::BOOKMARKS_MAX,
    model::recorder_texts::no_recorder,
    ui::format::{grouped, in_language},
};

/// A session was saved under this name.
pub(super) fn of_saved(name: &str, bytes: u64, records: u64) -> String {
    tr!(
        "Saved {name}: {size}, {records} records",
        name,
        size = size(bytes),
        records = grouped(records)
    )
}

/// How much is saved.
pub(super) fn of_save_range(range: SaveRange) -> &'static str {
    match range {
        SaveRange::Line => tr!("All of this line"),
        SaveRange::Last(_) => tr!("Last 10 minutes"),
        SaveRange::Recording => tr!("The recording"),
        SaveRange::LineBefore => tr!("The line before"),
    }
}

/// The runs of experiments in a saved session.
pub(super) fn of_runs_saved(runs: RunsSaved) -> Vec<String> {
    let mut words = Vec::new();
    if runs.saved > 0 {
        words.push(tr!("Runs of experiments: {count}", count = runs.saved));
    }
    if runs.is_incomplete {
        words.push(
            tr!(
                "Runs of experiments or parts of them are missing: this browser could not store or read them."
            )
            .to_owned(),
        );
    }
    words
}

/// What became of the runs of experiments in an open file, and whether it is an error.
pub(super) fn of_runs_kept(kept: Option<RunsKept>) -> (bool, String) {
    let Some(kept) = kept else {
        let words = tr!("Not kept: this browser stores no runs now.");
        return (true, words.to_owned());
    };
    let mut words = Vec::new();
    let mut add = |count: u32, text: &dyn Fn(u32) -> String| {
        if count > 0 {
            words.push(text(count));
        }
    };
    add(kept.added, &|count| {
        tr!("Runs added to the tab Runs of Experiments: {count}.", count)
    });
    add(kept.known, &|count| {
        tr!("Runs already in the list: {count}.", count)
    });
    add(kept.unreadable, &|count| {
        tr!(
            "Runs that cannot be read (damaged, or from a later version): {count}.",
            count
        )
    });
    add(kept.no_room, &|count| {
        tr!(
            "Runs not kept because the list is full: {count}. Delete some in Experiments, then try again.",
            count
        )
    });
    add(kept.not_stored, &|count| {
        tr!("Runs that this browser could not store: {count}.", count)
    });
    let failed = kept.unreadable + kept.no_room + kept.not_stored;
    (failed > 0, words.join(" "))
}

/// Why there is no room for another bookmark.
pub(super) fn bookmarks_full() -> String {
    tr!(
        "A file has at most {count} bookmarks. Delete one first.",
        count = grouped(BOOKMARKS_MAX as u64)
    )
}

/// Why no session was saved.
pub(super) fn of_not_saved(why: NotSaved) -> &'static str {
    match why {
        NotSaved::Nothing => tr!("Nothing to save yet. Connect a motor."),
        NotSaved::Restoring => {
            tr!("Not saved: the previous session is being restored. Save again in a few seconds.")
        }
        NotSaved::Changed => tr!("Not saved: the packet log was changed meanwhile. Save again."),
        NotSaved::Cancelled => tr!("Saving cancelled"),
        NotSaved::NoRoom => tr!("Not saved: the disk is full. Free some space, then save again."),
        NotSaved::Failed => tr!("Not saved: the file cannot be written. Choose another folder."),
        NotSaved::NoRecorder => no_recorder(),
    }
}

/// The browser cannot store what is made of an open file.
pub(super) fn no_room() -> &'static str {
    tr!("The disk is full. Free some space, then try again.")
}

/// Why a file was not opened.
pub(super) fn of_not_opened(why: Option<NotASession>) -> &'static str {
    match why {
        Some(NotASession::Empty) => tr!("The file is empty. Choose another file."),
        Some(NotASession::Zip) => {
            tr!("This is a ZIP archive. Unpack it, then open the file that was in it.")
        }
        Some(NotASession::NewerContainer) => {
            tr!("This MCAP file has a later version of the format. Update MotorLink to open it.")
        }
        Some(NotASession::Text) => tr!(
            "This text file has no columns of a known export. Choose a session (.mcap) or a CSV file of MotorLink."
        ),
        Some(NotASession::Other) => {
            tr!("Not a session file. Choose a session (.mcap) or a CSV file of MotorLink.")
        }
        None => tr!("The file cannot be read. Check that it is still there, then open it again."),
    }
}

/// What is missing in a file, or unreadable.
pub(super) fn of_problem(problem: Problem, times: u64) -> String {
    let text = match problem {
        Problem::NewerVersion => tr!(
            "A later version of MotorLink wrote this file. What this version does not know is left out. Update MotorLink to see it."
        ),
        Problem::NoSession => {
            tr!("This MCAP file has no channel of MotorLink. Open it in Foxglove instead.")
        }
        Problem::Cut => tr!("The end of the file is missing. Everything before it was read."),
        Problem::IndexDamaged => tr!(
            "The index at the end of the file is damaged. The file was read from its start instead."
        ),
        Problem::RecordDamaged => tr!(
            "The file is damaged in the middle, and its index is missing. What lies behind the damage could not be read."
        ),
        Problem::TooManyChunks => {
            tr!("The file has more parts than can be read. Only the first ones were read.")
        }
        Problem::ChunkDamaged => tr!("A part of the file is damaged and was left out."),
        Problem::CompressionUnknown => tr!(
            "A part of the file has a compression that MotorLink does not read. Convert the file with: mcap compress --compression lz4"
        ),
        Problem::MessageDamaged => tr!("A message could not be read and was left out."),
        Problem::AttachmentDamaged => tr!("An attached file is damaged and was left out."),
        Problem::LineDamaged => tr!("A line of the CSV file could not be read and was left out."),
        Problem::NoDate => {
            tr!("The file has times of day without a date. They are shown as of 1 January 1970.")
        }
        Problem::TimeLost => tr!(
            "The time of a line of the CSV file could not be read, or has no date, and the line was left out. A spreadsheet program can change times: open the file as it was exported."
        ),
    };
    if times > 1 {
        tr!("{text} ({times} times)", text, times = grouped(times))
    } else {
        text.to_owned()
    }
}

/// The name of an exported file, by the name of the session.
pub(super) fn export_name(what: SessionExport, session: &str) -> String {
    let stem = session.rsplit_once('.').map_or(session, |(stem, _)| stem);
    let ending = match what {
        SessionExport::Log => "-log.csv",
        SessionExport::Plot => "-plot.csv",
        SessionExport::Report => "-report.html",
        SessionExport::Copy => "-bookmarks.mcap",
    };
    [stem, ending].concat()
}

/// `12.3 MB`
pub(super) fn size(bytes: u64) -> String {
    let (unit, tenths) = match bytes {
        0..1_000_000 => ("kB", bytes.div_ceil(100)),
        _ => ("MB", bytes.div_ceil(100_000)),
    };
    in_language(format!("{}.{} {unit}", tenths / 10, tenths % 10))
}

/// `2:05.250`: minutes, seconds and milliseconds.
pub(super) fn elapsed(micros: u64) -> String {
    let millis = micros / 1_000;
    let (minutes, seconds) = (millis / 60_000, millis / 1_000 % 60);
    in_language(format!("{minutes}:{seconds:02}.{:03}", millis % 1_000))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_times_are_short() {
        assert_eq!(
            [size(0), size(950), size(12_345_678)],
            ["0.0 kB", "1.0 kB", "12.4 MB"]
        );
        assert_eq!([elapsed(0), elapsed(125_250_999)], ["0:00.000", "2:05.250"]);
    }

    #[test]
    fn an_exported_file_has_the_name_of_its_session() {
        let name = |what| export_name(what, "run.2.mcap");
        assert_eq!(name(SessionExport::Report), "run.2-report.html");
        assert_eq!(name(SessionExport::Log), "run.2-log.csv");
        assert_eq!(export_name(SessionExport::Plot, "run"), "run-plot.csv");
    }

    #[test]
    fn the_page_says_of_a_file_what_the_command_says() {
        for why in [
            NotASession::Empty,
            NotASession::Zip,
            NotASession::NewerContainer,
            NotASession::Text,
            NotASession::Other,
        ] {
            assert_eq!(of_not_opened(Some(why)), why.to_string());
        }
        for problem in [
            Problem::Cut,
            Problem::ChunkDamaged,
            Problem::NoDate,
            Problem::NewerVersion,
        ] {
            assert_eq!(of_problem(problem, 1), problem.to_string());
            assert_eq!(of_problem(problem, 3), format!("{problem} (3 times)"));
        }
    }
}
