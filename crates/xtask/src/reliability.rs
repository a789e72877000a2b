//! What was done to break the product, and what came of it: the table of docs/reliability.md.

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

/// What can be done by itself.
pub const PARTS: [&str; 5] = ["seeds", "sabotage", "fuzz", "browser", "hidden"];

/// What is fuzzed: the programs in `fuzz/fuzz_targets`.
const FUZZED: [&str; 4] = ["decode", "resynchronise", "raw_editor", "setup_file"];
/// Bytes of the longest input; a setup file may be longer, but not deeper.
const INPUT_MAX: &str = "4096";

/// The programs of `end-to-end` that tell stories under faults.
const STORIES: [&str; 10] = [
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

/// How long the page of the story `hidden` is hidden here; in each run of the tests it is for 10 s.
const HIDDEN_SECONDS: u32 = 300;

/// Does all of it, or one part, and puts what came of it into the table.
pub fn show(workspace: &Workspace, only: Option<&str>, seconds: u64, seeds: u64) -> Result<()> {
    let mut rows = Rows::default();
    let mut failed = Ok(());
    for part in PARTS
        .into_iter()
        .filter(|part| only.is_none_or(|only| only == *part))
    {
        // What one of them finds keeps none of the others from it.
        failed = failed.and(match part {
            "seeds" => {
                let mut worlds = bench::worlds(workspace);
                let seeds = seeds.to_string();
                process::run_and_hear(worlds.args(["--seeds", &seeds]), |line| rows.hear(line))
            }
            "sabotage" => sabotage::show(workspace, &mut rows),
            "fuzz" => fuzz(workspace, seconds, &mut rows),
            "browser" => stories(workspace, &STORIES, "", &mut rows),
            _ => {
                let how_long = format!(", {HIDDEN_SECONDS} s");
                stories(workspace, &["hidden"], &how_long, &mut rows)
            }
        });
    }
    let file = workspace.root().join("docs/reliability.md");
    rows.write_into(&file, "reliability")?;
    failed
}

/// Feeds each of them with what cargo-fuzz invents, as many at once as there are cores.
fn fuzz(workspace: &Workspace, seconds: u64, rows: &mut Rows) -> Result<()> {
    let path = tools::path_with_cargo_fuzz()?;
    let mut build = Command::new("cargo");
    build.current_dir(workspace.root()).env("PATH", path);
    // The toolchain of the workspace is a stable one, and cargo names it to whom it starts.
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
            let output = running.join().ok().context("a fuzzer was not heard")??;
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
            rows.hear(&row);
            if !good {
                eprintln!("{printed}");
                failed = Err(anyhow::anyhow!("{target}: the input is in target/fuzz"));
            }
        }
    }
    failed
}

/// One program. What it finds worth keeping stays out of the corpus that is kept with the sources.
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

/// Plays these stories; `how` stands behind their names in the table.
fn stories(workspace: &Workspace, names: &[&str], how: &str, rows: &mut Rows) -> Result<()> {
    let (browser, _) = bench::prepare(workspace)?;
    let mut cargo = scenarios::command(workspace, &browser, Speed::QuickToRun);
    cargo.args(["--", "--test-threads=1"]);
    cargo.args(names.iter().map(|name| format!("::{name}::")));
    cargo.env("MOTORLINK_HIDDEN_SECONDS", HIDDEN_SECONDS.to_string());
    process::run_and_hear(&mut cargo, |line| {
        if let Some(row) = row_of_story(line, how) {
            rows.hear(&row);
        }
    })
}

/// From `test a_hung_page_has_its_wheel_stopped_within_a_second ... ok`.
fn row_of_story(line: &str, how: &str) -> Option<String> {
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
    fn a_story_is_a_row_by_its_name() {
        assert_eq!(
            row_of_story("test alone::stopping::a_closed_tab_stops ... ok", ", 5 s").unwrap(),
            "| in a browser: a closed tab stops, 5 s | holds | ok | yes |"
        );
        assert!(
            row_of_story("test a_closed_tab_stops ... FAILED", "")
                .unwrap()
                .ends_with("| NO |")
        );
        assert_eq!(row_of_story("test result: ok. 3 passed", ""), None);
    }

    #[test]
    fn executions_are_read_from_what_a_fuzzer_prints() {
        let printed = "Done 5 runs\nstat::number_of_executed_units: 219679\nstat::x: 1\n";
        assert_eq!(executions(printed), Some("219679"));
        assert_eq!(executions("killed"), None);
    }
}
