//! Many pages at one server: what they cost, and whether they delay the wire.

use std::{
    io::Write,
    net::TcpStream,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::Duration,
};

use anyhow::{Context, Result};
use end_to_end::{
    Gaps, Line,
    figures::{ms, ratio, row, row_without_bound},
    now_us,
};
use motorlink_bus::{BusSettings, Command, CommandRate, Consent, Counters, GroupSetpoints};
use motorlink_messages::{decode, encode};
use motorlink_protocol::{MotorId, Setpoint, SpeedTarget};
use motorlink_remote::{FromServer, ToServer};
use rustix::process::setpriority_process;
use tungstenite::Message;

use crate::{
    page::{Page, start},
    server::Server,
    stops::{live, take_and_drive},
};

/// What a page does while it is connected.
type Kind = fn(&Server, &AtomicBool);

/// How long to drive without other pages at most: long enough for a percentile.
const ALONE_MAX: Duration = Duration::from_secs(120);

/// Of a thread, on Linux.
const LEAST_PRIORITY: i32 = 19;

const WATCHERS: usize = 75;
const SLOW: usize = 20;
const HOSTILE: usize = 5;

/// Six motors at 50 Hz, and three pages.
pub fn cost() -> Result<()> {
    const LASTS: Duration = Duration::from_secs(30);
    let mut server = Server::start(&Line::with_motors(&[1, 2, 3, 4, 5, 6]), None)?;
    let mut operator = server.page()?;
    let server = Arc::new(server);
    let crowd = Crowd::start(&server, &[watch as Kind; 2]);
    let setpoint = Setpoint::velocity(SpeedTarget::new(60)?);
    let ids = (1..=6).map(MotorId::new).collect::<Result<Vec<_>, _>>()?;
    let entries: Vec<_> = ids.into_iter().map(|id| (id, setpoint)).collect();
    let setpoints = GroupSetpoints::new(&entries).ok().context("no group")?;
    let consent = Consent::None;
    take_and_drive(&mut operator, Command::StartGroup { setpoints, consent })?;
    let before = server.cost()?;
    live(&mut operator, LASTS)?;
    let after = server.cost()?;
    drop(crowd);
    let share = (after.0.saturating_sub(before.0)).as_secs_f64() / LASTS.as_secs_f64() * 100.0;
    row(
        "processor of `motorlink serve`, six motors at 50 Hz, three pages",
        "10 % of a core",
        format!("{share:.1} %"),
        share <= 10.0,
    );
    let megabytes = ratio(after.1, 1_000_000);
    row(
        "memory of `motorlink serve`, six motors, three pages",
        "60 MB",
        format!("{megabytes:.1} MB"),
        megabytes <= 60.0,
    );
    Ok(())
}

/// Drives one motor at 500 Hz alone, and then with a hundred pages more.
pub fn many_viewers(lasts: Duration) -> Result<()> {
    let line = Line {
        turnaround_us: 100,
        ..Line::default()
    };
    let mut server = Server::start(&line, None)?;
    let mut operator = server.page()?;
    let server = Arc::new(server);
    operator.take_control();
    operator.act(Command::Configure(BusSettings {
        rate: CommandRate::new(500)?,
        ..BusSettings::default()
    }));
    take_and_drive(&mut operator, start())?;
    live(&mut operator, Duration::from_secs(1))?;
    let alone = drive(&server, &mut operator, lasts.min(ALONE_MAX))?;
    let kinds: [(Kind, usize); 3] = [(watch, WATCHERS), (watch_slowly, SLOW), (attack, HOSTILE)];
    let pages: Vec<_> = kinds
        .into_iter()
        .flat_map(|(kind, count)| std::iter::repeat_n(kind, count))
        .collect();
    let crowd = Crowd::start(&server, &pages);
    live(&mut operator, Duration::from_secs(2))?;
    let crowded = drive(&server, &mut operator, lasts)?;
    drop(crowd);
    let figure = "one motor at the 500 Hz setting, an operator and 100 pages (20 slow, 5 hostile)";
    let seconds = lasts.as_secs();
    row(
        &format!("{figure}: exchanges lost in {seconds} s"),
        "0",
        format!(
            "{} of {} (without other pages {} of {})",
            crowded.lost, crowded.gaps.count, alone.lost, alone.gaps.count
        ),
        crowded.lost == 0 && crowded.held,
    );
    row_without_bound(
        &format!("{figure}: exchanges that this computer was too late for, in {seconds} s"),
        format!(
            "{} (without other pages {} in {} s)",
            crowded.not_asked,
            alone.not_asked,
            lasts.min(ALONE_MAX).as_secs()
        ),
    );
    let later_us = crowded.gaps.p99_us.saturating_sub(alone.gaps.p99_us);
    row(
        &format!("{figure}: gap between drive frames, p99, against no other page"),
        "0.3 ms more",
        format!(
            "{:.3} ms more ({:.3} against {:.3} ms; longest {} against {})",
            ratio(later_us, 1_000),
            ratio(crowded.gaps.p99_us, 1_000),
            ratio(alone.gaps.p99_us, 1_000),
            ms(crowded.gaps.max_us),
            ms(alone.gaps.max_us)
        ),
        later_us <= 300,
    );
    Ok(())
}

