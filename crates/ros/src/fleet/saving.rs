//! The session files of a robot: listed, and saved on this computer.

use std::{
    io::Write as _,
    path::{Path, PathBuf},
    time::Duration,
};

use anyhow::{Context as _, Result, anyhow, bail, ensure};
use tempfile::NamedTempFile;
use zenoh::{
    Session, Wait as _,
    qos::Priority,
    query::{ConsolidationMode, QueryTarget},
};

use super::{
    names::{RobotName, is_file},
    sessions::{FILES_MAX, LIST_MAX, PIECE_MAX, SessionFile},
};

/// A list takes 8 s at 1 Mbit/s.
const ANSWER_MAX: Duration = Duration::from_secs(20);

/// `motorlink serve --log` begins a new file at 64 MB. A person may record for longer.
const FILE_MAX: u64 = 4_000_000_000;

/// The session files of a robot, by name.
pub fn list(session: &Session, robot: &RobotName) -> Result<Vec<SessionFile>> {
    let bytes = ask(session, robot, &robot.sessions_key(), LIST_MAX)?;
    let files: Option<Vec<SessionFile>> = serde_json::from_slice(&bytes).ok();
    let files = files
        .filter(|files| files.len() <= FILES_MAX && files.iter().all(|file| is_file(&file.name)));
    files.with_context(|| format!("{robot} answers with no list of session files"))
}

/// Saves a file as it is now. Returns where, and its size.
pub fn save(
    session: &Session,
    robot: &RobotName,
    file: &str,
    to: Option<PathBuf>,
) -> Result<(PathBuf, u64)> {
    ensure!(is_file(file), "{file:?} is no name of a session file");
    let to = to.unwrap_or_else(|| PathBuf::from(file));
    let exists = || format!("{} exists: name another file with --to", to.display());
    ensure!(!to.exists(), exists());
    let files = list(session, robot)?;
    let listed = files.iter().find(|listed| listed.name == file);
    let size = listed
        .with_context(|| format!("{robot} has no session {file}"))?
        .bytes;
    ensure!(
        size <= FILE_MAX,
        "{file} has {size} bytes: no session file is so long"
    );
    let folder = to.parent().filter(|folder| *folder != Path::new(""));
    let folder = folder.unwrap_or(Path::new("."));
    // A half file has another name.
    let mut half =
        NamedTempFile::new_in(folder).with_context(|| format!("{}", folder.display()))?;
    let mut from = 0;
    while from < size {
        let key = format!("{}/{file}?from={from}", robot.sessions_key());
        let mut piece = ask(session, robot, &key, PIECE_MAX)?;
        let rest = PIECE_MAX.min(size - from);
        ensure!(
            u64::try_from(piece.len())? >= rest,
            "{robot} has less than {size} bytes of {file}"
        );
        // It may grow meanwhile.
        piece.truncate(usize::try_from(size - from).unwrap_or(usize::MAX));
        half.write_all(&piece).context("not written")?;
        from += u64::try_from(piece.len())?;
    }
    half.as_file().sync_all().context("not written")?;
    half.persist_noclobber(&to)
        .map_err(|error| error.error)
        .with_context(exists)?;
    Ok((to, size))
}

/// The answer of the only robot with this name.
fn ask(session: &Session, robot: &RobotName, question: &str, most: u64) -> Result<Vec<u8>> {
    let answers = session
        .get(question)
        .target(QueryTarget::All)
        .consolidation(ConsolidationMode::None)
        // States and commands go first.
        .priority(Priority::Background)
        .timeout(ANSWER_MAX)
        .wait()
        .map_err(|error| anyhow!("{error}"))?;
    let mut answer = None;
    for reply in &answers {
        let sample = reply
            .into_result()
            .map_err(|error| anyhow!("{robot}: {}", plain(&error.payload().to_bytes())))?;
        let bytes = sample.payload().to_bytes().into_owned();
        ensure!(
            u64::try_from(bytes.len())? <= most,
            "{robot} sends too much"
        );
        if answer.replace(bytes).is_some() {
            bail!("two robots have the name {robot}: give them other names with --robot");
        }
    }
    answer
        .with_context(|| format!("{robot} does not answer: it is not there, or has no --sessions"))
}

/// What another program says, as one short line that does nothing to a terminal.
fn plain(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    let is_plain = |char: &char| char.is_ascii_graphic() || *char == ' ';
    text.chars().filter(is_plain).take(100).collect()
}
