//! Virtual motors, a motorlink that serves them, a router, this program, and a node of hiroz.

use std::{
    env,
    io::{BufRead as _, BufReader, Write as _},
    net::TcpListener,
    path::PathBuf,
    process::{Child, ChildStdin, ChildStdout, Command, Stdio},
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::{self, sleep},
    time::{Duration, Instant},
};

use hiroz::{Builder as _, context::ZContextBuilder, node::ZNode};
use hiroz_msgs::{
    geometry_msgs::{Twist, Vector3},
    std_srvs::{TriggerRequest, TriggerResponse, srv::Trigger},
};
use tempfile::TempDir;
use zenoh::{Config, Session, Wait as _};

/// A busy machine is slow.
pub const PATIENCE: Duration = Duration::from_secs(20);
/// Before a first drive, nobody may ask for 2 s.
pub const RESTS: Duration = Duration::from_millis(2_300);
/// A command counts for so long, and a stop at this speed takes less than the rest.
pub const STOPS_WITHIN: Duration = Duration::from_millis(500 + 700);

/// A program that ends with the test.
pub struct Program(pub Child);

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Program {
    pub fn signal(&self, signal: &str) {
        let id = self.0.id().to_string();
        let done = Command::new("kill").args(["-s", signal, &id]).status();
        assert!(done.unwrap().success());
    }
}

/// Virtual motors 1 and 2 on a pseudo-terminal. They keep their last command when frames cease.
pub struct Motors {
    _program: Program,
    stdin: ChildStdin,
    stdout: BufReader<ChildStdout>,
}

impl Motors {
    fn start(link: &str) -> Self {
        let mut child = Command::new(motorlink())
            .args(["virtual", "--ids", "1,2", "--link", link])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let stdin = child.stdin.take().unwrap();
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        let mut ready = String::new();
        stdout.read_line(&mut ready).unwrap();
        assert!(ready.starts_with("ready"), "{ready}");
        Self {
            _program: Program(child),
            stdin,
            stdout,
        }
    }

    fn value(&mut self, id: u8, name: &str) -> f64 {
        writeln!(self.stdin, "state {id}").unwrap();
        let mut line = String::new();
        self.stdout.read_line(&mut line).unwrap();
        let (_, rest) = line.split_once(&format!("{name}=")).expect(&line);
        rest.split_ascii_whitespace()
            .next()
            .unwrap()
            .parse()
            .unwrap()
    }

    pub fn rpm(&mut self, id: u8) -> f64 {
        self.value(id, "rpm")
    }

    /// In degrees, 0 to 360.
    pub fn angle(&mut self, id: u8) -> f64 {
        self.value(id, "angle")
    }

    pub fn stand(&mut self) -> bool {
        self.rpm(1).abs() < 1.0 && self.rpm(2).abs() < 1.0
    }

    /// Waits until it is so, and returns how long that took.
    pub fn until(&mut self, what: &str, mut is_so: impl FnMut(&mut Self) -> bool) -> Duration {
        let began = Instant::now();
        while !is_so(self) {
            assert!(
                began.elapsed() < PATIENCE,
                "not within {PATIENCE:?}: {what}"
            );
            sleep(Duration::from_millis(10));
        }
        began.elapsed()
    }
}

/// Everything that runs in a test.
pub struct Bench {
    // Dropped first.
    pub ros: Option<Program>,
    pub served: Option<Program>,
    pub motors: Motors,
    pub router: Option<Session>,
    router_port: u16,
    flags: Vec<String>,
    folder: TempDir,
}

/// `motorlink-fleet`, which connects to this router.
pub fn fleet(endpoint: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_motorlink-fleet"));
    command.args(["--connect", endpoint]).args(arguments);
    command
}

fn motorlink() -> PathBuf {
    env::var_os("MOTORLINK").map_or_else(
        || {
            PathBuf::from(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../../target/debug/motorlink"
            ))
        },
        PathBuf::from,
    )
}

impl Bench {
    /// Starts all of it. `flags` are those of this program.
    pub fn start(flags: &[&str]) -> Self {
        Self::start_at(None, flags)
    }

    /// Starts all of it at the router of another bench.
    pub fn start_beside(other: &Self, flags: &[&str]) -> Self {
        Self::start_at(Some(other.router_port), flags)
    }

    fn start_at(router_port: Option<u16>, flags: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("port");
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let own_port = listener.local_addr().unwrap().port();
        drop(listener);
        let mut bench = Self {
            ros: None,
            served: None,
            motors: Motors::start(link.to_str().unwrap()),
            router: None,
            router_port: router_port.unwrap_or(own_port),
            flags: flags.iter().map(|flag| (*flag).to_owned()).collect(),
            folder,
        };
        if router_port.is_none() {
            bench.start_router();
        }
        bench.serve();
        bench.start_ros();
        bench
    }

    pub fn endpoint(&self) -> String {
        format!("tcp/127.0.0.1:{}", self.router_port)
    }

    pub fn socket(&self) -> PathBuf {
        self.folder.path().join("socket")
    }

    pub fn folder(&self) -> PathBuf {
        self.folder.path().to_owned()
    }

