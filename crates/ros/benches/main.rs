//! A fleet on this machine, through a real Zenoh router: what is seen, how old it is, and what it costs. `cargo xtask bench fleet`
//! runs it and names the programs.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::cast_precision_loss,
    reason = "a measurement that cannot go on fails"
)]

mod robots;

use std::{
    collections::BTreeMap,
    fs,
    io::{BufRead as _, BufReader},
    path::PathBuf,
    process::{Child, Command, Stdio},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{self, Receiver},
    },
    thread::{self, sleep},
    time::{Duration, Instant},
};

use anyhow::{Result, ensure};
use clap::Parser;
use motorlink_ros::node::{Node, Topic, messages::Twist, names::NodeName};
use serde::Deserialize;

use robots::{Robots, client, name};

/// Before a first drive, nobody may ask for 2 s.
const RESTS: Duration = Duration::from_millis(2_500);
/// A router is gone for so long.
const OUTAGE: Duration = Duration::from_secs(3);
/// What is asked of the fleet.
const STALE: Duration = Duration::from_secs(1);
const BACK_WITHIN: Duration = Duration::from_secs(10);
const PATIENCE: Duration = Duration::from_secs(60);

#[derive(Parser)]
struct Arguments {
    /// The program `zenohd`.
    #[arg(long)]
    zenohd: PathBuf,
    /// The program `motorlink-fleet`.
    #[arg(long)]
    fleet: PathBuf,
    #[arg(long, default_value_t = 1_000)]
    robots: usize,
    /// Robots that are driven.
    #[arg(long, default_value_t = 100)]
    driven: usize,
    #[arg(long, default_value_t = 60)]
    seconds: u64,
}

/// A program that ends with this one.
struct Program(Child);

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// What is read of a line of `motorlink-fleet --json`.
#[derive(Deserialize)]
struct Line {
    robots: Vec<Robot>,
    ignored: u64,
}

#[derive(Deserialize)]
struct Robot {
    name: String,
    age_ms: Option<u64>,
    heard: bool,
    state: Option<State>,
}

#[derive(Deserialize)]
struct State {
    number: u64,
}

impl Line {
    fn heard(&self) -> usize {
        self.robots.iter().filter(|robot| robot.heard).count()
    }
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let port = std::net::TcpListener::bind("127.0.0.1:0")?
        .local_addr()?
        .port();
    let endpoint = format!("tcp/127.0.0.1:{port}");
    let router = start_router(&arguments, &endpoint)?;
    // A thousand sessions take minutes to close one after the other.
    let robots = Box::leak(Box::new(Robots::start(&endpoint, arguments.robots)?));
    let mut fleet = Command::new(&arguments.fleet)
        .args(["--json", "--connect", &endpoint])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()?;
    let lines = BufReader::new(fleet.stdout.take().unwrap()).lines();
    let fleet = Program(fleet);
    // A line is judged when it comes, also while another one is awaited.
    let (to, lines_in) = mpsc::sync_channel(1_000);
    thread::spawn(move || {
        for line in lines.map_while(Result::ok) {
            let at = Instant::now();
            let line: Line = serde_json::from_str(&line).unwrap();
            if to.send((at, line)).is_err() {
                return;
            }
        }
    });
    let took = until_all_heard(&lines_in, arguments.robots, Instant::now())?;
    println!("all robots heard after the start of the fleet client: {took:.1} s");
    sleep(RESTS);
    let asks = Arc::new(AtomicBool::new(true));
    operate(&endpoint, arguments.driven, &asks)?;
    let begun = Instant::now();
    while robots.drive() < arguments.driven as u64 {
        ensure!(
            begun.elapsed() < PATIENCE,
            "{} robots drive only",
            robots.drive()
        );
        sleep(Duration::from_millis(10));
    }
    println!(
        "robots driven by cmd_vel through the router: {}",
        robots.drive()
    );
    let measured = measure(&arguments, robots, &lines_in, [&router, &fleet]);
    restart(&arguments, &endpoint, robots, &lines_in, router)?;
    measured
}

