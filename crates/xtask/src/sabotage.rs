//! Breaks the bus on purpose, one rule at a time, and counts the worlds that notice.
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

/// A few words of the sources that are replaced by others.
struct Sabotage {
    /// The rule that must notice; others may too.
    rule: &'static str,
    /// What is wrong then.
    what: &'static str,
    file: &'static str,
    /// What is there exactly once.
    from: &'static str,
    to: &'static str,
}

/// One for each rule at least.
const SABOTAGES: [Sabotage; 29] = [
    Sabotage {
        rule: "DrivenByCommandOnly",
        what: "a stopped motor is driven on at 50 rpm",
        file: "crates/bus/src/stopping.rs",
        from: "                motor.control = Control::Idle;\n                let speed",
        to: "                let fifty = motorlink_protocol::SpeedTarget::clamped(50);
                let fifty = motorlink_protocol::Setpoint::velocity(fifty);
                motor.control = Control::Driven(crate::motor::Driven::begin(now, fifty, None));
                let speed",
    },
    Sabotage {
        rule: "NoOldActs",
        what: "an act is carried out when it is two seconds old",
        file: "crates/bus/src/command.rs",
        from: "self.releases()) && age > COMMAND_AGE_MAX",
        to: "self.releases()) && age > COMMAND_AGE_MAX * 4",
    },
    Sabotage {
        rule: "NoMoreThanCommanded",
        what: "one rpm more is sent than was asked for",
        file: "crates/bus/src/driving.rs",
        from: "                    goal: setpoint,\n                    hold: None,",
        to: "                    goal: match setpoint {
                        Setpoint::Velocity { speed, .. } if speed.rpm() > 0 => Setpoint::velocity(
                            motorlink_protocol::SpeedTarget::clamped(i32::from(speed.rpm()) + 1),
                        ),
                        other => other,
                    },
                    hold: None,",
    },
    Sabotage {
        rule: "SilentIsWithdrawn",
        what: "a silent motor keeps its setpoint for 400 ms",
        file: "crates/bus/src/timing.rs",
        from: "DRIVEN_SILENCE_MAX: Duration = Duration::from_millis(200)",
        to: "DRIVEN_SILENCE_MAX: Duration = Duration::from_millis(400)",
    },
    Sabotage {
        rule: "LimitsHold",
        what: "a wheel may be 50 rpm above its limit",
        file: "crates/bus/src/limits.rs",
        from: "const OVERSHOOT_RPM: u16 = 10;",
        to: "const OVERSHOOT_RPM: u16 = 50;",
    },
    Sabotage {
        rule: "StopIsNext",
        what: "a stop waits 100 ms",
        file: "crates/bus/src/stop.rs",
        from: "            last_frame: None,\n            next_frame: now,\n",
        to: "            last_frame: Some((now, Request::IdQuery)),
            next_frame: now + Duration::from_millis(100),\n",
    },
    Sabotage {
        rule: "StopEnds",
        what: "60 rpm count as a standstill",
        file: "crates/bus/src/stop.rs",
        from: "speed.magnitude() < 1;",
        to: "speed.magnitude() < 60;",
    },
    Sabotage {
        rule: "DeadPageStops",
        what: "a page that hangs is missed after two seconds",
        file: "crates/bus/src/timing.rs",
        from: "PAGE_SILENCE_MAX: Duration = Duration::from_secs(1)",
        to: "PAGE_SILENCE_MAX: Duration = Duration::from_secs(2)",
    },
    Sabotage {
        rule: "TelemetryIsTrue",
        what: "late replies are read in the layout of the request in flight",
        file: "crates/bus/src/motor.rs",
        from: "let layout = self.late.layout_of_reply(now, layout)?;",
        to: "let _ = self.late.layout_of_reply(now, layout);\n        if now > Instant::ZERO { return Some(layout); }",
    },
    Sabotage {
        rule: "OneFrameAtATime",
        what: "a mode switch keeps the line for half its time",
        file: "crates/bus/src/exchange.rs",
        from: "            airtime + SETTLE_TIME\n",
        to: "            airtime / 2\n",
    },
    Sabotage {
        rule: "GoodRepliesAreHeard",
        what: "the last byte of one chunk in 64 is dropped",
        file: "crates/bus/src/replies.rs",
        from: "        self.receiver.push(bytes);\n",
        to: "        let kept = bytes.len() - usize::from(now.as_micros() % 64 == 0);
        self.receiver.push(bytes.get(..kept).unwrap_or_default());\n",
    },
    Sabotage {
        rule: "IdChangeIsProved",
        what: "an ID is set without a scan",
        file: "crates/bus/src/id_change/control.rs",
        from: "        if self.take_proof(now)? != from {\n            return Err(Refusal::NotProvedAlone);",
        to: "        if self.take_proof(now).is_ok_and(|alone| alone != from) {\n            return Err(Refusal::NotProvedAlone);",
    },
    Sabotage {
        rule: "LogIsComplete",
        what: "a frame that the port refused is logged as sent",
        file: "crates/bus/src/sending.rs",
        from: "self.log(at, LineEventKind::NotSent { frame });",
        to: "self.log(at, LineEventKind::Sent { frame, mode: None });",
    },
    Sabotage {
        rule: "ComesToRest",
        what: "the bus asks to be woken at once, again and again",
        file: "crates/bus/src/bus.rs",
        from: "next.max(now + Duration::from_micros(1))",
        to: "next.min(now + Duration::from_micros(50))",
    },
    Sabotage {
        rule: "GapWithdraws",
        what: "a gap of less than an hour stops nothing",
        file: "crates/bus/src/bus.rs",
        from: "        if self.is_active(now) {\n            self.stop_all(now, reason);",
        to: "        if self.is_active(now) && late > Duration::from_secs(3_600) {
            self.stop_all(now, reason);",
    },
    Sabotage {
        rule: "StopMovesNothing",
        what: "the brake is sent into the position loop",
        file: "crates/bus/src/safety.rs",
        from: "            StopPlan::SwitchThenBrake\n        }",
        to: "            StopPlan::BrakeWhileSwitching\n        }",
    },
    Sabotage {
        rule: "HoldHolds",
        what: "a hold goes on to the old angle",
        file: "crates/bus/src/driving.rs",
        from: "            goal: Setpoint::Position(angle),\n            hold: Some(hold),\n",
        to: "            hold: None,\n",
    },
    Sabotage {
        rule: "NothingAboveALimit",
        what: "a speed may be 40 rpm above its limit",
        file: "crates/bus/src/limits.rs",
        from: "speed.rpm().unsigned_abs() <= self.speed_rpm,",
        to: "speed.rpm().unsigned_abs() <= self.speed_rpm + 40,",
    },
    Sabotage {
        rule: "NothingAboveALimit",
        what: "nobody is asked before a high current",
        file: "crates/bus/src/safety.rs",
        from: "target.raw().unsigned_abs() > HIGH_CURRENT_RAW",
        to: "target.raw().unsigned_abs() > i16::MAX as u16",
    },
    Sabotage {
        rule: "ReversalPassesZero",
        what: "a torque is reversed at once",
        file: "crates/bus/src/safety.rs",
        from: "i32::from(present.raw()) < 0",
        to: "i32::from(present.raw()) < i32::MIN",
    },
    Sabotage {
        rule: "StoppedAfterALoss",
        what: "what was left driven is not stopped when the port is back",
        file: "crates/bus/src/left_driven.rs",
        from: "            ids.push(id);\n",
        to: "            if now == Instant::ZERO {\n                ids.push(id);\n            }\n",
    },
    Sabotage {
        rule: "StoppedAfterALoss",
        what: "a motor without confirmed standstill is not remembered",
        file: "crates/bus/src/left_driven.rs",
        from: "        starts || self.may_turn()\n",
        to: "        starts\n",
    },
    Sabotage {
        rule: "StoppedAfterADeadLine",
        what: "what a dead line left driven is not stopped when it answers again",
        file: "crates/bus/src/left_driven.rs",
        from: "motor.rest == Rest::StopWhenBack && !is_stopped(motor);",
        to: "motor.rest == Rest::StopWhenBack && !is_stopped(motor) && now == Instant::ZERO;",
    },
    Sabotage {
        rule: "StandstillIsTrue",
        what: "a standstill is confirmed by the speed alone",
        file: "crates/bus/src/stop.rs",
        from: "self.standstill_replies >= STANDSTILL_REPLIES && self.angle_stands",
        to: "self.standstill_replies >= STANDSTILL_REPLIES",
    },
    Sabotage {
        rule: "UnaskedIsSaid",
        what: "a wheel that nothing drives counts as turning from 100 rpm on",
        file: "crates/bus/src/turning_unasked.rs",
        from: "speed.magnitude() >= UNASKED_RPM",
        to: "speed.magnitude() >= UNASKED_RPM * 10",
    },
    Sabotage {
        rule: "FirstBrakeInTime",
        what: "a stop waits 400 ms after each frame",
        file: "crates/bus/src/stop.rs",
        from: "        self.next_frame = now + period;\n",
        to: "        self.next_frame = now + period + Duration::from_millis(400);\n",
    },
    Sabotage {
        rule: "AskedInTime",
        what: "a query for proof moves the schedule of queries on",
        file: "crates/bus/src/motor/asking.rs",
        from: "(self.next_query + period).min(now + period)",
        to: "self.next_query + period",
    },
    Sabotage {
        rule: "StopsConfirm",
        what: "a stop is confirmed by 200 replies",
        file: "crates/bus/src/timing.rs",
        from: "STANDSTILL_REPLIES: u8 = 3;",
        to: "STANDSTILL_REPLIES: u8 = 200;",
    },
    Sabotage {
        rule: "NoInventedValue",
        what: "an odometry reply without a speed tells 0 rpm",
        file: "crates/bus/src/model/separate.rs",
        from: "                    speed: moved.filter(|_| !is_superseded),\n",
        to: "                    speed: Some(moved.filter(|_| !is_superseded).unwrap_or_default()),\n",
    },
];

