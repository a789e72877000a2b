//! The token of the server, and its file.

use std::{fs, io, io::Write as _, path::Path};

use motorlink_remote_server::Token;

use crate::failure::Failure;

/// The token in this file, or a new one, which the file then has. Without a file, a new one.
///
/// # Errors
/// The file cannot be used.
pub fn token(file: Option<&Path>) -> Result<Token, Failure> {
    let Some(file) = file else {
        return new();
    };
    match fs::read_to_string(file) {
        Ok(text) => text.trim().parse().map_err(|_| {
            let path = file.display();
            Failure::Usage(format!("{path}: not a token of 32 hexadecimal digits"))
        }),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let token = new()?;
            write_whole(file, &format!("{token}\n")).map_err(Failure::file(file))?;
            Ok(token)
        }
        Err(error) => Err(Failure::file(file)(error)),
    }
}

fn new() -> Result<Token, Failure> {
    Token::new().map_err(|error| Failure::NotDone(format!("no random numbers: {error}")))
}

/// Writes a new file that only its owner can read. It is there whole, or not at all.
pub fn write_whole(path: &Path, text: &str) -> io::Result<()> {
    let mut new = path.as_os_str().to_owned();
    new.push(".new");
    let new = Path::new(&new);
    let mut options = fs::OpenOptions::new();
    options.write(true).create(true).truncate(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let written = options.open(new).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.sync_all()
    });
    let written = written.and_then(|()| fs::rename(new, path));
    if written.is_err() {
        // It may not be there.
        let _ = fs::remove_file(new);
    }
    written
}
