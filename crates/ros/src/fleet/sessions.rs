//! A robot answers with its session files: the list, and pieces of a file.

use std::{
    fs::{self, File, OpenOptions},
    io::{self, Read as _, Seek as _, SeekFrom},
    os::unix::fs::OpenOptionsExt as _,
    path::{Path, PathBuf},
    sync::mpsc,
    thread,
};

use anyhow::{Context as _, Result, anyhow};
use rustix::fs::OFlags;
use serde::{Deserialize, Serialize};
use zenoh::{
    Session, Wait as _,
    query::{Query, Queryable},
};

use super::names::{RobotName, is_file};

/// Bytes of an answer with a piece: on a slow network, `cmd_vel` waits behind no more.
pub const PIECE_MAX: u64 = 65_536;
/// Bytes of an answer with a list.
pub const LIST_MAX: u64 = 1_000_000;
/// Files in a list, which fits into an answer. `motorlink serve --log` keeps fewer.
pub const FILES_MAX: usize = 2_000;
/// Questions that wait. More get no answer.
const WAITING_MAX: usize = 16;

/// A session file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SessionFile {
    /// In the folder itself.
    pub name: String,
    /// Its size now.
    pub bytes: u64,
}

/// Answers until it is dropped, in a thread of its own: a slow disk or network delays nothing else.
///
/// # Errors
///
/// What Zenoh or the system says.
pub fn serve(session: &Session, name: &RobotName, folder: PathBuf) -> Result<Queryable<()>> {
    let key = name.sessions_key();
    let (to, waiting) = mpsc::sync_channel::<Query>(WAITING_MAX);
    let all = format!("{key}/**");
    let of_thread = move || {
        for query in waiting {
            answer(&folder, &key, &query);
        }
    };
    let thread = thread::Builder::new().name("sessions".to_owned());
    thread.spawn(of_thread).context("no thread")?;
    session
        .declare_queryable(all)
        .callback(move |query| {
            // Without a place, the question ends without an answer.
            let _ = to.try_send(query);
        })
        .wait()
        .map_err(|error| anyhow!("{error}"))
}

fn answer(folder: &Path, key: &str, query: &Query) {
    let asked = query.key_expr().as_str();
    let bytes = match asked.strip_prefix(key) {
        Some("") => list(folder).map(|files| serde_json::to_vec(&files).unwrap_or_default()),
        Some(file) => {
            let from = query.parameters().get("from").unwrap_or("0").parse();
            from.map_err(|_| io::ErrorKind::InvalidInput.into())
                .and_then(|from| piece(folder, file.trim_start_matches('/'), from))
        }
        None => return,
    };
    // Who has asked may have gone.
    let _ = match bytes {
        Ok(bytes) => query.reply(query.key_expr().clone(), bytes).wait(),
        Err(_) => query.reply_err("no such session").wait(),
    };
}

/// The newest files, by name.
fn list(folder: &Path) -> io::Result<Vec<SessionFile>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        // Not the file behind a link.
        let metadata = entry.metadata()?;
        if is_file(&name) && metadata.is_file() {
            let bytes = metadata.len();
            files.push(SessionFile { name, bytes });
        }
    }
    files.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(files.split_off(files.len().saturating_sub(FILES_MAX)))
}

fn piece(folder: &Path, name: &str, from: u64) -> io::Result<Vec<u8>> {
    if !is_file(name) {
        return Err(io::ErrorKind::NotFound.into());
    }
    // A link leads elsewhere, and a pipe waits.
    let flags = (OFlags::NOFOLLOW | OFlags::NONBLOCK).bits().cast_signed();
    let mut options = OpenOptions::new();
    let mut file: File = options
        .read(true)
        .custom_flags(flags)
        .open(folder.join(name))?;
    if !file.metadata()?.is_file() {
        return Err(io::ErrorKind::NotFound.into());
    }
    file.seek(SeekFrom::Start(from))?;
    let mut bytes = Vec::new();
    file.take(PIECE_MAX).read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_the_folder_are_listed_and_read_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("b.mcap"), b"0123456789").unwrap();
        fs::write(path("a.mcap"), b"").unwrap();
        fs::write(path("token"), b"secret").unwrap();
        fs::create_dir(path("c.mcap")).unwrap();
        std::os::unix::fs::symlink(path("token"), path("d.mcap")).unwrap();
        let names = list(folder.path()).unwrap().into_iter();
        let names: Vec<_> = names.map(|file| (file.name, file.bytes)).collect();
        assert_eq!(names, [("a.mcap".to_owned(), 0), ("b.mcap".to_owned(), 10)]);
        let read = |name: &str, from: u64| piece(folder.path(), name, from);
        assert_eq!(read("b.mcap", 4).unwrap(), b"456789");
        assert_eq!(read("b.mcap", 10).unwrap(), b"");
        for name in ["token", "c.mcap", "d.mcap", "../b.mcap", "x.mcap"] {
            assert!(read(name, 0).is_err(), "{name}");
        }
        assert!(read("b.mcap", u64::MAX).is_err());
    }
}
