//! The connection to a running `motorlink serve --socket`.

use std::{
    io::{self, Read as _, Write as _},
    net::Shutdown,
    os::unix::net::UnixStream,
    path::Path,
    thread,
    time::Duration,
};

use anyhow::{Context as _, Result, anyhow, bail};
use motorlink_controller_messages::{
    FROM_SERVER, FromClient, FromServer, HELLO, State, check_server_hello, client_hello,
    decode_from_server, encode_from_client,
};

/// How long a connection may take, and the answer of a command.
const ANSWER_MAX: Duration = Duration::from_secs(1);
/// motorlink sends a state every 10 ms: without one for so long, the connection is dead.
const STATE_MAX: Duration = Duration::from_secs(1);
/// A message of 56 bytes fits into the queue of the system. If it does not, motorlink hangs.
const SEND_MAX: Duration = Duration::from_millis(50);

/// What comes from the connection.
#[derive(Debug)]
pub enum FromMotorlink {
    /// The newest state.
    State(Box<State>),
    /// The connection has ended.
    Lost(String),
}

/// A connection. Dropped, it ends, and motorlink stops what it drives.
#[derive(Debug)]
pub struct Connection(UnixStream);

impl Connection {
    /// Connects.
    ///
    /// # Errors
    ///
    /// When nobody listens there, or another version.
    pub fn open(path: &Path) -> Result<Self> {
        let mut stream = connect(path)?;
        stream.write_all(&client_hello())?;
        let mut hello = [0; HELLO];
        stream.read_exact(&mut hello).map_err(no_answer)?;
        if let Err(why) = check_server_hello(&hello) {
            bail!(why);
        }
        stream.set_read_timeout(Some(STATE_MAX))?;
        stream.set_write_timeout(Some(SEND_MAX))?;
        Ok(Self(stream))
    }

    /// Passes on what comes, from a thread of its own, until the connection ends or `to` returns false.
    ///
    /// # Errors
    ///
    /// When the system gives no thread.
    pub fn listen(&self, to: impl Fn(FromMotorlink) -> bool + Send + 'static) -> io::Result<()> {
        let reading = self.0.try_clone()?;
        let read = move || {
            let why = pass_on(reading, &to);
            to(FromMotorlink::Lost(why));
        };
        let thread = thread::Builder::new().name("motorlink".to_owned());
        thread.spawn(read).map(drop)
    }

    /// Sends a message.
    ///
    /// # Errors
    ///
    /// When motorlink does not take it at once.
    pub fn send(&mut self, message: &FromClient) -> io::Result<()> {
        self.0.write_all(&encode_from_client(message))
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        // The thread that reads ends.
        let _ = self.0.shutdown(Shutdown::Both);
    }
}

/// Passes states on until the connection ends. Returns why it has.
fn pass_on(mut reading: UnixStream, to: &impl Fn(FromMotorlink) -> bool) -> String {
    let mut bytes = [0; FROM_SERVER];
    loop {
        if let Err(error) = reading.read_exact(&mut bytes) {
            return match error.kind() {
                io::ErrorKind::UnexpectedEof => "motorlink has ended".to_owned(),
                io::ErrorKind::WouldBlock => "motorlink sends nothing".to_owned(),
                _ => error.to_string(),
            };
        }
        match decode_from_server(&bytes) {
            Some(FromServer::State(state)) => {
                if !to(FromMotorlink::State(Box::new(state))) {
                    return String::new();
                }
            }
            Some(FromServer::Closes(why)) => return why,
            None => return "motorlink sends what this program does not know".to_owned(),
        }
    }
}

/// Stops all motors, also those that a page or another program drives.
///
/// # Errors
///
/// When nobody listens there, or motorlink does not say that it stops them.
pub fn stop_all(path: &Path) -> Result<()> {
    command(path, "stop", "All motors are being stopped.")
}

/// Lets controllers start motors again after a stop by a person.
///
/// # Errors
///
/// When nobody listens there, or motorlink does not say that they may.
pub fn release(path: &Path) -> Result<()> {
    command(path, "release", "A controller may start the motors.")
}

/// Gives the text form a command, on a connection of its own, and waits for its answer.
fn command(path: &Path, command: &str, done: &str) -> Result<()> {
    let mut stream = connect(path)?;
    writeln!(stream, "{command}")?;
    stream.shutdown(Shutdown::Write)?;
    let mut answer = String::new();
    stream.read_to_string(&mut answer).map_err(no_answer)?;
    if !answer.starts_with(done) {
        bail!("motorlink answers {:?} to {command}", answer.trim_end());
    }
    Ok(())
}

/// The error of the system would say that a resource is temporarily unavailable.
fn no_answer(_: io::Error) -> anyhow::Error {
    anyhow!("motorlink does not answer within a second")
}

fn connect(path: &Path) -> Result<UnixStream> {
    let stream = UnixStream::connect(path).with_context(|| {
        format!(
            "no motorlink at {}: start motorlink serve --socket {0}",
            path.display()
        )
    })?;
    stream.set_read_timeout(Some(ANSWER_MAX))?;
    stream.set_write_timeout(Some(ANSWER_MAX))?;
    Ok(stream)
}
