//! Breaks the bus and the driver on purpose, one rule at a time, and counts the worlds that notice.
//!
//! A rule that never fails proves nothing. Each sabotage replaces a few words of a copy of the sources, and
//! the worlds are played on that copy.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::bench;
use crate::process;
use crate::tables::Rows;
use crate::workspace::Workspace;

/// Worlds that are played for each, as many as in a run of the tests.
const SEEDS: &str = "2000";

/// What of the workspace is not needed to build in a copy of it.
const LEFT_OUT: [&str; 5] = ["target", "dist", "screenshots", ".git", "docs"];

/// Lines of the sources that are replaced by others.
struct Sabotage {
    /// The rule that must notice; others may too.
    rule: &'static str,
    /// What is wrong then.
    what: &'static str,
    file: &'static str,
    /// What is there exactly once.
    from: String,
    to: String,
}

/// Those of `sabotages.txt`, one for each rule at least: the rule and what is wrong, the file, and the lines that go (-)
/// and come (+).
fn sabotages() -> Vec<Sabotage> {
    let texts = include_str!("sabotages.txt").trim_end().split("\n\n");
    texts.filter_map(Sabotage::read).collect()
}

/// Plays the worlds on each sabotaged bus, or on those for one rule, and fails where the rule does not notice.
pub fn show(workspace: &Workspace, rows: &mut Rows, rule: Option<&str>) -> Result<()> {
    let sabotages = sabotages();
    for sabotage in &sabotages {
        sabotage.applied(workspace.root())?;
    }
    let home = workspace.target().join("sabotage");
    let sources = home.join("sources");
    let play = |flags: [&str; 2]| -> Result<Found> {
        // A bus that is broken lets the program fail: what it prints is what counts.
        let mut worlds = worlds(&sources, &home.join("build"), flags);
        let output = worlds.output().context("cannot start cargo")?;
        let printed = String::from_utf8_lossy(&output.stdout);
        let Some(found) = Found::read(&printed) else {
            bail!(
                "no worlds were played: {}",
                String::from_utf8_lossy(&output.stderr)
            );
        };
        Ok(found)
    };
    copy(workspace.root(), &sources)?;
    let whole = play(["--model", "ddsm115"])?;
    println!("as it is: {}", whole.words());
    let mut unnoticed = Vec::new();
    let is_asked = |it: &&Sabotage| rule.is_none_or(|rule| rule == it.rule);
    for sabotage in sabotages.iter().filter(is_asked) {
        let file = sources.join(sabotage.file);
        let was = fs::read_to_string(&file)?;
        fs::write(&file, sabotage.applied(workspace.root())?)?;
        let found = play(sabotage.worlds());
        fs::write(&file, was)?;
        let found = match found {
            Ok(found) => found,
            // What cannot be built keeps none of the others from it.
            Err(error) => {
                eprintln!("{}: {error:#}", sabotage.what);
                unnoticed.push(sabotage.what);
                continue;
            }
        };
        let noticed = found.of(sabotage.rule) > whole.of(sabotage.rule);
        let reached = if noticed { "yes" } else { "NO" };
        let Sabotage { rule, what, .. } = sabotage;
        let row = format!(
            "| broken on purpose: {what} | `{rule}` notices | {} | {reached} |",
            found.words()
        );
        println!("{row}");
        rows.add_line(&row);
        if !noticed {
            unnoticed.push(*what);
        }
    }
    ensure!(
        unnoticed.is_empty(),
        "no world notices: {}",
        unnoticed.join("; ")
    );
    Ok(())
}

impl Sabotage {
    fn read(text: &'static str) -> Option<Self> {
        let mut lines = text.lines();
        let (rule, what) = lines.next()?.split_once(": ")?;
        let file = lines.next()?;
        let [mut from, mut to] = [String::new(), String::new()];
        for line in lines {
            let (text, line) = match line.split_at_checked(1)? {
                ("-", line) => (&mut from, line),
                ("+", line) => (&mut to, line),
                _ => return None,
            };
            text.push_str(line);
            text.push('\n');
        }
        Some(Self {
            rule,
            what,
            file,
            from,
            to,
        })
    }

    /// Which worlds notice. A DDSM115 tells every value in one reply, so none of them can be invented unless the reply is.
    fn worlds(&self) -> [&'static str; 2] {
        let of_driver = ["crates/driver/", "crates/port/"];
        match self.rule {
            _ if of_driver.iter().any(|part| self.file.starts_with(part)) => ["--play", "driver"],
            "NoInventedValue" => ["--model", "ddsm210"],
            _ => ["--model", "ddsm115"],
        }
    }

    /// The sabotaged file.
    fn applied(&self, root: &Path) -> Result<String> {
        let file = root.join(self.file);
        let text = fs::read_to_string(&file).with_context(|| format!("{}", file.display()))?;
        let times = text.matches(&self.from).count();
        ensure!(
            times == 1,
            "{}: \"{}\" is there {times} times: write the sabotage \"{}\" for today's code",
            self.file,
            self.from,
            self.what
        );
        Ok(text.replacen(&self.from, &self.to, 1))
    }
}

/// How many seeds break a rule, and which.
#[derive(Debug, Default, PartialEq, Eq)]
struct Found {
    of: String,
    seeds: u64,
    by_rule: BTreeMap<String, u64>,
}

