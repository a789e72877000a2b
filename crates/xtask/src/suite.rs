//! A suite of steps, which run one after the other and stop at the first that fails.

use std::time::{Duration, Instant};

use anyhow::{Error, Result};

use crate::command_line::Selection;
use crate::failure::BadInput;
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
    /// Whether it runs only where `--only` names it: it installs much.
    pub on_request: bool,
    /// Runs it.
    pub run: fn(&Workspace) -> Result<()>,
}

/// Steps in the order in which they run.
#[derive(Debug)]
pub struct Suite(pub &'static [Step]);

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
        let only = selection.only.as_deref();
        let only = only.map(|name| self.step(name)).transpose()?;
        run_steps(workspace, &self.select(only))
    }

    /// Prints each step and what it shows.
    fn list(&self) {
        for step in self.0 {
            let when = if step.on_request {
                " (only by --only)"
            } else {
                ""
            };
            println!("{:18} {}{when}", step.name, step.about);
        }
    }

    fn step(&self, name: &str) -> Result<&'static Step> {
        let step = self.0.iter().find(|step| step.name == name);
        let unknown = || BadInput(format!("no step {name:?}: --list prints their names")).into();
        step.ok_or_else(unknown)
    }

    fn select(&self, only: Option<&Step>) -> Vec<&'static Step> {
        let is_selected = |step: &&Step| {
            only.map_or(!step.on_request, |only| {
                only.name == step.name || only.needs.contains(&step.name)
            })
        };
        self.0.iter().filter(is_selected).collect()
    }
}

/// Runs steps up to the first that fails.
fn run_steps(workspace: &Workspace, selected: &[&Step]) -> Result<()> {
    let started = Instant::now();
    let mut times = Vec::new();
    for (index, step) in selected.iter().enumerate() {
        let place = format!("{}/{} {}", index + 1, selected.len(), step.name);
        println!("\n=== {place}: {}", step.about);
        let step_started = Instant::now();
        let result = (step.run)(workspace);
        let took = step_started.elapsed();
        times.push((step.name, took));
        if let Err(error) = result {
            print_summary(&times, selected.len(), started.elapsed(), Some(&error));
            return Err(error.context(format!("step {} failed", step.name)));
        }
        println!("=== {place}: ok, {:.1} s", took.as_secs_f64());
    }
    print_summary(&times, selected.len(), started.elapsed(), None);
    Ok(())
}

fn print_summary(
    times: &[(&str, Duration)],
    step_count: usize,
    total: Duration,
    failure: Option<&Error>,
) {
    println!("\n=== summary");
    for (index, (name, time)) in times.iter().enumerate() {
        let is_last = index + 1 == times.len();
        let result = if is_last && failure.is_some() {
            "FAILED"
        } else {
            "ok"
        };
        println!("{name:18} {result:6} {:>8.1} s", time.as_secs_f64());
    }
    let result = match (failure, step_count - times.len()) {
        (None, _) => "all passed".to_owned(),
        (Some(_), 0) => "failed".to_owned(),
        (Some(_), not_run) => format!("failed, {not_run} not run"),
    };
    println!("{result}, {:.1} min", total.as_secs_f64() / 60.0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{check, test};

    #[test]
    fn names_are_unique_and_needs_come_earlier() {
        for suite in [&check::SUITE, &test::SUITE] {
            for (index, step) in suite.0.iter().enumerate() {
                assert!(std::ptr::eq(suite.step(step.name).unwrap(), step));
                for need in step.needs {
                    let earlier = &suite.0[..index];
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
            let steps = test::SUITE.select(Some(only));
            steps.iter().map(|step| step.name).collect()
        };
        assert_eq!(names("native"), ["native"]);
        assert_eq!(names("end-to-end"), ["build", "end-to-end"]);
        let is_usual = |name: &str| {
            let usual = test::SUITE.select(None);
            usual.iter().any(|step| step.name == name)
        };
        for step in test::SUITE.0 {
            assert_eq!(is_usual(step.name), !step.on_request, "{}", step.name);
            assert!(names(step.name).contains(&step.name));
        }
    }
}
