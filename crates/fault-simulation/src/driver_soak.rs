//! Plays the native driver on computers that fail.

use std::collections::BTreeMap;
use std::time::Instant;

use motorlink_fault_simulation::{
    DriverCoverage, DriverRule, DriverScenario, DriverViolation, play_driver, shrink_driver,
    trace_driver,
};
use strum::VariantArray;

use crate::{grouped, on_all_cores};

/// Results of some seeds.
#[derive(Default)]
struct Played {
    seeds: u64,
    coverage: DriverCoverage,
    broken: Vec<(u64, DriverViolation)>,
}

impl Played {
    fn play(&mut self, seed: u64) {
        self.seeds += 1;
        if let Err(violation) = play_driver(&DriverScenario::of(seed), &mut self.coverage) {
            println!("driver, seed {seed}: {violation}");
            self.broken.push((seed, violation));
        }
    }

    fn add(&mut self, other: Self) {
        self.seeds += other.seeds;
        self.broken.extend(other.broken);
        self.coverage += other.coverage;
    }
}

/// Plays one seed and prints its acts. Whether all rules held.
pub(super) fn play_one(seed: u64) -> bool {
    let scenario = DriverScenario::of(seed);
    println!("{scenario}");
    let played = play_driver(&scenario, &mut DriverCoverage::default());
    if let Err(violation) = &played {
        explain(&scenario, violation.clone());
    }
    played.is_ok()
}

/// Plays many seeds and prints the table. Whether all rules held.
pub(super) fn play_many(seconds: u64, from: u64, end: u64) -> bool {
    let began = Instant::now();
    let mut played = Played::default();
    for some in on_all_cores(seconds, from, end, |seed, played: &mut Played| {
        played.play(seed);
    }) {
        played.add(some);
    }
    played.broken.sort_by_key(|(seed, _)| *seed);
    let mut by_rule = BTreeMap::new();
    for (seed, violation) in &played.broken {
        let times = by_rule.entry(violation.rule).or_insert(0_u64);
        if *times == 0 {
            explain(&DriverScenario::of(*seed), violation.clone());
        }
        *times += 1;
    }
    print_table(&played, from, &by_rule);
    println!("in {:.0} s", began.elapsed().as_secs_f32());
    by_rule.is_empty()
}

fn print_table(played: &Played, from: u64, by_rule: &BTreeMap<DriverRule, u64>) {
    let yes = |is| if is { "yes" } else { "NO" };
    println!("| figure | must | measured | reached |");
    println!("|---|---|---|---|");
    let (seeds, broken) = (grouped(played.seeds), played.broken.len());
    println!(
        "| worlds that fail, native driver | none of {} rules broken | {broken} of {seeds} seeds from {from} with a broken rule | {} |",
        DriverRule::VARIANTS.len(),
        yes(broken == 0)
    );
    for rule in DriverRule::VARIANTS {
        let times = played.coverage.judged.get(rule).copied().unwrap_or(0);
        let by = match by_rule.get(rule) {
            None => String::new(),
            Some(seeds) => format!(", broken by {seeds} seeds"),
        };
        println!(
            "| rule `{rule:?}` | had something to judge 100 times or more | {times} times in {seeds} seeds{by} | {} |",
            yes(times >= 100 && by.is_empty())
        );
    }
    for (act, times) in &played.coverage.acts {
        println!(
            "| act `{act}` | 100 times or more | {times} times in {seeds} seeds | {} |",
            yes(*times >= 100)
        );
    }
}

/// Prints the shortest scenario that breaks the same rule, and what the driver told in it.
fn explain(scenario: &DriverScenario, violation: DriverViolation) {
    let (short, last) = shrink_driver(scenario, violation);
    println!("{last}\n{short}\nwhat it told:");
    for line in trace_driver(&short) {
        println!("  {line}");
    }
}
