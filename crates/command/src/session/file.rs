//! An open file: a session file, or a CSV file that was imported.

use std::{
    fmt,
    fs::File,
    io::{self, Read, Seek, SeekFrom},
    ops::Range,
    path::Path,
};

use motorlink_session::{Import, NotASession, Problems, Session, Source, open};

/// Bytes per read of a CSV file.
const PIECE: usize = 1 << 20;

/// Why a command failed.
#[derive(Debug)]
pub enum Failure {
    /// A file cannot be read or written.
    Io(String, io::Error),
    /// The file is not a session.
    NotASession(String, NotASession),
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(name, error) => write!(f, "{name}: {error}"),
            Self::NotASession(name, why) => write!(f, "{name}: {why}"),
        }
    }
}

/// An open session.
#[derive(Debug)]
pub struct Opened {
    /// The name of the file, without folders.
    pub name: String,
    /// The index of the session.
    pub session: Session,
    /// The source of its bytes.
    pub bytes: Bytes,
    /// The unreadable parts of a CSV file.
    pub imported: Problems,
}

/// The source of a session's bytes.
#[derive(Debug)]
pub enum Bytes {
    /// A file and its length.
    File(File, u64),
    /// A session made of a CSV file.
    Memory(Vec<u8>),
}

impl Source for Bytes {
    type Error = io::Error;

    fn len(&self) -> u64 {
        match self {
            Self::File(_, len) => *len,
            Self::Memory(bytes) => bytes.len() as u64,
        }
    }

    fn read(&mut self, range: Range<u64>) -> io::Result<Vec<u8>> {
        match self {
            Self::File(file, _) => {
                file.seek(SeekFrom::Start(range.start))?;
                let mut bytes = Vec::new();
                file.take(range.end.saturating_sub(range.start))
                    .read_to_end(&mut bytes)?;
                Ok(bytes)
            }
            Self::Memory(bytes) => match Source::read(&mut &bytes[..], range) {
                Ok(bytes) => Ok(bytes),
                Err(never) => match never {},
            },
        }
    }
}

impl Opened {
    /// Opens a session file, or a CSV file.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let name = name.into_owned();
        let io = |error| Failure::Io(path.display().to_string(), error);
        let file = File::open(path).map_err(io)?;
        let len = file.metadata().map_err(io)?.len();
        let mut bytes = Bytes::File(file, len);
        let mut imported = Problems::default();
        let mut session = open(&mut bytes).map_err(io)?;
        if session.as_ref().is_err_and(|why| *why == NotASession::Text)
            && let Ok((whole, problems)) = import(&mut bytes).map_err(io)?
        {
            bytes = Bytes::Memory(whole);
            imported = problems;
            session = open(&mut bytes).map_err(io)?;
        }
        let session = session.map_err(|why| Failure::NotASession(name.clone(), why))?;
        Ok(Self {
            name,
            session,
            bytes,
            imported,
        })
    }

    /// What is missing, as far as it is known without reading every record.
    pub fn problems(&self) -> Problems {
        self.session.problems().and(&self.imported)
    }
}

fn import(bytes: &mut Bytes) -> io::Result<Result<(Vec<u8>, Problems), NotASession>> {
    let mut import = Import::default();
    let mut whole = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let piece = bytes.read(at..at + PIECE as u64)?;
        if piece.is_empty() {
            break;
        }
        at += piece.len() as u64;
        import.feed(&piece);
        whole.extend(import.take());
        if import.is_unknown() {
            break;
        }
    }
    Ok(import.finish().map(|(last, problems)| {
        whole.extend(last);
        (whole, problems)
    }))
}
