//! The session files that the server has written, for the browser to save. The page replays them.

#[cfg(unix)]
use std::os::unix::fs::OpenOptionsExt as _;
use std::{
    fmt::Write as _,
    fs::{self, File, OpenOptions},
    io,
    path::Path,
};

use axum::{
    body::{Body, Bytes},
    http::{HeaderValue, StatusCode, header::CONTENT_DISPOSITION},
    response::{IntoResponse, Response},
};
use futures_util::stream;
use tokio::io::AsyncReadExt;

use crate::headers::set_headers;

/// The path of the list. Below it are the files.
pub(crate) const SESSIONS: &str = "/sessions";

/// The end of the name of a session file.
const ENDING: &str = ".mcap";
/// Bytes of one read.
const PIECE: usize = 64 << 10;

/// Answers a request below [`SESSIONS`], with what is in this folder. `name` is what follows in the path. Waits for the disk.
pub(crate) fn answer(folder: &Path, name: &str) -> Response {
    let answered = match name.trim_start_matches('/') {
        "" => list(folder),
        name => file(folder, name),
    };
    answered.unwrap_or_else(|_| (StatusCode::NOT_FOUND, "no such session\n").into_response())
}

/// The files, the newest first. It has no words, so it needs no language.
fn list(folder: &Path) -> io::Result<Response> {
    let mut page =
        "<!doctype html><meta charset=utf-8><meta name=viewport content=width=device-width>\
                    <meta name=color-scheme content=\"light dark\"><title>MotorLink</title><ul>"
            .to_owned();
    for (name, bytes) in files(folder)?.into_iter().rev() {
        let tenths = bytes.div_ceil(100_000);
        let (whole, tenth) = (tenths / 10, tenths % 10);
        // Writing to a string does not fail.
        let _ = write!(
            page,
            "<li><a href=\"{SESSIONS}/{name}\">{name}</a> {whole}.{tenth} MB"
        );
    }
    let mut response = page.into_response();
    let policy = "default-src 'none'; frame-ancestors 'none'";
    set_headers(&mut response, "text/html; charset=utf-8", policy);
    Ok(response)
}

/// The session files, by name.
fn files(folder: &Path) -> io::Result<Vec<(String, u64)>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if is_name(&name) {
            files.push((name, entry.metadata()?.len()));
        }
    }
    files.sort();
    Ok(files)
}

/// Whether it is a name of a file in the folder itself, which needs no escape in HTML or an address.
fn is_name(name: &str) -> bool {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_' | b'.');
    name.ends_with(ENDING) && !name.starts_with('.') && name.bytes().all(is_plain)
}

/// Opens a file to read it. Links are not followed, and a pipe does not block. Other systems have no such flags: there the
/// check for a link comes before the open.
fn open(path: &Path) -> io::Result<File> {
    let is_link = cfg!(not(unix)) && fs::symlink_metadata(path)?.is_symlink();
    let mut options = OpenOptions::new();
    #[cfg(unix)]
    {
        let flags = rustix::fs::OFlags::NOFOLLOW | rustix::fs::OFlags::NONBLOCK;
        options.custom_flags(flags.bits().cast_signed());
    }
    let file = options.read(true).open(path)?;
    if is_link || !file.metadata()?.is_file() {
        return Err(io::ErrorKind::NotFound.into());
    }
    Ok(file)
}

/// The file as it is now. One that is still being written has no end yet, and can be read nevertheless.
fn file(folder: &Path, name: &str) -> io::Result<Response> {
    if !is_name(name) {
        return Err(io::ErrorKind::NotFound.into());
    }
    let file = tokio::fs::File::from_std(open(&folder.join(name))?);
    let pieces = stream::try_unfold(file, async |mut file| {
        let mut piece = vec![0; PIECE];
        let length = file.read(&mut piece).await?;
        piece.truncate(length);
        let piece = (length > 0).then_some((Bytes::from(piece), file));
        Ok::<_, io::Error>(piece)
    });
    let mut response = Body::from_stream(pieces).into_response();
    set_headers(
        &mut response,
        "application/octet-stream",
        "default-src 'none'",
    );
    let save = HeaderValue::from_static("attachment");
    response.headers_mut().insert(CONTENT_DISPOSITION, save);
    Ok(response)
}

#[cfg(test)]
mod tests {
    #[cfg(unix)]
    use std::{
        os::unix::fs::symlink,
        sync::atomic::{AtomicBool, Ordering},
        thread,
    };

    use super::*;

    #[test]
    fn only_sessions_in_the_folder_itself_are_named() {
        assert!(is_name("motorlink-log-000012-20261127-193300.mcap"));
        for name in [
            "token",
            ".mcap",
            "../token.mcap",
            "a/b.mcap",
            "a\\b.mcap",
            "<a>.mcap",
            "%2e%2e.mcap",
        ] {
            assert!(!is_name(name), "{name}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_that_takes_the_place_of_a_session_is_never_followed() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let is_over = AtomicBool::new(false);
        fs::write(path("token"), "secret").unwrap();
        fs::write(path("session"), "").unwrap();
        thread::scope(|scope| {
            scope.spawn(|| {
                while !is_over.load(Ordering::SeqCst) {
                    fs::hard_link(path("session"), path("new")).unwrap();
                    fs::rename(path("new"), path("a.mcap")).unwrap();
                    symlink(path("token"), path("new")).unwrap();
                    fs::rename(path("new"), path("a.mcap")).unwrap();
                }
            });
            let attempts = (0..1_000_000).map(|_| open(&path("a.mcap")));
            let read = attempts.flatten().map(io::read_to_string).take(3_000);
            let is_followed = read.map(Result::unwrap).any(|text| text == "secret");
            is_over.store(true, Ordering::SeqCst);
            assert!(!is_followed);
        });
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_pipe_in_the_place_of_a_session_is_not_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        rustix::fs::mkfifoat(rustix::fs::CWD, &path, 0o600.into()).unwrap();
        assert!(open(&path).is_err());
    }
}
