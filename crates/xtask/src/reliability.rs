//! Tests that try to break the product; their results are the table of docs/reliability.md.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;

use anyhow::{Context, Result};

use crate::bench::{self, Speed};
use crate::process;
use crate::sabotage;
use crate::scenarios;
use crate::tables::Rows;
use crate::tools;
use crate::workspace::Workspace;

/// The parts that can be run alone.
pub const PARTS: [&str; 6] = ["seeds", "driver", "sabotage", "fuzz", "browser", "hidden"];

/// The fuzz targets: the programs in `fuzz/fuzz_targets`.
const FUZZED: [&str; 5] = [
    "decode",
    "resynchronise",
    "raw_editor",
    "setup_file",
    "session_file",
];
/// Longest input in bytes: that of the longest session in the corpus. A file may be longer, but not deeper.
const INPUT_MAX: &str = "16384";

/// The modules of `end-to-end` with scenarios under faults.
const SCENARIOS: [&str; 10] = [
    "adapters",
    "stopping",
    "unplugging",
    "busy_ports",
    "bad_lines",
    "pages_gone",
    "wall_clock",
    "session",
    "limits",
    "security",
];

/// Time for which the scenario `hidden` hides the page here; in a run of the tests it is 10 s.
const HIDDEN_SECONDS: u32 = 300;

/// What motors do when drive frames cease, each with worlds of its own.
const FIRMWARE: [&str; 3] = ["keep", "coast", "brake"];

/// Runs all parts, or one, and updates the table. `rule` is the rule that the part `sabotage` breaks.
pub fn show(
    workspace: &Workspace,
    only: Option<&str>,
    seconds: u64,
    seeds: u64,
    rule: Option<&str>,
) -> Result<()> {
    let mut rows = Rows::default();
    let mut failed = Ok(());
    for part in PARTS
        .into_iter()
        .filter(|part| only.is_none_or(|only| only == *part))
    {
        // A part that fails does not prevent the others.
        failed = failed.and(match part {
            "seeds" => worlds(workspace, seeds, &mut rows),
            "driver" => play_worlds(workspace, seeds, &["--play", "driver"], &mut rows),
            "sabotage" => sabotage::show(workspace, &mut rows, rule),
            "fuzz" => fuzz(workspace, seconds, &mut rows),
            "browser" => scenarios(workspace, &SCENARIOS, "", &mut rows),
            _ => {
                let how_long = format!(", {HIDDEN_SECONDS} s");
                scenarios(workspace, &["hidden"], &how_long, &mut rows)
            }
        });
    }
    let file = workspace.root().join("docs/reliability.md");
    rows.write_into(&file, "reliability")?;
    failed
}

/// Plays the worlds of each model, whose firmware the seeds draw, and those of the DDSM115 with each firmware.
fn worlds(workspace: &Workspace, seeds: u64, rows: &mut Rows) -> Result<()> {
    let mut play = |flags: &[&str]| play_worlds(workspace, seeds, flags, rows);
    // Firmware that breaks a rule does not prevent the others.
    let mut played = play(&[]);
    for firmware in FIRMWARE {
        played = played.and(play(&["--model", "ddsm115", "--when-silent", firmware]));
    }
    played
}

/// Plays so many worlds with these flags, and adds the rows that they print.
fn play_worlds(workspace: &Workspace, seeds: u64, flags: &[&str], rows: &mut Rows) -> Result<()> {
    let mut worlds = bench::worlds(workspace);
    worlds.args(["--seeds", &seeds.to_string()]).args(flags);
    process::run_with_lines(&mut worlds, |line| rows.add_line(line))
}

