//! Plays scenarios for a given time, or one by its seed, and prints the broken rules.
//!
//! `cargo xtask soak` runs it and prints a table of the results. `--seconds N` is the duration, 60
//! by default; `--seeds N` is a number of scenarios instead; `--from N` is the first seed; `--seed
//! N` plays that one alone and prints its actions, and a trace if a rule is broken. Of the seeds
//! that break the same rule only the first is shrunk. `--model M` is the model of the motors; without it every
//! model has its turn, each with the time or number of scenarios. `--when-silent keep`, `coast` or `brake` is their
//! firmware; without it each seed draws it. `--lines hostile` adds random parts of echoes, a byte beside replies, blocks of
//! 32 bytes and floating pairs. `--play driver` plays the native driver on computers that fail instead.

use std::{
    collections::BTreeMap,
    env,
    ops::Range,
    panic::resume_unwind,
    process::ExitCode,
    sync::atomic::{AtomicU64, Ordering},
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, bail};
use motorlink_fault_simulation::{Coverage, Failure, Rule, Scenario, play, shrink, trace_lines};
use motorlink_protocol::family::Model;
use motorlink_simulator::WhenSilent;
use strum::VariantArray;

mod driver_soak;

/// Lines of the trace before a broken rule.
const TRACE_SHOWN: usize = 40;

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

/// Whether every rule held for every model.
fn soak() -> Result<bool> {
    let (mut seconds, mut seeds, mut from, mut only) = (60, u64::MAX, 1, None);
    let mut when_silent = None;
    let mut on_hostile_lines = false;
    let mut plays_driver = false;
    let mut models = Model::ALL.to_vec();
    let mut arguments = env::args().skip(1);
    while let Some(flag) = arguments.next() {
        let value = arguments
            .next()
            .context("a value belongs behind each flag")?;
        if flag == "--model" {
            models = vec![value.parse()?];
            continue;
        }
        if flag == "--when-silent" {
            let firmware = WhenSilent::of_name(&value);
            when_silent = Some(firmware.context("--when-silent takes keep, coast or brake")?);
            continue;
        }
        if flag == "--lines" && value == "hostile" {
            on_hostile_lines = true;
            continue;
        }
        if flag == "--play" && value == "driver" {
            plays_driver = true;
            continue;
        }
        let number: u64 = value.parse().with_context(|| format!("{flag} {value}"))?;
        match flag.as_str() {
            "--seconds" => seconds = number,
            "--seeds" => (seeds, seconds) = (number, u64::from(u32::MAX)),
            "--from" => from = number,
            "--seed" => only = Some(number),
            _ => bail!(
                "usage: soak [--model M] [--when-silent keep|coast|brake] [--lines hostile] [--play driver] [--seconds N | --seeds N] [--from N] [--seed N]"
            ),
        }
    }
    if plays_driver {
        return Ok(match only {
            Some(seed) => driver_soak::play_one(seed),
            None => driver_soak::play_many(seconds, from, from.saturating_add(seeds)),
        });
    }
    let mut all_held = true;
    for model in models {
        // A model with a broken rule does not prevent the others.
        let motors = Motors {
            model,
            when_silent,
            on_hostile_lines,
        };
        all_held &= match only {
            Some(seed) => soak_one(motors, seed),
            None => soak_many(motors, seconds, seeds, from),
        };
    }
    Ok(all_held)
}

/// The motors of all scenarios.
#[derive(Clone, Copy)]
struct Motors {
    model: Model,
    /// What they do when frames cease, unless the seed draws it.
    when_silent: Option<WhenSilent>,
    on_hostile_lines: bool,
}

impl Motors {
    fn scenario(self, seed: u64) -> Scenario {
        let scenario = if self.on_hostile_lines {
            Scenario::on_hostile_lines(self.model, seed)
        } else {
            Scenario::of(self.model, seed)
        };
        match self.when_silent {
            Some(when_silent) => scenario.when_silent(when_silent),
            None => scenario,
        }
    }
}

/// Plays one seed and prints its actions.
fn soak_one(motors: Motors, seed: u64) -> bool {
    let scenario = motors.scenario(seed);
    println!(
        "seed {seed}, {}, {:?}, with {:?}",
        motors.model, scenario.when_silent, scenario.motors
    );
    for (step, action) in scenario.actions.iter().enumerate() {
        println!("{step:4}  {action:?}");
    }
    holds(&scenario, &mut Coverage::default())
}

/// Plays many seeds and prints the tables.
fn soak_many(motors: Motors, seconds: u64, seeds: u64, from: u64) -> bool {
    let began = Instant::now();
    let end = from.saturating_add(seeds);
    let mut played = Played::default();
    let play = |seed, played: &mut Played| played.play(motors, seed);
    for some in on_all_cores(seconds, from, end, play) {
        played.add(some);
    }
    played.failures.sort_by_key(|(seed, _)| *seed);
    let mut broken = BTreeMap::new();
    for (seed, failure) in &played.failures {
        let times = broken.entry(failure.violation.rule).or_insert(0_u64);
        if *times == 0 {
            explain(&motors.scenario(*seed), failure);
        }
        *times += 1;
    }
    print_table(motors, from..from + played.seeds, &broken, &played.coverage);
    // Equal before and after a change of the code that changes nothing on the wire.
    println!(
        "frames sent, with their times: {:016x}",
        played.coverage.sent
    );
    println!("in {:.0} s", began.elapsed().as_secs_f32());
    broken.is_empty()
}

