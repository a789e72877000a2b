//! The virtual motors at the far end of the wire, and commands to them.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use anyhow::{Context, Result, bail, ensure};
use rustix::process::{Pid, Signal, kill_process};

use crate::artefacts;
use crate::line::Line;
use crate::wait::{WAIT_MAX, wait_until};

/// Maximal time for the program to exit: it only removes its link.
const END_MAX: Duration = Duration::from_secs(2);

/// Running virtual motors; they end when dropped.
pub struct Motors {
    program: Child,
    node: PathBuf,
    /// The file with the program's output: `ready ..` once, then an answer to each command.
    output: PathBuf,
}

impl Motors {
    /// Starts them with their terminal at `node` and their wire log in `log`; `dir` is for their output.
    ///
    /// # Errors
    ///
    /// When the program does not start.
    pub fn start(line: &Line, node: &Path, log: &Path, dir: &Path) -> Result<Self> {
        let program = artefacts::command()?;
        let ids: Vec<String> = line.ids.iter().map(ToString::to_string).collect();
        let errors = dir.join("virtual-motor.stderr");
        let output = dir.join("virtual-motor.stdout");
        let child = Command::new(&program)
            .arg("virtual")
            .args(["--ids", &ids.join(",")])
            .args(["--turnaround-us", &line.turnaround_us.to_string()])
            .arg("--link")
            .arg(node)
            .arg("--log")
            .arg(log)
            .args(&line.extra)
            .stdin(Stdio::piped())
            .stdout(File::create(&output)?)
            .stderr(File::create(&errors)?)
            .spawn()
            .with_context(|| format!("cannot start {}", program.display()))?;
        let mut motors = Self {
            program: child,
            node: node.to_owned(),
            output,
        };
        wait_until("the virtual motors to make its node", WAIT_MAX, || {
            if let Some(status) = motors.program.try_wait()? {
                let error = fs::read_to_string(&errors).unwrap_or_default();
                bail!("{} ended, {status}: {}", program.display(), error.trim());
            }
            Ok(fs::canonicalize(node).map_err(|error| error.to_string()))
        })?;
        Ok(motors)
    }

    /// Sends a command. Returns its answer.
    pub(crate) fn send_command(&mut self, command: &str) -> Result<String> {
        let before = self.answers()?.len();
        let stdin = self.program.stdin.as_mut().context("it hears nothing")?;
        writeln!(stdin, "{command}")?;
        let answer = wait_until(&format!("an answer to {command:?}"), WAIT_MAX, || {
            let answer = self.answers()?.into_iter().nth(before);
            Ok(answer.ok_or_else(|| "nothing".to_owned()))
        })?;
        ensure!(answer.starts_with("ok"), "{command:?}: {answer}");
        Ok(answer)
    }

    /// All answers so far, without an incomplete last line.
    fn answers(&self) -> Result<Vec<String>> {
        let output = fs::read_to_string(&self.output)?;
        let lines = output
            .split_inclusive('\n')
            .filter_map(|line| line.strip_suffix('\n'));
        let answers = lines.filter(|line| line.starts_with("ok") || line.starts_with("error"));
        Ok(answers.map(str::to_owned).collect())
    }
}

impl Drop for Motors {
    fn drop(&mut self) {
        if let Some(pid) = i32::try_from(self.program.id())
            .ok()
            .and_then(Pid::from_raw)
        {
            // It may have ended already.
            let _ = kill_process(pid, Signal::TERM);
        }
        let ended = wait_until("the virtual motors to end", END_MAX, || {
            Ok(self
                .program
                .try_wait()?
                .ok_or_else(|| "it runs on".to_owned()))
        });
        if ended.is_err() {
            let _ = self.program.kill();
            let _ = self.program.wait();
        }
        // It removes its link itself, unless it was killed.
        let _ = fs::remove_file(&self.node);
    }
}
