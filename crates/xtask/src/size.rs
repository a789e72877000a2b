//! The download size of the site, by part.

use std::fmt;
use std::path::PathBuf;

use anyhow::{Context, Result, bail};

/// When a part is fetched: before the page can be used,
const FIRST: &str = "first";
/// before a motor turns (the worker with its bus),
const DRIVING: &str = "to drive";
/// behind the first paint,
const BEHIND: &str = "behind the paint";
/// when a person asks for it,
const ASKED: &str = "when asked for";
/// when the page comes from `motorlink serve`,
const SERVED: &str = "from a server";
/// or in the background, so that the page works without a network.
const OFFLINE: &str = "for offline use";

/// A part of the site: its name, when it is fetched, how the names of its files start, and how much they may weigh
/// compressed with gzip.
type Part = (&'static str, &'static str, &'static [&'static str], usize);

/// Every file belongs to the first part that names it.
const PARTS: [Part; 20] = [
    (
        "page",
        FIRST,
        &[
            "index.html",
            "page-boot-",
            "motorlink-",
            "icon.svg",
            "manifest",
        ],
        // The four models: 4,000 are their ranges, tabs and words. The results of several stops take 100. The glue between
        // the browser and the kept runs takes 700. The first screen takes 400.
        250_500,
    ),
    // 400 are the first screen.
    ("style", FIRST, &["style-"], 9_950),
    // Its bus drives every model (4,300), and its virtual motors have the firmware of each (4,000). 4,300 load the program
    // of the runs into its thread, drive what that asks for as one group, and stop it. 15,000 are for motors that keep their
    // last command: what is remembered and stopped first, the standstill by speed and angle, stops of many motors that
    // alternate, echoes that are no replies, and a port that is slow to open or to close. 800 name text and blocks of bytes,
    // and stop again what a dead line left driven. 100 give each update to the recorder too. 100 widen the
    // reply windows after a late reply.
    ("worker", DRIVING, &["worker-"], 117_400),
    // With the notices and the tour, which were part of the first style, the names of motors, and the panel Session file
    // (700). The sizes of the dial's numbers, narrow cards, and the figures that stay in sight on a phone take 500, the
    // controls of a replay and the setup link 900. 300 fit the panels to German and the screens of a phone. The panel
    // Experiments takes 1,800, bookmarks and the kept run of the graph 300, the alert of a wheel that turns unasked 200.
    // 100 put the legend of the graph beside its plot. 200 lay out a replay in one window, 400 the dock.
    // 500 are the rest of the first screen, and a tour that covers no wheel. 150 keep names, buttons and figures apart in a
    // low window.
    ("later style", BEHIND, &["later-style-"], 18_300),
    // 15,000 of them are the rover from above, 4,000 the loops, the log and the words of four models, 2,300 the dialog for
    // the name and side of a motor. 80: a reply without a current leaves it out of the graph. 2,200 save it as SVG.
    // 4,800 keep a run and draw it under the next one. 8,000 are the alert of a wheel that turns unasked, the worker that
    // takes over from a failed one, the target current in amps, and notices that were part of the first program. 14,100 are the
    // panes of the graph with their fitted axes, the mean with its band, box and value zoom, the second cursor and the marks.
    // 3,300 are the virtual motors to try, the wiring and the recording of the first screen, 3,900 the edge, the title and
    // the tabs of the dock.
    // 1,500 are the group Remote of a page that comes from a server. 300 are names and texts that macros derive.
    // 200: Enter ticks a box while a motor runs, and the focus goes from Run to Pause.
    ("desk", BEHIND, &["desk"], 142_700),
    // 1,600 are the cards of a group. 300 keep a finger that scrolls from driving, and the pad below the limit. 200 find a
    // slow adapter within seconds. 100 say why the virtual motors cannot be connected.
    ("tools", BEHIND, &["tools"], 63_700),
    // The setup of a rover's wheels, and the panels Session file (50,000, of which the replay takes 16,000) and Setup link
    // (7,500). Bookmarks with their form, the list of events and the frame at the cursor take 17,500,
    // of which 3,000 keep a note that is being written, and warn before one is lost. 3,000 show the runs in a file, keep
    // them, and choose how much is saved.
    ("seldom used", ASKED, &["seldom"], 94_200),
    // The panel Experiments: sequences with their table, studies with figures and charts, kept runs with their exports, and
    // programs in four languages. 4,000 keep the table for the next visit and bring a replaced one back, wait until a run is
    // stored, and disarm when a limit changes. 2,600 show the runs that were kept from a file or in another tab.
    // 6,500 are the study of what a motor does when frames cease, and programs that stop from any loop. 19,000 judge whether a
    // step has settled and whether a phase has its turn, offer a hold, export figures, state intervals that hold for
    // correlated noise, read the CSV files of spreadsheets, and describe a robot of any number of wheels. 16,000 say what
    // the line carries, and in the report what it carried, fit models to steps and Bode plots, judge how a motor follows a
    // sequence, compare runs side by side, and open the file for plotting of a recording. 600 are names and texts that
    // macros derive. 600 draw charts in the width of their container.
    ("experiments", ASKED, &["experiments"], 274_200),
    ("help", BEHIND, &["help.", "help-"], 7_600),
    // 31,000 are code of the desk and the tools that the seldom used panels need too, 11,000 of them to read and to apply a
    // setup: the tools are smaller by 20,000. 6,000 are the texts of the desk, which were in the first program, 17,000 what
    // the panel Experiments has in common with the others. The choice of how much is saved takes 900, and
    // 900 read JSON faster. 3,500 are values that a reply may lack. 1,500 hold
    // the wheels and measures of a vehicle, which the export for ROS 2 needs too. 400 are what the round trips of the motors
    // say before a run. 200 find the separators of a CSV file. 700 are the measures of a rover, which a session file needs
    // too. 1,200 are the panes of the graph, of which a picture is saved, 600 the
    // exports of the panel Recording, which is a tool, 200 what a start waits for. 900 say why a motor cannot be driven at
    // once, to the drive pad and to a run.
    // 800 are what the cards of a group have in common with the rover. The last switch of the first program is in Setup now:
    // 700 came from there. 1,700 are the charts that follow the width of their container, of which 1,000 were in the desk.
    ("shared", BEHIND, &["chunk"], 89_100),
    // It opens collapsed frames of the log, keeps a cleared log until that cannot be undone any more, puts the page's
    // messages into the language of their reader, records every model, explains the frames of each (3,500), and gives
    // all that it keeps to the session worker (2,000). 2,300 keep what the page showed, and the loop in which a kept reply is read.
    // 1,500 keep what two lines have carried apart. It knows every English message, to translate those of others: the dock
    // and the first screen take 300. 8,800 are what it exports to the parts of session files and runs, and the
    // glue of all three.
    ("recorder", BEHIND, &["tasks-"], 106_300),
    // It writes and reads session files, converts them, and explains each frame of them in the exported log. A replay
    // takes 24,000: the states of the page, the rows of the packet log, and the player. A copy with bookmarks takes 9,000.
    // The runs of experiments take 39,000: the browser's database, and the runs as JSON and
    // back, with numbers that have a decimal point. 2,000 decompress and read faster: a jump is drawn 5 ms sooner.
    // 14,500 check a run against the steps of its study,
    // thin it by motor and kind, and turn mirrored motors. 2,000 read files without chunks or an index, and CSV files that a
    // spreadsheet program has saved again. 1,900 write study and setup as objects, and refuse rows of motors that a run does
    // not have. 400 are the setup of a file, whose names a replay shows. 9,600 read what the page showed: every state that the
    // port worker sends. 7,700 are the motion of a rover as messages of ROS, with its odometry, and states without the replies
    // that frames tell. 100 read the setpoint that waits for a stop or a switch. Like the recorder it knows every English
    // message: 300. What the recorder needs too (50,000) is in its file, and what runs need too in
    // the next. The folder in which it is compiled changes its size by 300.
    ("session files", ASKED, &["tasks_sessions-"], 152_700),
    // The sequence, the run and its record, as a run and a session file have them.
    ("session and run", ASKED, &["tasks_chunk_"], 42_900),
    // The rest of a run. The port worker loads it when the first run is armed.
    ("runs", ASKED, &["tasks_runs-"], 23_900),
    // The worker of a page that comes from `motorlink serve`, which alone sends it: the WebSocket and the messages.
    ("remote", SERVED, &["remote-"], 39_000),
    (
        "installing",
        OFFLINE,
        &["installed-", "sw.js", "icon-"],
        3_000,
    ),
    (
        "help in English",
        ASKED,
        // Wiring, figures and frames of four models, with an example of each frame.
        &["help/en", "help/wiring"],
        9_200,
    ),
    // 1,200 say in each that a wheel may keep turning, and what to do then. 800 are for figures that do not hold, rates and fitted
    // models. 120 are the switches and marks of the graph, 100 the places,
    // 350 the first screen.
    ("German", ASKED, &["texts-de", "help/de"], 30_000),
    ("Chinese", ASKED, &["texts-zh", "help/zh"], 29_400),
    ("server", ASKED, &["."], 1_000),
];

