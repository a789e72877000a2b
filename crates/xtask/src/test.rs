//! Runs the steps one after the other, with the time each took.

use std::time::{Duration, Instant};

use anyhow::{Error, Result};

use crate::steps::{STEPS, Step};
use crate::workspace::Workspace;

/// Names every step and what it checks.
pub fn list() {
    for step in &STEPS {
        println!("{:15} {}", step.name, step.about);
    }
}

/// Runs all steps, or one and those it needs, up to the first that fails.
pub fn run(workspace: &Workspace, only: Option<&Step>) -> Result<()> {
    let chosen = select(only);
    let started = Instant::now();
    let mut times = Vec::new();
    for (place, step) in chosen.iter().enumerate() {
        let of = format!("{}/{}", place + 1, chosen.len());
        println!("\n=== {of} {}: {}", step.name, step.about);
        let since = Instant::now();
        let result = (step.run)(workspace);
        times.push((step.name, since.elapsed()));
        if let Err(error) = result {
            summarise(&times, chosen.len(), started.elapsed(), Some(&error));
            return Err(error.context(format!("step {} failed", step.name)));
        }
    }
    summarise(&times, chosen.len(), started.elapsed(), None);
    Ok(())
}

fn select(only: Option<&Step>) -> Vec<&'static Step> {
    STEPS
        .iter()
        .filter(|step| {
            only.is_none_or(|only| only.name == step.name || only.needs.contains(&step.name))
        })
        .collect()
}

fn summarise(times: &[(&str, Duration)], steps: usize, total: Duration, failure: Option<&Error>) {
    println!("\n=== summary");
    for (place, (name, time)) in times.iter().enumerate() {
        let last = place + 1 == times.len();
        let word = if last && failure.is_some() {
            "FAILED"
        } else {
            "ok"
        };
        println!("{name:15} {word:6} {:>8.1} s", time.as_secs_f64());
    }
    let not_run = steps - times.len();
    let words = match (failure, not_run) {
        (None, _) => "all passed".to_owned(),
        (Some(_), 0) => "failed".to_owned(),
        (Some(_), left) => format!("failed, {left} not run"),
    };
    println!("{words}, {:.1} min", total.as_secs_f64() / 60.0);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::steps;

    #[test]
    fn one_step_brings_those_it_needs_in_order() {
        let names = |only| -> Vec<&str> {
            let only = steps::by_name(only).unwrap();
            select(Some(only)).iter().map(|step| step.name).collect()
        };
        assert_eq!(names("format"), ["format"]);
        assert_eq!(
            names("end-to-end"),
            ["build", "bench-programs", "end-to-end"]
        );
        assert_eq!(select(None).len(), STEPS.len());
    }
}
