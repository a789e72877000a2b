//! A page without a browser. Tests and measurements use it.
#![allow(dead_code, reason = "each program uses its own part of the page")]
#![allow(
    clippy::unwrap_used,
    reason = "the file is part of a measuring program too, which is not a test"
)]

use std::{
    net::TcpStream,
    time::{Duration, Instant},
};

use motorlink_bus::{Command, Consent};
use motorlink_messages::{ToPage, ToWorker, Update, decode, encode};
use motorlink_protocol::{MotorId, Rpm, Setpoint, SpeedTarget};
use motorlink_remote::{ANSWER_AGAIN_EVERY, FromServer, Stamp, ToServer};
use tungstenite::{
    Error, HandshakeError, Message, WebSocket, client::IntoClientRequest, http::HeaderValue,
};

/// Longer than any wait of a test.
const SOON: Duration = Duration::from_secs(10);

/// How long one look for a message takes.
const LOOK: Duration = ANSWER_AGAIN_EVERY;

/// A page, as the worker and the main thread of a real one act together.
pub struct Page {
    pub socket: WebSocket<TcpStream>,
    /// Whether it answers challenges.
    pub answers: bool,
    pub challenge: u64,
    /// When it has sent an answer.
    answered: Instant,
    /// The number of its lease.
    pub epoch: Option<u32>,
    pub sequence: u32,
    /// How many bytes it has sent since it was connected.
    pub sent: usize,
    /// The newest state of the line.
    pub update: Option<Update>,
}

impl Page {
    /// The page of this origin at the far end of `stream`. `version` is the name of its program.
    pub fn connect(
        stream: TcpStream,
        origin: &str,
        version: &str,
        token: Option<&str>,
    ) -> Result<Self, Error> {
        let address = stream.peer_addr()?;
        let url = format!("ws://{address}/motorlink?page={version}");
        let mut request = url.into_client_request()?;
        let headers = request.headers_mut();
        headers.insert("Origin", HeaderValue::try_from(origin)?);
        if let Some(token) = token {
            let cookie = format!("other=1; motorlink-token={token}");
            headers.insert("Cookie", HeaderValue::try_from(cookie)?);
        }
        stream.set_nodelay(true)?;
        let (socket, _) = tungstenite::client(request, stream).map_err(|error| match error {
            HandshakeError::Failure(error) => error,
            // The stream blocks.
            HandshakeError::Interrupted(_) => Error::ConnectionClosed,
        })?;
        socket.get_ref().set_read_timeout(Some(LOOK))?;
        Ok(Self {
            socket,
            answers: true,
            challenge: 0,
            answered: Instant::now(),
            epoch: None,
            sequence: 0,
            sent: 0,
            update: None,
        })
    }

    pub fn send(&mut self, message: &ToServer) {
        let bytes = encode(message).unwrap();
        // Head, mask and, from 126 bytes on, two bytes more for the length.
        self.sent += bytes.len() + if bytes.len() < 126 { 6 } else { 8 };
        // The server may have closed: the next message tells.
        let _ = self.socket.send(Message::binary(bytes));
    }

    fn answer(&mut self) {
        self.answered = Instant::now();
        self.send(&ToServer::Answer {
            challenge: self.challenge,
        });
    }

    /// Takes what comes. Returns false once the server has closed.
    pub fn receive(&mut self) -> bool {
        if self.answers && self.epoch.is_some() && self.answered.elapsed() >= ANSWER_AGAIN_EVERY {
            self.answer();
        }
        let message = match self.socket.read() {
            Ok(Message::Binary(bytes)) => decode(&bytes).unwrap(),
            Ok(Message::Close(_)) => return false,
            Ok(_) => return true,
            Err(Error::Io(error)) => {
                return matches!(
                    error.kind(),
                    std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut
                );
            }
            Err(_) => return false,
        };
        match message {
            FromServer::Challenge(challenge) if self.answers => {
                self.challenge = challenge;
                self.answer();
            }
            FromServer::Control { epoch, .. } => self.epoch = epoch,
            FromServer::Page(bytes) => {
                if let Ok(ToPage::Update(update)) = decode(&bytes) {
                    self.update = Some(update);
                }
            }
            _ => {}
        }
        true
    }

    /// The speed of the first motor.
    pub fn speed(&self) -> Option<Rpm> {
        let motor = self.update.as_ref()?.motors.first()?;
        motor.last.as_ref()?.reply.speed
    }

    pub fn wait(&mut self, what: &str, mut is_so: impl FnMut(&Self) -> bool) {
        let until = Instant::now() + SOON;
        while !is_so(self) {
            assert!(Instant::now() < until, "waited for {what}");
            assert!(self.receive(), "closed while waiting for {what}");
        }
    }

    pub fn take_control(&mut self) {
        self.wait("a challenge", |page| page.challenge != 0);
        self.send(&ToServer::Take { by_force: false });
        self.wait("control", |page| page.epoch.is_some());
        self.sequence = 0;
    }

    pub fn act(&mut self, command: Command) {
        self.sequence += 1;
        let stamp = Stamp {
            epoch: self.epoch.unwrap_or_default(),
            sequence: self.sequence,
            challenge: self.challenge,
        };
        self.act_with(stamp, command);
    }

    pub fn act_with(&mut self, stamp: Stamp, command: Command) {
        let message = ToWorker::Command {
            command,
            given_ms: 0.0,
        };
        self.send(&ToServer::Act {
            stamp,
            age_ms: 0,
            message: encode(&message).unwrap(),
        });
    }

    pub fn is_halted(&self) -> bool {
        self.update.as_ref().is_some_and(|update| update.halted)
    }

    /// Lives on for a while.
    pub fn live(&mut self, duration: Duration) {
        let until = Instant::now() + duration;
        while Instant::now() < until {
            assert!(self.receive());
        }
    }

    pub fn drive(&mut self) {
        self.wait("a reply", |page| page.speed().is_some());
        self.act(start());
        self.wait("a turning wheel", Self::turns);
    }

    pub fn turns(&self) -> bool {
        self.speed().is_some_and(|speed| speed.magnitude() > 50)
    }
}

pub fn start() -> Command {
    Command::Start {
        id: MotorId::FIRST,
        setpoint: Setpoint::velocity(SpeedTarget::new(100).unwrap()),
        consent: Consent::None,
    }
}
