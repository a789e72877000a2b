//! Plays as many stories as there is time for, or one by its seed, and prints what was found.
//!
//! `cargo xtask soak` runs it, and prints a table of what was found. `--seconds N` is how long it plays, 60 at
//! first, and `--seeds N` how many worlds instead; `--from N` is the first seed; `--seed N` plays that one alone
//! and prints its acts, and what passed before a rule was broken.

use std::{
    env,
    ops::Range,
    process::ExitCode,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, bail};
use motorlink_world::{Coverage, Rule, Story, play, shrink, what_passed};

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
    let (mut seconds, mut seeds, mut from, mut only) = (60, u64::MAX, 1, None);
    let mut arguments = env::args().skip(1);
    while let Some(flag) = arguments.next() {
        let number = arguments
            .next()
            .context("a number belongs behind each flag")?;
        let number: u64 = number.parse().with_context(|| format!("{flag} {number}"))?;
        match flag.as_str() {
            "--seconds" => seconds = number,
            "--seeds" => (seeds, seconds) = (number, u64::from(u32::MAX)),
            "--from" => from = number,
            "--seed" => only = Some(number),
            _ => bail!("usage: soak [--seconds N | --seeds N] [--from N] [--seed N]"),
        }
    }
    if let Some(seed) = only {
        let story = Story::of(seed);
        println!("seed {seed}, with {:?}", story.motors);
        for (step, act) in story.acts.iter().enumerate() {
            println!("{step:4}  {act:?}");
        }
        return Ok(holds(&story, &mut Coverage::default()));
    }
    let until = Instant::now() + Duration::from_secs(seconds);
    let mut coverage = Coverage::default();
    let (mut seed, mut broken) = (from, 0_u64);
    while seed - from < seeds && Instant::now() < until {
        broken += u64::from(!holds(&Story::of(seed), &mut coverage));
        seed += 1;
    }
    print_table(from..seed, broken, &coverage);
    Ok(broken == 0)
}

/// In the form of the tables of the documents.
fn print_table(seeds: Range<u64>, broken: u64, coverage: &Coverage) {
    let yes = |is| if is { "yes" } else { "NO" };
    println!("| figure | must | measured | reached |");
    println!("|---|---|---|---|");
    println!(
        "| worlds that fail, {} rules after every step | no rule broken | {} seeds from {}, {broken} with a broken rule | {} |",
        Rule::ALL.len(),
        seeds.end - seeds.start,
        seeds.start,
        yes(broken == 0)
    );
    for rule in Rule::ALL {
        let times = coverage.judged.get(&rule).copied().unwrap_or(0);
        println!(
            "| rule `{rule:?}` | had something to judge 100 times or more | {times} times | {} |",
            yes(times >= 100)
        );
    }
    for (fault, times) in &coverage.faults {
        println!(
            "| fault `{fault:?}` | 100 times or more | {times} times | {} |",
            yes(*times >= 100)
        );
    }
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
