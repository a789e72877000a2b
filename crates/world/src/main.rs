//! Plays as many stories as there is time for, or one by its seed, and prints what was found.
//!
//! `cargo xtask soak` runs it. `--seconds N` is how long it plays, 60 at first; `--from N` is the first
//! seed; `--seed N` plays that one alone and prints its acts.

use std::{
    env,
    process::ExitCode,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, bail};
use motorlink_world::{Coverage, Story, play, shrink, what_passed};

/// Lines of what passed before a rule was broken.
const PASSED_SHOWN: usize = 40;

fn main() -> ExitCode {
    match soak() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("soak: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// Whether every rule held.
fn soak() -> Result<bool> {
    let (mut seconds, mut from, mut only) = (60, 1, None);
    let mut arguments = env::args().skip(1);
    while let Some(flag) = arguments.next() {
        let number = arguments
            .next()
            .context("a number belongs behind each flag")?;
        let number: u64 = number.parse().with_context(|| format!("{flag} {number}"))?;
        match flag.as_str() {
            "--seconds" => seconds = number,
            "--from" => from = number,
            "--seed" => only = Some(number),
            _ => bail!("usage: soak [--seconds N] [--from N] [--seed N]"),
        }
    }
    if let Some(seed) = only {
        let story = Story::of(seed);
        println!("seed {seed}, with {:?}", story.motors);
        for (step, act) in story.acts.iter().enumerate() {
            println!("{step:4}  {act:?}");
        }
        return Ok(holds(&story, &mut Coverage::new()));
    }
    let until = Instant::now() + Duration::from_secs(seconds);
    let mut coverage = Coverage::new();
    let (mut seed, mut broken) = (from, 0_u64);
    while Instant::now() < until {
        broken += u64::from(!holds(&Story::of(seed), &mut coverage));
        seed += 1;
    }
    println!(
        "{} seeds from {from}, {broken} with a broken rule",
        seed - from
    );
    for (fault, times) in &coverage {
        println!("{fault:?}: {times}");
    }
    Ok(broken == 0)
}

fn holds(story: &Story, coverage: &mut Coverage) -> bool {
    let Err(failure) = play(story, coverage) else {
        return true;
    };
    let (short, last) = shrink(story, &failure);
    println!(
        "seed {}, step {}: {}",
        story.seed, failure.step, failure.violation
    );
    println!("shrunk, with {:?}: {}", short.motors, last.violation);
    for act in &short.acts {
        println!("  {act:?}");
    }
    println!("the last that passed in it:");
    for line in what_passed(&short, PASSED_SHOWN) {
        println!("  {line}");
    }
    false
}
