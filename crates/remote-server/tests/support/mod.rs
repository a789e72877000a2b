//! A server with a virtual motor, for tests.
#![allow(dead_code, reason = "each test file uses its own part of the bench")]

use std::{
    io::{Read, Write},
    net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream},
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::Duration,
};

use motorlink_driver::{Driver, Entry, Next, Options, Place, VirtualLine};
use motorlink_messages::Adapter;
use motorlink_protocol::{MotorId, family::Model};
use motorlink_remote_server::{Access, Hub, Server, Site, Tls, Token, Viewers};

/// Longer than any wait of a test.
pub const SOON: Duration = Duration::from_secs(10);

/// A server with one virtual motor, and the thread of its driver.
pub struct Bench {
    pub address: SocketAddr,
    pub token: Option<Token>,
    pub viewers: Viewers,
    is_over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    _server: Server,
    _folder: tempfile::TempDir,
}

impl Bench {
    pub fn start(token: Option<Token>) -> Self {
        Self::start_with(token, |_, _| ())
    }

    /// `take` gets the entries of the driver too, with their times.
    pub fn start_with(
        token: Option<Token>,
        take: impl FnMut(motorlink_protocol::Instant, &Entry) + Send + 'static,
    ) -> Self {
        Self::start_encrypted(token, None, take)
    }

    /// The same, encrypted if there is a certificate.
    pub fn start_encrypted(
        token: Option<Token>,
        tls: Option<Tls>,
        mut take: impl FnMut(motorlink_protocol::Instant, &Entry) + Send + 'static,
    ) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let index = "<html lang=\"en\"><meta name=\"motorlink-worker\" content=\"./worker-boot.js\">\
                     <meta name=\"motorlink-remote\" content=\"./remote-boot.js\">";
        std::fs::write(folder.path().join("index.html"), index).unwrap();
        std::fs::write(folder.path().join("remote-boot.js"), "1").unwrap();
        let site = Site::open(Some(PathBuf::from(folder.path()))).unwrap();

        let line = VirtualLine::of(Model::Ddsm115, [MotorId::FIRST]);
        let mut options = Options::at(Place::Virtual(line));
        options.watch = vec![MotorId::FIRST];
        options.tells_traffic = true;
        options.state_folder = None;
        let driver = Driver::open(options).unwrap();
        let viewers = Viewers::new(driver.commander()).unwrap();
        let mut hub = Hub::new(viewers.clone(), Adapter::Serial(None));
        let is_over = Arc::new(AtomicBool::new(false));
        let ends = Arc::clone(&is_over);
        let thread = thread::spawn(move || {
            while !ends.load(Ordering::SeqCst) {
                let wait = hub.turn(&driver);
                if let Next::Entry(at, entry) = driver.next(wait) {
                    take(at, &entry);
                    hub.take(at, entry);
                }
            }
        });
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let address = listener.local_addr().unwrap();
        let mut access = Access::new(address, Vec::new(), token.clone());
        if tls.is_some() {
            access = access.encrypted();
        }
        Self {
            address,
            token,
            viewers: viewers.clone(),
            is_over,
            thread: Some(thread),
            _server: Server::start(listener, access, site, Some(viewers), tls).unwrap(),
            _folder: folder,
        }
    }

    /// The answer to a request with these header lines: its status, and the whole of it.
    pub fn get(&self, path: &str, headers: &str) -> (u16, String) {
        let stream = TcpStream::connect(self.address).unwrap();
        stream.set_read_timeout(Some(SOON)).unwrap();
        ask(stream, path, headers)
    }

    pub fn host(&self) -> String {
        format!("Host: {}\r\n", self.address)
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::SeqCst);
        self.thread.take().unwrap().join().unwrap();
    }
}

/// The answer to a request at this connection: its status, and the whole of it.
pub fn ask(mut stream: impl Read + Write, path: &str, headers: &str) -> (u16, String) {
    let request = format!("GET {path} HTTP/1.1\r\n{headers}Connection: close\r\n\r\n");
    // The server may close before it has taken all of it.
    let _ = stream.write_all(request.as_bytes());
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    let answer = String::from_utf8_lossy(&answer).into_owned();
    let status = answer
        .split(' ')
        .nth(1)
        .and_then(|status| status.parse().ok());
    (status.unwrap_or_default(), answer)
}
