//! Figures of the native driver on virtual motors at a pseudo-terminal, by the log of their wire:
//! `cargo xtask bench driver`.

use std::{
    error::Error,
    fs,
    io::{Read, Write},
    path::Path,
    process::{Child, Command as Process},
    thread::sleep,
    time::{Duration, Instant},
};

use motorlink_bus::{Command, Consent, GroupSetpoints};
use motorlink_driver::{Driver, Next};
use motorlink_protocol::{MotorId, Request, Setpoint, SpeedTarget};

use motors::Motors;

mod motors;

type Done<T> = Result<T, Box<dyn Error>>;

/// Fields of `/proc/PID/stat` before the two times of the processor, behind the name.
const FIELDS_BEFORE_TIMES: usize = 11;
/// `/proc/PID/stat` counts in hundredths of a second on every Linux.
const TICK: Duration = Duration::from_millis(10);

fn main() -> Done<()> {
    for turnaround_us in [600, 100] {
        full_speed(turnaround_us)?;
    }
    gaps_of_one()?;
    gaps_of_six()?;
    cost()?;
    ways_out()
}

/// A row of docs/performance.md.
fn row(figure: &str, must: &str, measured: &str, is_reached: bool) {
    let reached = if is_reached { "yes" } else { "NO" };
    println!("| {figure} | {must} | {measured} | {reached} |");
}

fn speed(rpm: i32) -> Done<Setpoint> {
    Ok(Setpoint::velocity(SpeedTarget::new(rpm)?))
}

/// Takes entries for so long.
fn run(driver: &Driver, lasts: Duration) {
    let until = Instant::now() + lasts;
    while Instant::now() < until {
        let _: Next = driver.next(Duration::from_millis(20));
    }
}

/// Exchanges a second at the highest rate, beside a loop that only writes a frame and reads ten bytes. A motor takes no more
/// than 500 frames a second, so neither sends more.
fn full_speed(turnaround_us: u64) -> Done<()> {
    const LASTS: Duration = Duration::from_secs(5);
    const PERIOD: Duration = Duration::from_micros(2_010);
    let turnaround = turnaround_us.to_string();
    let motors = Motors::start(&["--turnaround-us", &turnaround])?;
    let bare = {
        let mut port = serialport::new(motors.port(), 115_200)
            .timeout(Duration::from_secs(1))
            .open()?;
        let frame = Request::drive(MotorId::FIRST, speed(50)?).frame();
        let begun = Instant::now();
        let mut exchanges = 0_u32;
        while begun.elapsed() < LASTS {
            let next = Instant::now() + PERIOD;
            port.write_all(frame.bytes())?;
            port.read_exact(&mut [0; 10])?;
            exchanges += 1;
            sleep(next.saturating_duration_since(Instant::now()));
        }
        exchanges
    };
    drop(motors);
    let motors = Motors::start(&["--turnaround-us", &turnaround])?;
    let driver = motors.driver(500, &[1])?;
    driver.command(Command::Start {
        id: MotorId::FIRST,
        setpoint: speed(50)?,
        consent: Consent::None,
    });
    run(&driver, Duration::from_secs(1));
    let before = driver.status().map_or(0, |status| replies(&status));
    run(&driver, LASTS);
    let after = driver.status().map_or(0, |status| replies(&status));
    let exchanges = u32::try_from(after.saturating_sub(before))?;
    let _ = driver.end();
    let a_second = |count: u32| f64::from(count) / LASTS.as_secs_f64();
    let (bare, native) = (a_second(bare), a_second(exchanges));
    row(
        &format!(
            "exchanges a second of the native driver at the 500 Hz setting, one motor, {turnaround_us} us turnaround, against a bare loop"
        ),
        "0.98 or more",
        &format!("{:.3} ({native:.0} of {bare:.0} a second)", native / bare),
        native / bare >= 0.98,
    );
    Ok(())
}

fn replies(status: &motorlink_driver::Status) -> u64 {
    status
        .motors
        .iter()
        .map(|motor| motor.counters.replies)
        .sum()
}

/// Times between the drive frames of each motor in milliseconds, without those around start and stop: the 99th percentile
/// and the longest.
fn gaps(motors: &Motors) -> Done<(f64, f64)> {
    let mut gaps = Vec::new();
    for times in motors.drive_frames()?.values() {
        let from = times.first().map_or(0, |first| first + 500_000);
        let to = times
            .last()
            .map_or(0, |last| last.saturating_sub(1_000_000));
        let steady: Vec<u64> = times
            .iter()
            .copied()
            .filter(|at| (from..to).contains(at))
            .collect();
        let pairs = steady.iter().zip(steady.iter().skip(1));
        for (before, after) in pairs {
            gaps.push(f64::from(u32::try_from(after - before)?) / 1000.0);
        }
    }
    gaps.sort_by(f64::total_cmp);
    let p99 = gaps.get(gaps.len() * 99 / 100).copied();
    let longest = gaps.last().copied();
    p99.zip(longest).ok_or_else(|| "no drive frames".into())
}

