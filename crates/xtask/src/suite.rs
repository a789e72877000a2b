//! A suite of steps, which run one after the other and stop at the first that fails.

use std::env;
use std::ffi::OsStr;
use std::fmt;
use std::fs;
use std::iter;
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};

use crate::command_line::Selection;
use crate::failure::BadInput;
use crate::process;
use crate::workspace::Workspace;

/// One step of a suite.
#[derive(Debug)]
pub struct Step {
    /// The name for `--only`.
    pub name: &'static str,
    /// What it shows when it passes.
    pub about: &'static str,
    /// Steps whose results it uses. They come earlier in the suite.
    pub needs: &'static [&'static str],
    /// An earlier step that leaves processors idle: in a whole run this one runs meanwhile.
    pub beside: Option<&'static str>,
    /// Its niceness beside the other. Programs that drive motors in real time need a low one.
    pub nice: u8,
    /// Whether it runs only where `--only` or `--with` names it.
    pub on_request: bool,
    /// Runs it.
    pub run: fn(&Workspace) -> Result<()>,
}

/// Steps in the order in which they run.
#[derive(Debug)]
pub struct Suite {
    /// The subcommand that runs it.
    pub name: &'static str,
    /// Its steps.
    pub steps: &'static [Step],
}

/// A step that ran.
struct Ended {
    name: &'static str,
    took: Duration,
    /// Seconds on processors, of its programs and of those that ended beside it; unknown off Linux.
    processor: Option<f64>,
    result: Result<()>,
}

impl Ended {
    /// Runs a step.
    fn after(name: &'static str, run: impl FnOnce() -> Result<()>) -> Self {
        let started = Instant::now();
        let before = processor_seconds();
        let result = run();
        let took = started.elapsed();
        let processor = processor_seconds()
            .zip(before)
            .map(|(now, then)| now - then);
        let ended = Self {
            name,
            took,
            processor,
            result,
        };
        println!("=== {ended}");
        ended
    }
}

impl fmt::Display for Ended {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let result = if self.result.is_ok() { "ok" } else { "FAILED" };
        let seconds = self.took.as_secs_f64();
        write!(f, "{:22} {result:6} {seconds:>8.1} s", self.name)?;
        match self.processor {
            Some(processor) => write!(f, ", {processor:>8.1} s of processor"),
            None => Ok(()),
        }
    }
}

/// What the programs that this one started and that have ended took of the processors.
fn processor_seconds() -> Option<f64> {
    const TICKS_PER_SECOND: f64 = 100.0;
    let stat = fs::read_to_string("/proc/self/stat").ok()?;
    // Behind the name, which may have spaces: the times of ended children are fields 16 and 17 of proc(5).
    let (_, fields) = stat.rsplit_once(')')?;
    let mut times = fields.split_whitespace().skip(13).map(str::parse::<u32>);
    let (user, system) = (times.next()?.ok()?, times.next()?.ok()?);
    Some((f64::from(user) + f64::from(system)) / TICKS_PER_SECOND)
}

impl Suite {
    /// Does what the command line asks: prints the names of the steps, or runs all steps, or one and
    /// those it needs.
    ///
    /// # Errors
    ///
    /// For a name that no step has, and for the first step that fails.
    pub fn run(&self, workspace: &Workspace, selection: &Selection) -> Result<()> {
        if selection.list {
            self.list();
            return Ok(());
        }
        let named = |name: &Option<String>| name.as_deref().map(|name| self.step(name)).transpose();
        let (only, with) = (named(&selection.only)?, named(&selection.with)?);
        self.run_steps(workspace, &self.select(only, with))
    }

    /// Prints each step and what it shows.
    fn list(&self) {
        for step in self.steps {
            let when = if step.on_request {
                " (only by --only or --with)"
            } else {
                ""
            };
            println!("{:22} {}{when}", step.name, step.about);
        }
    }