/// Bound of what is fetched before the page can be used. The sign of a mirrored motor in the log takes 200.
/// The folder in which it is compiled changes its size by 300.
const FIRST_GZIP_BYTES_MAX: usize = 259_400;
/// Bound of what is fetched before the virtual motor turns. The goal is 340,000. The frames of four models in the bus, and
/// the firmware of each in the virtual motors, take 15,000; what the bus does when a motor of separate frames restarts,
/// or another model answers late, takes 2,500; what drives a run beside the bus, and loads its program, takes 4,300; what
/// stops motors that keep their last command takes 16,000, what stops a group before it starts in another loop 1,000, and
/// what tells a motor without replies from one with corrupted replies 100.
/// The folder in which it is compiled changes its size by 300.
const DRIVING_GZIP_BYTES_MAX: usize = 376_700;
/// Bound of all parts together in one language. The goal is 560,000: three programs each bring the code that they
/// share, and the parts of the page each their own seam. The rover from above takes 20,000, the four models
/// 32,000, what the bus does when a motor restarts 2,500, a log that can be undone, opened and translated 10,000, names
/// and sides in every list 3,000, the setup of the wheels 33,000. Session files take 254,000, of which 199,000 are their
/// worker: it is fetched when a session is saved or opened, and for offline use. The graph as SVG, the
/// setup as a link take 9,000. Experiments take 305,000 besides what a run shares with session files: the panel, and the
/// runs; both are fetched when they are used, and for offline use. Bookmarks take 28,000, a kept run in the graph 5,000, the
/// runs of experiments in session files 45,000, the faster reading of files 4,000. Motors that keep their last command
/// take 42,000 in all programs, and figures of experiments that hold up 38,000, with fitted models and rates 56,000. Files of
/// other writers take 2,500, the motion of a rover in session files and lines that are kept apart 12,000. The panes, axes,
/// zoom and marks of the graph take 15,300, the first screen 4,000, the dock 4,400, a group that starts in any loop 1,500,
/// the motor in each title 300. 1,300 are names and texts that macros derive: 500 lines less to read.
/// 1,700 are the cards of a group. The faults of a recording take 2,000, missing replies and legends of runs 700. 600 are
/// what the keyboard reaches, and a slow adapter that is named within seconds.
const ONE_LANGUAGE_GZIP_BYTES_MAX: usize = 1_401_500;