fn gaps_of_one() -> Done<()> {
    let motors = Motors::start(&[])?;
    let driver = motors.driver(50, &[1])?;
    driver.command(Command::Start {
        id: MotorId::FIRST,
        setpoint: speed(50)?,
        consent: Consent::None,
    });
    run(&driver, Duration::from_secs(20));
    let _ = driver.end();
    let (p99, longest) = gaps(&motors)?;
    let figure = "gap between drive frames of the native driver at 50 Hz, p99 of 20 s";
    row(
        figure,
        "20.5 ms",
        &format!("{p99:.2} ms, longest {longest:.2} ms"),
        p99 <= 20.5,
    );
    Ok(())
}

fn gaps_of_six() -> Done<()> {
    let motors = Motors::start(&["--ids", "1,2,3,4,5,6", "--turnaround-us", "100"])?;
    let driver = motors.driver(50, &[1, 2, 3, 4, 5, 6])?;
    let setpoint = speed(50)?;
    let ids = (1..=6).map(MotorId::new).collect::<Result<Vec<_>, _>>()?;
    let entries: Vec<_> = ids.into_iter().map(|id| (id, setpoint)).collect();
    let setpoints = GroupSetpoints::new(&entries).map_err(|error| error.to_string())?;
    driver.command(Command::StartGroup {
        setpoints,
        consent: Consent::None,
    });
    run(&driver, Duration::from_secs(60));
    let _ = driver.end();
    let (p99, longest) = gaps(&motors)?;
    let figure = "gap between drive frames of the native driver to each of six motors at 50 Hz with queries, longest of 60 s";
    row(
        figure,
        "30 ms",
        &format!("{longest:.1} ms, p99 {p99:.1} ms"),
        longest <= 30.0,
    );
    Ok(())
}

/// Processor and memory of a drive of ten seconds.
fn cost() -> Done<()> {
    const LASTS: Duration = Duration::from_secs(10);
    let motors = Motors::start(&[])?;
    let mut drive = motors.command("drive velocity 50").spawn()?;
    sleep(Duration::from_secs(2));
    let process = Path::new("/proc").join(drive.id().to_string());
    let before = processor_time(&process)?;
    sleep(LASTS);
    let used = processor_time(&process)?.saturating_sub(before);
    let status = fs::read_to_string(process.join("status"))?;
    let most = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib: u32 = most
        .and_then(|most| most.trim().split(' ').next())
        .ok_or("no VmHWM")?
        .parse()?;
    interrupt(&drive)?;
    drive.wait()?;
    let share = used.as_secs_f64() / LASTS.as_secs_f64() * 100.0;
    let megabytes = f64::from(kib) * 1024.0 / 1e6;
    row(
        "processor of `motorlink drive`, one motor at 50 Hz",
        "2 % of a core",
        &format!("{share:.1} %"),
        share <= 2.0,
    );
    row(
        "memory of `motorlink drive`, most",
        "20 MB",
        &format!("{megabytes:.1} MB"),
        megabytes <= 20.0,
    );
    Ok(())
}

fn processor_time(process: &Path) -> Done<Duration> {
    let stat = fs::read_to_string(process.join("stat"))?;
    let (_, fields) = stat.rsplit_once(") ").ok_or("no name")?;
    let times = fields.split(' ').skip(FIELDS_BEFORE_TIMES).take(2);
    let ticks = times.map(str::parse::<u32>).sum::<Result<u32, _>>()?;
    Ok(TICK * ticks)
}

fn interrupt(child: &Child) -> Done<()> {
    let status = Process::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()?;
    status
        .success()
        .then_some(())
        .ok_or_else(|| "kill failed".into())
}

/// From a signal, and after a killed process from the next start, to a standstill that is confirmed.
fn ways_out() -> Done<()> {
    let mut signal = Vec::new();
    let mut next_start = Vec::new();
    for _ in 0..5 {
        let motors = Motors::start(&[])?;
        let mut drive = motors.command("drive velocity 100").spawn()?;
        sleep(Duration::from_millis(2_500));
        let begun = Instant::now();
        interrupt(&drive)?;
        if !drive.wait()?.success() {
            return Err("the stop was not confirmed".into());
        }
        signal.push(begun.elapsed());

        let mut drive = motors.command("drive velocity 100").spawn()?;
        sleep(Duration::from_millis(2_500));
        drive.kill()?;
        drive.wait()?;
        let begun = Instant::now();
        if !motors.command("info").status()?.success() {
            return Err("the next start did not confirm".into());
        }
        next_start.push(begun.elapsed());
    }
    let worst = |times: &[Duration]| times.iter().max().copied().unwrap_or_default();
    let (signal, next_start) = (worst(&signal), worst(&next_start));
    row(
        "`motorlink drive` at 100 rpm, firmware that keeps its command: from a signal to the end with a confirmed standstill, worst of 5",
        "400 ms",
        &format!("{} ms", signal.as_millis()),
        signal <= Duration::from_millis(400),
    );
    row(
        "the same after SIGKILL: from the next start to its end with a confirmed standstill, worst of 5",
        "1,500 ms",
        &format!("{} ms", next_start.as_millis()),
        next_start <= Duration::from_millis(1_500),
    );
    Ok(())
}