impl Found {
    /// From the table that the worlds print.
    fn read(printed: &str) -> Option<Self> {
        let mut found = None;
        for line in printed.lines() {
            // The figure names any model but a DDSM115.
            if line.starts_with("| worlds that fail") {
                let measured = line.split('|').nth(3)?.trim();
                let (seeds, rest) = measured.split_once(" of ")?;
                found = Some(Self {
                    of: rest.split_whitespace().next()?.to_owned(),
                    seeds: seeds.parse().ok()?,
                    by_rule: BTreeMap::new(),
                });
            }
            if let (Some(found), Some(rest)) = (&mut found, line.strip_prefix("| rule `"))
                && let Some((rule, rest)) = rest.split_once('`')
                && let Some((_, seeds)) = rest.split_once("broken by ")
            {
                let seeds = seeds.split_whitespace().next()?.parse().ok()?;
                found.by_rule.insert(rule.to_owned(), seeds);
            }
        }
        found
    }

    fn of(&self, rule: &str) -> u64 {
        self.by_rule.get(rule).copied().unwrap_or(0)
    }

    fn words(&self) -> String {
        let mut rules: Vec<_> = self.by_rule.iter().collect();
        rules.sort_by_key(|(_, seeds)| u64::MAX - **seeds);
        let rules = rules.iter().map(|(rule, seeds)| format!("{rule} {seeds}"));
        let rules: Vec<String> = rules.collect();
        let by = if rules.is_empty() { "" } else { ": " };
        format!(
            "{} of {} seeds{by}{}",
            self.seeds,
            self.of,
            rules.join(", ")
        )
    }
}

/// The program that plays worlds, of the sources in a directory.
fn worlds(sources: &Path, build: &Path, flags: [&str; 2]) -> Command {
    let mut cargo = process::cargo();
    cargo.current_dir(sources).env("CARGO_TARGET_DIR", build);
    bench::add_simulation(&mut cargo);
    cargo.args(flags).args(["--seeds", SEEDS]);
    cargo
}

/// Makes a directory like another. What is the same is left alone, so that it is not built once more.
fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to).with_context(|| format!("{}", to.display()))?;
    let mut there = BTreeSet::new();
    for entry in fs::read_dir(from).with_context(|| format!("{}", from.display()))? {
        let entry = entry?;
        let name = entry.file_name();
        if LEFT_OUT.iter().any(|out| name == OsStr::new(out)) {
            continue;
        }
        let copied: PathBuf = to.join(&name);
        there.insert(name);
        if entry.file_type()?.is_dir() {
            copy(&entry.path(), &copied)?;
        } else {
            let bytes = fs::read(entry.path())?;
            if fs::read(&copied).ok().as_ref() != Some(&bytes) {
                fs::write(&copied, bytes)?;
            }
        }
    }
    for entry in fs::read_dir(to)? {
        let entry = entry?;
        if !there.contains(&entry.file_name()) {
            let path = entry.path();
            if entry.file_type()?.is_dir() {
                fs::remove_dir_all(path)?;
            } else {
                fs::remove_file(path)?;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
    }

    #[test]
    fn every_sabotage_fits_the_code_of_today() {
        let sabotages = sabotages();
        assert_eq!(
            sabotages.len(),
            include_str!("sabotages.txt").split("\n\n").count()
        );
        for sabotage in sabotages {
            let applied = sabotage.applied(&root()).unwrap();
            assert!(applied.contains(&sabotage.to), "{}", sabotage.what);
        }
    }

    #[test]
    fn every_rule_has_a_sabotage() {
        let of_bus = include_str!("../../fault-simulation/src/rule.rs");
        let of_driver = include_str!("../../fault-simulation/src/driver/rule.rs");
        let rules = |source: &'static str| {
            let (_, list) = source.split_once("Rule {\n").unwrap();
            let (list, _) = list.split_once("\n}").unwrap();
            let lines = list.lines().map(str::trim);
            let variants = lines.filter(|line| !line.starts_with("//"));
            variants.filter_map(|line| line.strip_suffix(','))
        };
        let rules: Vec<&str> = rules(of_bus).chain(rules(of_driver)).collect();
        assert!(rules.len() >= 42, "{rules:?}");
        for rule in rules {
            let has_one = sabotages().iter().any(|sabotage| sabotage.rule == rule);
            assert!(has_one, "{rule}");
        }
    }

    #[test]
    fn what_was_found_is_read_from_the_table_of_the_worlds() {
        let printed = "\
seed 3, step 4: StopEnds at 1.000000 s: what
| worlds that fail | none of 19 rules broken after any step | 12 of 2,000 seeds from 1 with a broken rule | NO |
| rule `StopEnds` | had something to judge 100 times or more | 7 times in 2,000 seeds, broken by 2 seeds | NO |
| rule `NoOldActs` | had something to judge 100 times or more | 7 times in 2,000 seeds | NO |
| rule `HoldHolds` | had something to judge 100 times or more | 7 times in 2,000 seeds, broken by 10 seeds | NO |
";
        let found = Found::read(printed).unwrap();
        assert_eq!(found.words(), "12 of 2,000 seeds: HoldHolds 10, StopEnds 2");
        assert_eq!((found.of("StopEnds"), found.of("NoOldActs")), (2, 0));
        assert_eq!(Found::read("error: no"), None);
    }
}