fn start_router(arguments: &Arguments, endpoint: &str) -> Result<Program> {
    let router = Command::new(&arguments.zenohd)
        .args(["--listen", endpoint, "--no-multicast-scouting"])
        // 1000 is usual.
        .args(["--cfg", "transport/unicast/max_sessions:20000"])
        .args(["--cfg", "transport/unicast/accept_pending:20000"])
        .env("RUST_LOG", "error")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .spawn()?;
    let router = Program(router);
    let port = endpoint.trim_start_matches("tcp/");
    let begun = Instant::now();
    while std::net::TcpStream::connect(port).is_err() {
        ensure!(begun.elapsed() < PATIENCE, "zenohd does not listen");
        sleep(Duration::from_millis(5));
    }
    Ok(router)
}

/// A node that publishes `cmd_vel` of the first robots, 10 a second, all the time.
fn operate(endpoint: &str, driven: usize, asks: &Arc<AtomicBool>) -> Result<()> {
    let node = Node::open(client(endpoint)?, NodeName::new(0, "", "operator")?)?;
    let topics =
        (0..driven).map(|robot| node.publish::<Twist>(&format!("/{}/cmd_vel", name(robot)), 1));
    let topics: Vec<Topic> = topics.collect::<Result<_>>()?;
    let mut twist = Twist::default();
    twist.linear.x = 0.4;
    let asks = Arc::clone(asks);
    thread::spawn(move || {
        while asks.load(Ordering::Relaxed) {
            let next = Instant::now() + Duration::from_millis(100);
            for topic in &topics {
                let _ = topic.send(&twist);
            }
            sleep(next.saturating_duration_since(Instant::now()));
        }
        drop(node);
    });
    Ok(())
}

/// Seconds from then until a line has all robots.
fn until_all_heard(lines: &Receiver<(Instant, Line)>, count: usize, from: Instant) -> Result<f64> {
    let mut most = 0;
    loop {
        ensure!(from.elapsed() < PATIENCE, "{most} robots are heard only");
        let (at, line) = lines.recv_timeout(PATIENCE)?;
        most = line.heard();
        if at > from && most == count {
            return Ok(at.duration_since(from).as_secs_f64());
        }
    }
}

fn measure(
    arguments: &Arguments,
    robots: &Robots,
    lines: &Receiver<(Instant, Line)>,
    [router, fleet]: [&Program; 2],
) -> Result<()> {
    while lines.try_recv().is_ok() {}
    let programs = [
        ("zenohd", router.0.id()),
        ("robots, operator and this measurement", std::process::id()),
        ("motorlink-fleet --json", fleet.0.id()),
    ];
    let begun = Instant::now();
    let cpu = programs.map(|(_, id)| cpu_seconds(id));
    let (bytes, wire) = (robots.bytes.load(Ordering::Relaxed), loopback_bytes());
    let (mut fewest, mut oldest_ms, mut ignored, mut count) = (usize::MAX, 0, 0, 0_u32);
    let mut oldest = Duration::ZERO;
    let mut numbers: BTreeMap<String, (u64, u64)> = BTreeMap::new();
    let mut slowest_drive = u64::MAX;
    let mut first_line = None;
    let mut last_line = begun;
    while begun.elapsed() < Duration::from_secs(arguments.seconds) {
        let (at, line) = lines.recv_timeout(PATIENCE).unwrap();
        count += 1;
        (first_line, last_line) = (first_line.or(Some(at)), at);
        fewest = fewest.min(line.heard());
        ignored = line.ignored;
        slowest_drive = slowest_drive.min(robots.drive());
        for robot in line.robots {
            oldest_ms = oldest_ms.max(robot.age_ms.unwrap_or(u64::MAX));
            let Some(State { number }) = robot.state else {
                continue;
            };
            let index: usize = robot.name[1..].parse().unwrap();
            let published = robots.published[index].lock().unwrap();
            let published = published.iter().find(|(of, _)| *of == number);
            oldest = oldest.max(at.saturating_duration_since(published.unwrap().1));
            let range = numbers.entry(robot.name).or_insert((number, number));
            range.1 = number;
        }
    }
    let elapsed = begun.elapsed().as_secs_f64();
    let states: u64 = numbers.values().map(|(first, last)| last - first).sum();
    println!("lines of the fleet client in {elapsed:.0} s: {count}");
    println!(
        "fewest robots heard in a line: {fewest} of {}",
        arguments.robots
    );
    println!(
        "fewest robots driven: {slowest_drive} of {}",
        arguments.driven
    );
    println!("longest time since a state came, by the fleet client: {oldest_ms} ms");
    println!(
        "longest age of a state when its line is read: {} ms",
        oldest.as_millis()
    );
    println!("messages ignored: {ignored}");
    println!(
        "states not sent, the network being slow: {}",
        robots.dropped.load(Ordering::Relaxed)
    );
    let between = last_line.duration_since(first_line.unwrap()).as_secs_f64();
    println!("states a second: {:.0}", states as f64 / between);
    let bytes = (robots.bytes.load(Ordering::Relaxed) - bytes) as f64 / elapsed;
    let wire = (loopback_bytes() - wire) as f64 / elapsed;
    let each = arguments.robots as f64;
    println!("bytes a second of a robot, JSON: {:.0}", bytes / each);
    println!(
        "bytes a second of a robot and hop, with Zenoh, TCP and cmd_vel: {:.0}",
        wire / each / 2.0
    );
    for ((name, id), before) in programs.iter().zip(cpu) {
        let percent = (cpu_seconds(*id) - before) / elapsed * 100.0;
        println!("{name}: {percent:.0} % of a core, {} MB", memory_mb(*id));
    }
    ensure!(fewest == arguments.robots, "not all robots were heard");
    ensure!(oldest <= STALE, "a state was older than {STALE:?}");
    Ok(())
}