/// The parts of a site with their sizes: raw, with gzip, with brotli.
#[derive(Debug)]
pub struct Report {
    rows: Vec<(&'static Part, [usize; 3])>,
}

/// A file that a visit can fetch, and its size as the host serves it.
#[derive(Debug)]
pub struct Weight {
    pub path: PathBuf,
    /// Raw, with gzip, with brotli.
    pub bytes: [usize; 3],
}

impl Report {
    /// Adds up the files of each part.
    ///
    /// # Errors
    ///
    /// For a file that no part names.
    pub fn new(files: &[Weight]) -> Result<Self> {
        let mut rows: Vec<(&Part, [usize; 3])> = PARTS.iter().map(|part| (part, [0; 3])).collect();
        for Weight { path, bytes } in files {
            let path = path.to_string_lossy();
            let mut rows = rows.iter_mut();
            let (_, sums) = rows
                .find(|((_, _, files, _), _)| files.iter().any(|start| path.starts_with(start)))
                .with_context(|| format!("{path} belongs to no part: add it in size.rs"))?;
            sums.iter_mut()
                .zip(bytes)
                .for_each(|(sum, bytes)| *sum += bytes);
        }
        rows.retain(|(_, [raw, ..])| *raw > 0);
        Ok(Self { rows })
    }

