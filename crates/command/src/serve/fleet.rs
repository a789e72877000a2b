//! The robots of `serve --fleet`: what `motorlink-fleet` tells, line by line.

use std::{
    io::{BufRead as _, BufReader, Read as _},
    process::{Child, Stdio},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    thread,
    time::Duration,
};

use motorlink_remote_server::Fleet;

use crate::{failure::Failure, fleet, output::say};

/// A line for ten thousand robots with four motors each is shorter.
const LINE_MAX: u64 = 32 << 20;
/// How soon it is started again at first. The pause doubles until it tells something.
const AGAIN: Duration = Duration::from_secs(1);
const AGAIN_MAX: Duration = Duration::from_secs(60);

/// Tells what the program tells, until dropped.
pub struct Watched {
    newest: Fleet,
    program: Program,
}

/// The running program; `None` once the server ends.
type Program = Arc<Mutex<Option<Child>>>;

fn lock(program: &Program) -> MutexGuard<'_, Option<Child>> {
    program.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Watched {
    /// Starts the program. `router` is empty for the usual one.
    ///
    /// # Errors
    /// It is missing.
    pub fn start(router: String) -> Result<Self, Failure> {
        let newest = Fleet::default();
        let program = Arc::new(Mutex::new(Some(started(&router)?)));
        let (to, running) = (newest.clone(), Arc::clone(&program));
        thread::spawn(move || watch(&to, &running, &router));
        Ok(Self { newest, program })
    }

    /// What it tells.
    pub fn newest(&self) -> Fleet {
        self.newest.clone()
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        if let Some(mut child) = lock(&self.program).take() {
            // It has ended by itself.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// The program ends with its standard input: also if this one is killed.
fn started(router: &str) -> Result<Child, Failure> {
    let mut program = fleet::program();
    program.args(["--json", "--until-stdin-ends"]);
    if !router.is_empty() {
        program.args(["--connect", router]);
    }
    program.stdin(Stdio::piped()).stdout(Stdio::piped());
    // Ctrl-C is for the server, which ends the program.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut program, 0);
    program.spawn().map_err(fleet::not_started)
}

/// Passes the lines on, and starts the program again when it ends.
fn watch(to: &Fleet, program: &Program, router: &str) {
    let mut pause = AGAIN;
    loop {
        let Some(stdout) = lock(program).as_mut().map(|child| child.stdout.take()) else {
            return;
        };
        let mut lines = stdout.map(BufReader::new);
        while let Some(line) = lines.as_mut().and_then(next_line) {
            pause = AGAIN;
            to.tell(line);
        }
        if let Some(child) = lock(program).as_mut() {
            // It may still run, without an output.
            let _ = child.kill();
            let _ = child.wait();
        }
        if lock(program).is_none() {
            return;
        }
        let seconds = pause.as_secs();
        say(format_args!(
            "motorlink-fleet has ended. It is started again in {seconds} s"
        ));
        thread::sleep(pause);
        pause = (pause * 2).min(AGAIN_MAX);
        let mut running = lock(program);
        let Some(child) = running.as_mut() else {
            return;
        };
        match started(router) {
            Ok(again) => *child = again,
            Err(failure) => say(failure),
        }
    }
}

/// The next line. `None` at the end, and after one that is too long.
fn next_line(lines: &mut BufReader<impl std::io::Read>) -> Option<Vec<u8>> {
    let mut line = Vec::new();
    lines.take(LINE_MAX).read_until(b'\n', &mut line).ok()?;
    line.ends_with(b"\n").then_some(line)
}