/// Plays the worlds on each sabotaged bus, or on those for one rule, and fails where the rule does not notice.
pub fn show(workspace: &Workspace, rows: &mut Rows, rule: Option<&str>) -> Result<()> {
    for sabotage in &SABOTAGES {
        sabotage.applied(workspace.root())?;
    }
    let home = workspace.target().join("sabotage");
    let sources = home.join("sources");
    let play = |model: &str| -> Result<Found> {
        // A bus that is broken lets the program fail: what it prints is what counts.
        let mut worlds = worlds(&sources, &home.join("build"), model);
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
    let whole = play("ddsm115")?;
    println!("as it is: {}", whole.words());
    let mut unnoticed = Vec::new();
    let is_asked = |it: &&Sabotage| rule.is_none_or(|rule| rule == it.rule);
    for sabotage in SABOTAGES.iter().filter(is_asked) {
        let file = sources.join(sabotage.file);
        let was = fs::read_to_string(&file)?;
        fs::write(&file, sabotage.applied(workspace.root())?)?;
        let found = play(sabotage.model());
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
    /// The model whose worlds notice. A DDSM115 tells every value in one reply, so none of them can be invented unless
    /// the reply is.
    fn model(&self) -> &'static str {
        match self.rule {
            "NoInventedValue" => "ddsm210",
            _ => "ddsm115",
        }
    }

    /// The sabotaged file.
    fn applied(&self, root: &Path) -> Result<String> {
        let file = root.join(self.file);
        let text = fs::read_to_string(&file).with_context(|| format!("{}", file.display()))?;
        let times = text.matches(self.from).count();
        ensure!(
            times == 1,
            "{}: \"{}\" is there {times} times: write the sabotage \"{}\" for today's code",
            self.file,
            self.from,
            self.what
        );
        Ok(text.replacen(self.from, self.to, 1))
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
fn worlds(sources: &Path, build: &Path, model: &str) -> Command {
    let mut cargo = process::cargo();
    cargo.current_dir(sources).env("CARGO_TARGET_DIR", build);
    bench::add_simulation(&mut cargo);
    cargo.args(["--model", model, "--seeds", SEEDS]);
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
        for sabotage in &SABOTAGES {
            let applied = sabotage.applied(&root()).unwrap();
            assert!(applied.contains(sabotage.to), "{}", sabotage.what);
        }
    }

    #[test]
    fn every_rule_has_a_sabotage() {
        let rules = include_str!("../../fault-simulation/src/rule.rs");
        let (_, list) = rules.split_once("pub const ALL").unwrap();
        let (list, _) = list.split_once("];").unwrap();
        let rules: Vec<&str> = list
            .lines()
            .filter_map(|line| line.trim().strip_prefix("Self::")?.strip_suffix(','))
            .collect();
        assert!(rules.len() >= 22, "{rules:?}");
        for rule in rules {
            let has_one = SABOTAGES.iter().any(|sabotage| sabotage.rule == rule);
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