fn restart(
    arguments: &Arguments,
    endpoint: &str,
    robots: &Robots,
    lines: &Receiver<(Instant, Line)>,
    router: Program,
) -> Result<()> {
    let killed = Instant::now();
    drop(router);
    while robots.turn() > 0 {
        ensure!(
            killed.elapsed() < PATIENCE,
            "{} robots drive on",
            robots.turn()
        );
        sleep(Duration::from_millis(1));
    }
    println!(
        "last wheel stands after the router was killed: {} ms",
        killed.elapsed().as_millis()
    );
    while killed.elapsed() < OUTAGE {
        ensure!(robots.turn() == 0, "a wheel turns without a router");
        sleep(Duration::from_millis(1));
    }
    println!("wheels that turn until the router is started again: 0");
    let restarted = Instant::now();
    let router = start_router(arguments, endpoint)?;
    let took = until_all_heard(lines, arguments.robots, restarted)?;
    println!("all robots heard after the router was started again: {took:.1} s");
    let begun = Instant::now();
    while robots.drive() < arguments.driven as u64 && begun.elapsed() < Duration::from_secs(5) {
        sleep(Duration::from_millis(10));
    }
    println!(
        "robots that drive again, whose operator never ceased to ask: {}",
        robots.drive()
    );
    drop(router);
    ensure!(
        took < BACK_WITHIN.as_secs_f64(),
        "not all were back within {BACK_WITHIN:?}"
    );
    Ok(())
}

/// User and system time of a process.
fn cpu_seconds(id: u32) -> f64 {
    let text = fs::read_to_string(format!("/proc/{id}/stat")).unwrap();
    // Behind the name in parentheses; the clock of the system has 100 ticks a second.
    let fields: Vec<&str> = text
        .rsplit(')')
        .next()
        .unwrap()
        .split_whitespace()
        .collect();
    let ticks: u32 = [fields[11], fields[12]]
        .iter()
        .map(|field| field.parse::<u32>().unwrap())
        .sum();
    f64::from(ticks) / 100.0
}

fn memory_mb(id: u32) -> u64 {
    let text = fs::read_to_string(format!("/proc/{id}/status")).unwrap();
    let line = text
        .lines()
        .find(|line| line.starts_with("VmRSS:"))
        .unwrap();
    line.split_whitespace()
        .nth(1)
        .unwrap()
        .parse::<u64>()
        .unwrap()
        / 1_024
}

/// What has gone through the loopback device.
fn loopback_bytes() -> u64 {
    let text = fs::read_to_string("/proc/net/dev").unwrap();
    let line = text
        .lines()
        .find(|line| line.trim_start().starts_with("lo:"))
        .unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}