    fn gzip_bytes(&self, counts: impl Fn(&Part) -> bool) -> usize {
        let counted = self.rows.iter().filter(|(part, _)| counts(part));
        counted.map(|(_, [_, gzip, _])| gzip).sum()
    }

    /// The sums that have a bound: name, bytes, bound.
    pub fn sums(&self) -> [(&'static str, usize, usize); 3] {
        let is_first = |part: &Part| part.1 == FIRST;
        let to_drive = |part: &Part| matches!(part.1, FIRST | DRIVING);
        let in_english = |part: &Part| part.1 != SERVED && !matches!(part.0, "German" | "Chinese");
        [
            (
                "before the page can be used",
                self.gzip_bytes(is_first),
                FIRST_GZIP_BYTES_MAX,
            ),
            (
                "before the virtual motor turns",
                self.gzip_bytes(to_drive),
                DRIVING_GZIP_BYTES_MAX,
            ),
            (
                "all parts, one language",
                self.gzip_bytes(in_english),
                ONE_LANGUAGE_GZIP_BYTES_MAX,
            ),
        ]
    }

    /// Fails where a part or a sum is over its budget.
    pub fn check(&self) -> Result<()> {
        let parts = self
            .rows
            .iter()
            .map(|((name, _, _, max), [_, gzip, _])| (*name, *gzip, *max));
        let over: Vec<String> = parts
            .chain(self.sums())
            .filter(|(_, bytes, max)| bytes > max)
            .map(|(name, bytes, max)| format!("{name}: {bytes} of at most {max} bytes"))
            .collect();
        if over.is_empty() {
            return Ok(());
        }
        bail!("over the budget of size.rs:\n{}", over.join("\n"))
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{:16} {:17} {:>9} {:>9} {:>9} {:>9}",
            "part", "fetched", "bytes", "gzip", "brotli", "budget"
        )?;
        for ((name, when, _, max), [raw, gzip, brotli]) in &self.rows {
            writeln!(
                f,
                "{name:16} {when:17} {raw:>9} {gzip:>9} {brotli:>9} {max:>9}"
            )?;
        }
        for (name, bytes, max) in self.sums() {
            writeln!(f, "{name:44} {bytes:>9} {:>9} {max:>9}", "")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(name: &str, bytes: usize) -> Weight {
        Weight {
            path: PathBuf::from(name),
            bytes: [2 * bytes, bytes, bytes],
        }
    }

    #[test]
    fn each_file_counts_in_its_part() {
        let files = [
            file("index.html", 1),
            file("motorlink-0123456789ab.wasm", 2),
            file("worker-0123456789ab.wasm", 4),
            file("desk-0123456789ab.wasm", 8),
            file("texts-de-0123456789ab.txt", 16),
        ];
        let report = Report::new(&files).unwrap();
        let bytes = report.sums().map(|(_, bytes, _)| bytes);
        assert_eq!(bytes, [1 + 2, 1 + 2 + 4, 1 + 2 + 4 + 8]);
    }

    #[test]
    fn a_file_of_no_part_is_an_error() {
        assert!(Report::new(&[file("strange.js", 1)]).is_err());
    }

    #[test]
    fn a_part_over_its_budget_is_an_error() {
        let report = Report::new(&[file("desk-0123456789ab.wasm", 200_000)]).unwrap();
        let error = report.check().unwrap_err().to_string();
        assert!(error.contains("desk: "), "{error}");
    }
}