    pub fn start_router(&mut self) {
        let mut config = Config::default();
        for (key, value) in [
            ("mode", "\"router\"".to_owned()),
            ("listen/endpoints", format!("[\"{}\"]", self.endpoint())),
            ("scouting/multicast/enabled", "false".to_owned()),
        ] {
            config.insert_json5(key, &value).unwrap();
        }
        self.router = Some(zenoh::open(config).wait().unwrap());
    }

    /// Starts `motorlink serve` at the port of the motors.
    pub fn serve(&mut self) {
        let page = self.folder.path().join("page");
        std::fs::create_dir_all(&page).unwrap();
        let index = "<html lang=\"en\"><meta name=\"motorlink-worker\" content=\"./a.js\">\
                     <meta name=\"motorlink-remote\" content=\"./b.js\">";
        std::fs::write(page.join("index.html"), index).unwrap();
        let mut child = Command::new(motorlink())
            .arg("--port")
            .arg(self.folder.path().join("port"))
            .args(["--id", "1,2", "serve", "--listen", "127.0.0.1:0"])
            .arg("--socket")
            .arg(self.socket())
            .arg("--page")
            .arg(page)
            .env("XDG_STATE_HOME", self.folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        wait_for(&mut child, "motorlink", "Open ");
        self.served = Some(Program(child));
    }

    /// Starts this program, and waits until it is connected to motorlink.
    pub fn start_ros(&mut self) {
        let mut child = Command::new(env!("CARGO_BIN_EXE_motorlink-ros"))
            .args([
                "--left",
                "1",
                "--right",
                "2",
                "--wheel-radius",
                "0.05",
                "--track",
                "0.3",
            ])
            .arg("--socket")
            .arg(self.socket())
            .args(["--connect", &self.endpoint()])
            .args(&self.flags)
            .stdin(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        wait_for(&mut child, "motorlink-ros", "connected to /");
        self.ros = Some(Program(child));
        sleep(RESTS);
    }

    /// A node of hiroz.
    pub fn node(&self) -> ZNode {
        self.node_in("")
    }

    pub fn node_in(&self, namespace: &str) -> ZNode {
        let context = ZContextBuilder::default()
            .disable_multicast_scouting()
            .with_connect_endpoints([self.endpoint()])
            .build()
            .unwrap();
        let node = context
            .create_node("tester")
            .with_namespace(namespace)
            .build()
            .unwrap();
        // The context ends with the test.
        std::mem::forget(context);
        node
    }

    /// Drives until the wheels turn so fast ahead.
    pub fn drive(&mut self, asking: &Asking, twist: (f64, f64), rpm: f64) {
        asking.ask(Some(twist));
        self.motors.until("turning wheels", |motors| {
            motors.rpm(1) > rpm && motors.rpm(2) < -rpm
        });
    }
}

/// Waits until a program says so on its stderr, and prints what it says after that.
fn wait_for(child: &mut Child, name: &'static str, beginning: &str) {
    let lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let mut lines = lines.map_while(Result::ok);
    let found = lines.any(|line| line.starts_with(beginning));
    assert!(found, "{name} does not say {beginning:?}");
    thread::spawn(move || lines.for_each(|line| println!("{name}: {line}")));
}

/// Publishes what is asked at 20 Hz, as `Twist`.
pub struct Asking {
    asked: Arc<Mutex<Option<(f64, f64)>>>,
    pause: Arc<AtomicU64>,
    ends: Arc<AtomicBool>,
}

impl Asking {
    pub fn new(node: &ZNode) -> Self {
        let publisher = node.create_pub::<Twist>("cmd_vel").build().unwrap();
        let (asked, ends) = (Arc::new(Mutex::new(None)), Arc::new(AtomicBool::new(false)));
        let pause = Arc::new(AtomicU64::new(50));
        let asking = Self {
            asked: Arc::clone(&asked),
            pause: Arc::clone(&pause),
            ends: Arc::clone(&ends),
        };
        thread::spawn(move || {
            while !ends.load(Ordering::Relaxed) {
                let twist = *asked.lock().unwrap();
                if let Some((x, z)) = twist {
                    publisher.publish(&twist_of(x, z)).unwrap();
                }
                sleep(Duration::from_millis(pause.load(Ordering::Relaxed)));
            }
        });
        asking
    }

    /// Publishes once in so many milliseconds.
    pub fn every(&self, ms: u64) {
        self.pause.store(ms, Ordering::Relaxed);
    }

    pub fn ask(&self, twist: Option<(f64, f64)>) {
        *self.asked.lock().unwrap() = twist;
    }
}

impl Drop for Asking {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
    }
}

pub fn twist_of(x: f64, z: f64) -> Twist {
    let axis = |x, z| Vector3 { x, y: 0.0, z };
    Twist {
        linear: axis(x, 0.0),
        angular: axis(0.0, z),
    }
}

/// Calls `hardware/e_stop_trigger` or `hardware/e_stop_reset`.
pub fn call(node: &ZNode, service: &str) -> TriggerResponse {
    let client = node.create_client::<Trigger>(service).build().unwrap();
    let runtime = tokio::runtime::Runtime::new().unwrap();
    let request = TriggerRequest::default();
    let answer = client.call_with_timeout(&request, PATIENCE);
    runtime.block_on(answer).unwrap()
}