/// What was seen while a motor was driven.
struct Drive {
    gaps: Gaps,
    lost: u64,
    not_asked: u64,
    /// Whether the operator has held the lease all the time.
    held: bool,
}

fn drive(server: &Server, operator: &mut Page, lasts: Duration) -> Result<Drive> {
    let before = counters(operator)?;
    let from = now_us();
    let held = live(operator, lasts)?;
    let to = now_us();
    let gaps = server.wire()?.since(from).until(to).drives().gaps();
    let after = counters(operator)?;
    Ok(Drive {
        gaps: gaps.context("no drive frames: the operator has lost the lease")?,
        lost: after.lost() - before.lost(),
        not_asked: after.not_asked - before.not_asked,
        held,
    })
}

fn counters(page: &Page) -> Result<Counters> {
    let update = page.update.as_ref().context("no state")?;
    let motor = update.motors.first().context("no motor")?;
    Ok(motor.counters)
}

/// Pages on threads of their own, until dropped.
struct Crowd {
    is_over: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl Crowd {
    fn start(server: &Arc<Server>, pages: &[Kind]) -> Self {
        let is_over = Arc::new(AtomicBool::new(false));
        let threads = pages.iter().map(|page| {
            let (server, is_over, page) = (Arc::clone(server), Arc::clone(&is_over), *page);
            thread::spawn(move || {
                // They stand for other computers: what they compute delays no motor here, if the system allows it.
                let _ = setpriority_process(None, LEAST_PRIORITY);
                while !is_over.load(Ordering::Relaxed) {
                    page(&server, &is_over);
                    thread::sleep(Duration::from_millis(100));
                }
            })
        });
        Self {
            threads: threads.collect(),
            is_over,
        }
    }
}

impl Drop for Crowd {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// Takes all that comes, and answers challenges.
fn watch(server: &Server, is_over: &AtomicBool) {
    watch_with(server, is_over, Duration::ZERO);
}

/// Takes a message every second.
fn watch_slowly(server: &Server, is_over: &AtomicBool) {
    watch_with(server, is_over, Duration::from_secs(1));
}

fn watch_with(server: &Server, is_over: &AtomicBool, pause: Duration) {
    /// Challenges are short. To decode what else comes costs more than the server may.
    const CHALLENGE_MAX: usize = 16;
    let Ok(mut page) = server.connect() else {
        return;
    };
    while !is_over.load(Ordering::Relaxed) {
        let bytes = match page.socket.read() {
            Ok(Message::Binary(bytes)) => bytes,
            Ok(_) => continue,
            Err(tungstenite::Error::Io(error))
                if error.kind() == std::io::ErrorKind::WouldBlock =>
            {
                continue;
            }
            Err(_) => return,
        };
        if bytes.len() <= CHALLENGE_MAX
            && let Ok(FromServer::Challenge(challenge)) = decode(&bytes)
        {
            page.send(&ToServer::Answer { challenge });
        }
        thread::sleep(pause);
    }
}

/// Each attack of a hostile page, one after the other.
fn attack(server: &Server, is_over: &AtomicBool) {
    let attacks: [fn(&mut Page); 4] = [
        |page| {
            let _ = page.socket.send(Message::binary(vec![0xFF; 64]));
        },
        |page| {
            let _ = page.socket.send(Message::binary(vec![0; 2_000_000]));
        },
        |page| {
            let answer = encode(&ToServer::Answer { challenge: 1 }).unwrap_or_default();
            while page.socket.send(Message::binary(answer.clone())).is_ok() {}
        },
        |page| {
            for _ in 0..500 {
                page.act(start());
                // It asks, and does not take: who has the link may take control by a second press.
                page.send(&ToServer::Take { by_force: false });
                thread::sleep(Duration::from_millis(4));
            }
        },
    ];
    for attack in attacks {
        if is_over.load(Ordering::Relaxed) {
            return;
        }
        if let Ok(mut page) = server.connect() {
            attack(&mut page);
        }
        for _ in 0..20 {
            if let Ok(mut stream) = TcpStream::connect(server.address()) {
                let _ = stream.write_all(b"GET /motorlink HTTP/1.1\r\nHost: evil\r\n\r\n");
            }
        }
        thread::sleep(Duration::from_millis(200));
    }
}