    fn step(&self, name: &str) -> Result<&'static Step> {
        let step = self.steps.iter().find(|step| step.name == name);
        let unknown = || BadInput(format!("no step {name:?}: --list prints their names")).into();
        step.ok_or_else(unknown)
    }

    fn select(&self, only: Option<&Step>, with: Option<&Step>) -> Vec<&'static Step> {
        let is_selected = |step: &&Step| {
            only.map_or(!step.on_request, |only| {
                only.name == step.name || only.needs.contains(&step.name)
            }) || with.is_some_and(|with| with.name == step.name)
        };
        self.steps.iter().filter(is_selected).collect()
    }

    /// Runs steps up to the first that fails.
    fn run_steps(&self, workspace: &Workspace, selected: &[&Step]) -> Result<()> {
        let started = Instant::now();
        let mut ended: Vec<Ended> = Vec::new();
        for step in selected {
            if ended.iter().any(|ended| ended.name == step.name) {
                continue;
            }
            println!("\n=== {}: {}", step.name, step.about);
            let run = || (step.run)(workspace);
            ended.extend(self.run_with_others(selected, step, &run));
            if ended.iter().any(|ended| ended.result.is_err()) {
                break;
            }
        }
        println!("\n=== summary");
        for ended in &ended {
            println!("{ended}");
        }
        let minutes = started.elapsed().as_secs_f64() / 60.0;
        let not_run = selected.len() - ended.len();
        println!("{minutes:.1} min, {not_run} not run");
        ended
            .into_iter()
            .try_for_each(|Ended { name, result, .. }| {
                result.with_context(|| format!("step {name} failed"))
            })
    }

    /// Runs a step by `run`, and meanwhile those that are beside it, one after the other.
    fn run_with_others(
        &self,
        selected: &[&Step],
        step: &Step,
        run: &dyn Fn() -> Result<()>,
    ) -> Vec<Ended> {
        let others = || -> Vec<Ended> {
            let beside = selected
                .iter()
                .filter(|other| other.beside == Some(step.name));
            let run =
                |other: &&Step| self.run_with_others(selected, other, &|| self.run_captured(other));
            beside.flat_map(run).collect()
        };
        thread::scope(|scope| {
            let others = scope.spawn(others);
            let own = Ended::after(step.name, run);
            let others = others.join();
            let others = others.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            iter::once(own).chain(others).collect()
        })
    }

    /// Runs a step beside another, and prints what it printed once it has ended.
    fn run_captured(&self, step: &Step) -> Result<()> {
        let program = env::current_exe().context("no program to run beside this one")?;
        let mut program = low_priority(&program, step.nice);
        let (_, passed) = process::run_captured(program.args([self.name, "--only", step.name]));
        passed
    }
}

/// This program, on the processor time that nobody else wants, where the system has such a thing.
///
/// # Errors
///
/// When it has no file.
pub fn idle_program() -> Result<Command> {
    let program = env::current_exe().context("no program to run beside this one")?;
    Ok(idle(&Command::new(program)))
}

/// The same command, on the processor time that nobody else wants, where the system has such a thing.
pub fn idle(command: &Command) -> Command {
    let mut idle = Command::new("chrt");
    if cfg!(target_os = "linux") {
        idle.args(["--idle", "0"]).arg(command.get_program());
    } else {
        idle = Command::new(command.get_program());
    }
    process::like(idle, command)
}

/// A program of this niceness: a higher one gets less processor time while others want it.
pub fn low_priority(program: impl AsRef<OsStr>, nice: u8) -> Command {
    if cfg!(windows) {
        return Command::new(program);
    }
    let mut command = Command::new("nice");
    command.arg("-n").arg(nice.to_string()).arg(program);
    command
}

/// The same command at the niceness of what computes beside tests in real time.
pub fn patient(command: &Command) -> Command {
    process::like(low_priority(command.get_program(), 10), command)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{check, test};

    #[test]
    fn names_are_unique_and_needs_come_earlier() {
        for suite in [&check::SUITE, &test::SUITE] {
            for (index, step) in suite.steps.iter().enumerate() {
                assert!(std::ptr::eq(suite.step(step.name).unwrap(), step));
                for need in step.needs.iter().chain(&step.beside) {
                    let earlier = &suite.steps[..index];
                    let found = earlier.iter().any(|step| step.name == *need);
                    assert!(found, "{} needs {need}", step.name);
                }
            }
        }
    }

    #[test]
    fn an_unknown_name_is_an_error() {
        let error = test::SUITE.step("luck").unwrap_err();
        assert!(error.is::<BadInput>() && error.to_string().contains("--list"));
        assert!(test::SUITE.step("format").is_err());
    }

    #[test]
    fn one_step_brings_those_it_needs_in_order() {
        let names = |only| -> Vec<&str> {
            let only = test::SUITE.step(only).unwrap();
            let steps = test::SUITE.select(Some(only), None);
            steps.iter().map(|step| step.name).collect()
        };
        assert_eq!(names("native"), ["native"]);
        assert_eq!(names("end-to-end"), ["build", "end-to-end"]);
        let is_usual = |name: &str| {
            let usual = test::SUITE.select(None, None);
            usual.iter().any(|step| step.name == name)
        };
        let checks = test::SUITE.step("checks").unwrap();
        let with_checks = test::SUITE.select(None, Some(checks));
        assert_eq!(
            with_checks.len(),
            test::SUITE.select(None, None).len() + 1,
            "--with adds a step"
        );
        for step in test::SUITE.steps {
            assert_eq!(is_usual(step.name), !step.on_request, "{}", step.name);
            assert!(names(step.name).contains(&step.name));
        }
    }
}