/// Results of some seeds.
#[derive(Default)]
struct Played {
    seeds: u64,
    coverage: Coverage,
    failures: Vec<(u64, Failure)>,
}

impl Played {
    fn play(&mut self, motors: Motors, seed: u64) {
        self.seeds += 1;
        if let Err(failure) = play(&motors.scenario(seed), &mut self.coverage) {
            println!(
                "{}, seed {seed}, step {}: {}",
                motors.model, failure.step, failure.violation
            );
            self.failures.push((seed, failure));
        }
    }

    fn add(&mut self, other: Self) {
        self.seeds += other.seeds;
        self.coverage += other.coverage;
        self.failures.extend(other.failures);
    }
}

/// Plays seeds on all cores, until the last one or the end of the time. Returns the results of each core.
fn on_all_cores<P: Default + Send>(
    seconds: u64,
    from: u64,
    end: u64,
    play: impl Fn(u64, &mut P) + Sync,
) -> Vec<P> {
    let until = Instant::now() + Duration::from_secs(seconds);
    let next = AtomicU64::new(from);
    // Each thread plays seeds that no other has taken.
    let play_some = || {
        let mut played = P::default();
        while Instant::now() < until {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= end {
                break;
            }
            play(seed, &mut played);
        }
        played
    };
    thread::scope(|scope| {
        let cores = thread::available_parallelism().map_or(1, Into::into);
        // All threads start before the first join.
        let threads: Vec<_> = (0..cores).map(|_| scope.spawn(play_some)).collect();
        let joined = threads.into_iter().map(thread::ScopedJoinHandle::join);
        joined
            .map(|played| played.unwrap_or_else(|panic| resume_unwind(panic)))
            .collect()
    })
}

/// Prints the tables in the form of the documents.
fn print_table(
    motors: Motors,
    seeds: Range<u64>,
    broken: &BTreeMap<Rule, u64>,
    coverage: &Coverage,
) {
    let yes = |is| if is { "yes" } else { "NO" };
    // The first model has the rows that were there before the others.
    let mut of = match motors.model {
        Model::Ddsm115 => String::new(),
        other => format!(", {other}"),
    };
    if let Some(when_silent) = motors.when_silent {
        of.push_str(", ");
        of.push_str(match when_silent {
            WhenSilent::Keep => "firmware that keeps its command",
            WhenSilent::CoastAfter(_) => "firmware that lets a silent wheel roll",
            WhenSilent::BrakeAfter(_) => "firmware that brakes a silent wheel",
        });
    }
    println!("| figure | must | measured | reached |");
    println!("|---|---|---|---|");
    let with_broken: u64 = broken.values().sum();
    let played = grouped(seeds.end - seeds.start);
    println!(
        "| worlds that fail{of} | none of {} rules broken after any step | {with_broken} of {played} seeds from {} with a broken rule | {} |",
        Rule::VARIANTS.len(),
        seeds.start,
        yes(with_broken == 0)
    );
    for rule in Rule::VARIANTS {
        let times = coverage.judged.get(rule).copied().unwrap_or(0);
        let seeds = broken.get(rule).copied().unwrap_or(0);
        let by = match seeds {
            0 => String::new(),
            seeds => format!(", broken by {seeds} seeds"),
        };
        println!(
            "| rule `{rule:?}`{of} | had something to judge 100 times or more | {times} times in {played} seeds{by} | {} |",
            yes(times >= 100 && seeds == 0)
        );
    }
    for (fault, times) in &coverage.faults {
        println!(
            "| fault `{fault:?}`{of} | 100 times or more | {times} times in {played} seeds | {} |",
            yes(*times >= 100)
        );
    }
}

/// With thousands separators: `100,000`.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (place, digit) in digits.char_indices() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

fn holds(scenario: &Scenario, coverage: &mut Coverage) -> bool {
    let Err(failure) = play(scenario, coverage) else {
        return true;
    };
    explain(scenario, &failure);
    false
}

/// Prints the shortest scenario that breaks the same rule, and its trace.
fn explain(scenario: &Scenario, failure: &Failure) {
    let (short, last) = shrink(scenario, failure);
    println!(
        "{}, seed {} shrunk, {:?}, with {:?}, {:?} of which need five switches, and {}C8 obeyed: {}",
        short.model,
        short.seed,
        short.when_silent,
        short.motors,
        short.need_five_switches,
        if short.obey_all { "" } else { "not " },
        last.violation
    );
    for action in &short.actions {
        println!("  {action:?}");
    }
    println!("the last that passed in it:");
    for line in trace_lines(&short, TRACE_SHOWN) {
        println!("  {line}");
    }
}