/// Runs the fuzz targets, as many at the same time as there are cores.
fn fuzz(workspace: &Workspace, seconds: u64, rows: &mut Rows) -> Result<()> {
    let path = tools::path_with_cargo_fuzz()?;
    let mut build = Command::new("cargo");
    build.current_dir(workspace.root()).env("PATH", path);
    // Cargo passes the workspace's toolchain on, which is a stable one.
    build.env_remove("RUSTUP_TOOLCHAIN");
    process::run(build.args(["+nightly", "fuzz", "build"]))
        .context("fuzzing needs a nightly compiler (rustup toolchain install nightly)")?;
    let at_once = thread::available_parallelism().map_or(1, Into::into);
    let mut failed = Ok(());
    for some in FUZZED.chunks(at_once) {
        let running: Vec<_> = some
            .iter()
            .map(|target| {
                let command = fuzzer(workspace, target, seconds);
                thread::spawn(move || command.and_then(|mut it| Ok(it.output()?)))
            })
            .collect();
        for (target, running) in some.iter().zip(running) {
            let output = running
                .join()
                .ok()
                .context("a fuzzer ended without a result")??;
            let printed = String::from_utf8_lossy(&output.stderr);
            let runs = executions(&printed).unwrap_or("no");
            let good = output.status.success();
            let (found, reached) = if good {
                ("nothing", "yes")
            } else {
                ("a crash", "NO")
            };
            let row = format!(
                "| fuzzing `{target}`, {seconds} s | nothing found | {runs} executions, {found} | {reached} |"
            );
            println!("{row}");
            rows.add_line(&row);
            if !good {
                eprintln!("{printed}");
                failed = Err(anyhow::anyhow!("{target}: the input is in target/fuzz"));
            }
        }
    }
    failed
}

/// One fuzz target. New inputs go to the target directory, not into the corpus in the repository.
fn fuzzer(workspace: &Workspace, target: &str, seconds: u64) -> Result<Command> {
    let found = workspace.target().join("fuzz").join(target);
    fs::create_dir_all(&found).with_context(|| format!("{}", found.display()))?;
    let programs =
        Path::new("fuzz/target").join(format!("{}-unknown-linux-gnu", std::env::consts::ARCH));
    let mut command = Command::new(workspace.root().join(programs).join("release").join(target));
    command
        .current_dir(workspace.root())
        .arg(&found)
        .arg(Path::new("fuzz/corpus").join(target))
        .arg(format!("-max_total_time={seconds}"))
        .arg(format!("-max_len={INPUT_MAX}"))
        .arg(format!("-artifact_prefix={}-", found.display()))
        .arg("-print_final_stats=1")
        .stdout(Stdio::null());
    Ok(command)
}

/// From `stat::number_of_executed_units: 219679`.
fn executions(printed: &str) -> Option<&str> {
    let line = printed
        .lines()
        .find(|line| line.starts_with("stat::number_of_executed_units"))?;
    line.split_whitespace().last()
}

/// Runs the scenarios of these modules; `how` follows their names in the table.
fn scenarios(workspace: &Workspace, names: &[&str], how: &str, rows: &mut Rows) -> Result<()> {
    let (browser, _) = bench::prepare(workspace)?;
    let mut cargo = scenarios::command(workspace, &browser, Speed::QuickToRun);
    cargo.args(["--", "--test-threads=1"]);
    cargo.args(names.iter().map(|name| format!("::{name}::")));
    cargo.env("MOTORLINK_HIDDEN_SECONDS", HIDDEN_SECONDS.to_string());
    process::run_with_lines(&mut cargo, |line| {
        if let Some(row) = row_of_test(line, how) {
            rows.add_line(&row);
        }
    })
}

/// From `test a_hung_page_has_its_wheel_stopped_within_a_second ... ok`.
fn row_of_test(line: &str, how: &str) -> Option<String> {
    let (path, outcome) = line.strip_prefix("test ")?.split_once(" ... ")?;
    let name = path.rsplit("::").next()?;
    let reached = if outcome == "ok" { "yes" } else { "NO" };
    let words = name.replace('_', " ");
    Some(format!(
        "| in a browser: {words}{how} | holds | {outcome} | {reached} |"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_test_becomes_a_row() {
        assert_eq!(
            row_of_test("test alone::stopping::a_closed_tab_stops ... ok", ", 5 s").unwrap(),
            "| in a browser: a closed tab stops, 5 s | holds | ok | yes |"
        );
        assert!(
            row_of_test("test a_closed_tab_stops ... FAILED", "")
                .unwrap()
                .ends_with("| NO |")
        );
        assert_eq!(row_of_test("test result: ok. 3 passed", ""), None);
    }

    #[test]
    fn executions_are_read_from_what_a_fuzzer_prints() {
        let printed = "Done 5 runs\nstat::number_of_executed_units: 219679\nstat::x: 1\n";
        assert_eq!(executions(printed), Some("219679"));
        assert_eq!(executions("killed"), None);
    }
}
