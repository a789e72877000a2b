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
            write_secret(file, &format!("{token}\n")).map_err(Failure::file(file))?;
            Ok(token)
        }
        Err(error) => Err(Failure::file(file)(error)),
    }
}

fn new() -> Result<Token, Failure> {
    Token::new().map_err(|error| Failure::NotDone(format!("no random numbers: {error}")))
}

/// Only its owner can read the file.
pub fn write_secret(path: &Path, text: &str) -> io::Result<()> {
    let mut options = fs::OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    options.open(path)?.write_all(text.as_bytes())
}
