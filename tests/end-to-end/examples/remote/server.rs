//! `motorlink serve` on virtual motors at a pseudo-terminal.

use std::{
    fs,
    io::{BufRead, BufReader, Read, Write},
    net::{SocketAddr, TcpStream},
    path::Path,
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, ensure};
use end_to_end::{Line, Motors, WireLog, artefacts};
use tempfile::TempDir;

use crate::{network::Network, page::Page};

/// How long a server takes to start at most.
const STARTS_WITHIN: Duration = Duration::from_secs(20);

/// A server with its motors. They end when it is dropped.
pub struct Server {
    program: Child,
    address: SocketAddr,
    token: String,
    /// The name of the page's program.
    version: String,
    _motors: Motors,
    folder: TempDir,
}

impl Server {
    /// A server on this computer. It listens in the namespace of a network, if one is given.
    pub fn start(line: &Line, network: Option<&Network>) -> Result<Self> {
        let folder = tempfile::tempdir()?;
        let [node, log] = ["port", "wire.log"].map(|name| folder.path().join(name));
        let motors = Motors::start(line, &node, &log, folder.path())?;
        let motorlink = artefacts::command()?;
        let (mut command, host) = match network {
            None => (Command::new(motorlink), "127.0.0.1".to_owned()),
            Some(network) => {
                let mut inside = Command::new("ip");
                inside.args(["netns", "exec", &network.server_namespace()]);
                inside.arg(motorlink);
                (inside, network.server_address())
            }
        };
        let token = folder.path().join("token");
        let mut program = command
            .arg("--port")
            .arg(&node)
            .args(["serve", "--listen", &format!("{host}:0"), "--token-file"])
            .arg(&token)
            .env("XDG_STATE_HOME", folder.path())
            .stderr(Stdio::piped())
            .spawn()
            .context("motorlink does not start")?;
        let said = program.stderr.take().context("it says nothing")?;
        let mut lines = BufReader::new(said).lines();
        let address = lines.find_map(|line| {
            let line = line.ok()?;
            let (_, rest) = line.split_once("Open http://")?;
            rest.split_once('/')?.0.parse().ok()
        });
        // It must be able to say more.
        thread::spawn(move || lines.for_each(drop));
        Ok(Self {
            program,
            address: address.context("the server did not say its address")?,
            token: fs::read_to_string(token)?.trim().to_owned(),
            version: String::new(),
            _motors: motors,
            folder,
        })
    }

    /// A page, from the namespace of this thread.
    pub fn page(&mut self) -> Result<Page> {
        if self.version.is_empty() {
            self.version = self.read_version()?;
        }
        self.connect()
    }

    /// A further page.
    pub fn connect(&self) -> Result<Page> {
        let stream = TcpStream::connect(self.address)?;
        let origin = format!("http://{}", self.address);
        let page = Page::connect(stream, &origin, &self.version, Some(&self.token));
        page.context("the server refuses a page")
    }

    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    fn read_version(&self) -> Result<String> {
        let until = Instant::now() + STARTS_WITHIN;
        let mut stream = loop {
            match TcpStream::connect(self.address) {
                Err(_) if Instant::now() < until => thread::sleep(Duration::from_millis(20)),
                stream => break stream?,
            }
        };
        let (address, token) = (self.address, &self.token);
        write!(
            stream,
            "GET / HTTP/1.1\r\nHost: {address}\r\nCookie: motorlink-token={token}\r\nConnection: close\r\n\r\n"
        )?;
        let mut answer = String::new();
        stream.read_to_string(&mut answer)?;
        let found = answer.split_once("name=\"motorlink-remote\" content=\"./");
        let (_, rest) = found.context("no page")?;
        Ok(rest.split('"').next().unwrap_or_default().to_owned())
    }

    /// The log of the wire.
    pub fn wire(&self) -> Result<WireLog> {
        WireLog::default().followed_by(&self.folder.path().join("wire.log"))
    }

    /// The processor time that the server has used, and the most memory that it has had, in bytes.
    pub fn cost(&self) -> Result<(Duration, u64)> {
        let process = Path::new("/proc").join(self.program.id().to_string());
        let stat = fs::read_to_string(process.join("stat"))?;
        let (_, fields) = stat.rsplit_once(") ").context("no name")?;
        let mut fields = fields.split(' ').skip(11);
        let (user, kernel) = (fields.next(), fields.next());
        let ticks = |field: Option<&str>| anyhow::Ok(field.context("no time")?.parse::<u32>()?);
        // Hundredths of a second on every Linux.
        let time = Duration::from_millis(10) * (ticks(user)? + ticks(kernel)?);
        let status = fs::read_to_string(process.join("status"))?;
        let most = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib: u64 = most
            .and_then(|most| most.trim().split(' ').next())
            .context("no VmHWM")?
            .parse()?;
        ensure!(kib > 0, "no memory");
        Ok((time, kib * 1024))
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}
