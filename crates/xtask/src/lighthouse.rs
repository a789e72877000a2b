//! Lighthouse on the released site: loading on a desktop and on a phone, accessibility and best practices.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use serde_json::Value;

use crate::browser;
use crate::npm;
use crate::process;
use crate::serve;
use crate::site;
use crate::site_file::Profile;
use crate::workspace::Workspace;

/// A figure of the report and its limit.
struct Figure {
    name: &'static str,
    /// JSON pointer into the report.
    at: &'static str,
    must: Must,
}

enum Must {
    /// A share of 1, printed in percent.
    ScoreAtLeast(f64),
    AtMost(f64),
    /// Printed, without a limit.
    Show,
}

const FIGURES: [Figure; 9] = [
    Figure {
        name: "performance",
        at: "/categories/performance/score",
        must: Must::ScoreAtLeast(0.95),
    },
    Figure {
        name: "accessibility",
        at: "/categories/accessibility/score",
        must: Must::ScoreAtLeast(1.0),
    },
    Figure {
        name: "best practices",
        at: "/categories/best-practices/score",
        must: Must::ScoreAtLeast(1.0),
    },
    Figure {
        name: "layout shift",
        at: "/audits/cumulative-layout-shift/numericValue",
        must: Must::AtMost(0.0),
    },
    Figure {
        name: "first paint, ms",
        at: "/audits/first-contentful-paint/numericValue",
        must: Must::Show,
    },
    Figure {
        name: "largest paint, ms",
        at: "/audits/largest-contentful-paint/numericValue",
        must: Must::Show,
    },
    Figure {
        name: "blocked, ms",
        at: "/audits/total-blocking-time/numericValue",
        must: Must::Show,
    },
    Figure {
        name: "speed index, ms",
        at: "/audits/speed-index/numericValue",
        must: Must::Show,
    },
    // The phone's processor is this machine's, taken four times as slow; Lighthouse means one of 1,500.
    Figure {
        name: "machine's speed",
        at: "/environment/benchmarkIndex",
        must: Must::Show,
    },
];

/// Runs of each preset. Other programs change the score by up to ten, so that the median run counts, as
/// Lighthouse recommends.
const RUNS: usize = 3;

/// The two presets: their names and flags.
const PRESETS: [(&str, &[&str]); 2] = [("desktop", &["--preset=desktop"]), ("mobile", &[])];

/// Builds the site and checks it.
pub fn run(workspace: &Workspace) -> Result<()> {
    let dist = site::build(workspace, Profile::Release)?;
    judge(workspace, &dist)
}

/// Checks a built site, prints a table, and fails if a figure misses its limit.
pub fn judge(workspace: &Workspace, dist: &Path) -> Result<()> {
    let browser = browser::ensure()?;
    let program = npm::LIGHTHOUSE.ensure()?;
    let server = serve::start(dist, serve::listen(Some(0))?)?;
    let url = format!("{}/", server.origin());
    let judge_once = |name: &str, flags: &[&str]| {
        let report = report_file(workspace, name)?;
        let mut node = Command::new("node");
        node.arg(&program)
            .arg(&url)
            .args(flags)
            .args(["--quiet", "--output=json"])
            .arg(format!("--output-path={}", report.display()))
            .arg("--only-categories=performance,accessibility,best-practices")
            // Where a browser runs as root, as in containers, it has no sandbox.
            .arg("--chrome-flags=--headless=new --no-sandbox --disable-dev-shm-usage")
            .env("CHROME_PATH", &browser.chromium);
        process::run(&mut node)?;
        let text =
            fs::read_to_string(&report).with_context(|| format!("reading {}", report.display()))?;
        serde_json::from_str(&text).with_context(|| format!("reading {}", report.display()))
    };
    let mut reports: Vec<Value> = Vec::new();
    for (name, flags) in PRESETS {
        let runs: Result<Vec<Value>> = (0..RUNS).map(|_| judge_once(name, flags)).collect();
        reports.extend(middle(runs?));
    }
    let not_reached = table(&reports);
    for report in &reports {
        for audit in failed_audits(report) {
            println!("{audit}");
        }
    }
    if not_reached.is_empty() {
        return Ok(());
    }
    bail!("Lighthouse: {} not reached", not_reached.join(", "))
}

/// The run with the median score for performance.
fn middle(mut runs: Vec<Value>) -> Option<Value> {
    let score = |run: &Value| {
        let score = run.pointer("/categories/performance/score");
        score.and_then(Value::as_f64).unwrap_or_default()
    };
    runs.sort_by(|one, other| score(one).total_cmp(&score(other)));
    let place = runs.len() / 2;
    (place < runs.len()).then(|| runs.swap_remove(place))
}

fn report_file(workspace: &Workspace, preset: &str) -> Result<PathBuf> {
    let dir = workspace.target().join("lighthouse");
    fs::create_dir_all(&dir).with_context(|| format!("making {}", dir.display()))?;
    Ok(dir.join(format!("{preset}.json")))
}

/// Prints the figures, and returns those that miss their limits.
fn table(reports: &[Value]) -> Vec<String> {
    let mut not_reached = Vec::new();
    println!("{:20} {:>10} {:>10}", "Lighthouse", "desktop", "mobile");
    for Figure { name, at, must } in &FIGURES {
        let mut cells = Vec::new();
        for ((preset, _), report) in PRESETS.iter().zip(reports) {
            let value = report.pointer(at).and_then(Value::as_f64);
            let (cell, reached) = match (value, must) {
                (None, _) => ("-".to_owned(), matches!(must, Must::Show)),
                (Some(value), Must::ScoreAtLeast(least)) => {
                    (format!("{:.0}", value * 100.0), value >= *least)
                }
                (Some(value), Must::AtMost(most)) => (format!("{value:.4}"), value <= *most),
                (Some(value), Must::Show) => (format!("{value:.0}"), true),
            };
            if !reached {
                not_reached.push(format!("{name} ({preset})"));
            }
            cells.push(cell);
        }
        let [desktop, mobile] = cells.as_slice() else {
            continue;
        };
        println!("{name:20} {desktop:>10} {mobile:>10}");
    }
    not_reached
}

/// The audits that count into a score and failed.
fn failed_audits(report: &Value) -> Vec<String> {
    let mut failed_audits = Vec::new();
    for category in ["accessibility", "best-practices"] {
        let audits = report.pointer(&format!("/categories/{category}/auditRefs"));
        for audit in audits.and_then(Value::as_array).into_iter().flatten() {
            let weight = audit.get("weight").and_then(Value::as_f64);
            let id = audit.get("id").and_then(Value::as_str).unwrap_or_default();
            let score = report.pointer(&format!("/audits/{id}/score"));
            let title = report.pointer(&format!("/audits/{id}/title"));
            let fails = score
                .and_then(Value::as_f64)
                .is_some_and(|score| score < 1.0);
            if weight.unwrap_or_default() > 0.0 && fails {
                failed_audits.push(format!(
                    "{category}: {}",
                    title.and_then(Value::as_str).unwrap_or(id)
                ));
            }
        }
    }
    failed_audits
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn report(performance: f64, shift: f64) -> Value {
        json!({
            "categories": {
                "performance": { "score": performance },
                "accessibility": { "score": 1.0, "auditRefs": [{ "id": "label", "weight": 7 }] },
                "best-practices": { "score": 1.0 },
            },
            "audits": {
                "cumulative-layout-shift": { "numericValue": shift },
                "label": { "score": 0.0, "title": "Form elements have labels" },
            },
        })
    }

    #[test]
    fn the_median_run_counts() {
        let runs = [0.9, 0.7, 0.8].map(|score| report(score, 0.0)).to_vec();
        assert_eq!(middle(runs), Some(report(0.8, 0.0)));
        assert_eq!(middle(Vec::new()), None);
    }

    #[test]
    fn a_figure_that_misses_its_limit_is_named_with_its_preset() {
        assert_eq!(table(&[report(0.95, 0.0), report(1.0, 0.0)]), [""; 0]);
        assert_eq!(
            table(&[report(0.99, 0.0001), report(0.94, 0.0)]),
            ["performance (mobile)", "layout shift (desktop)"]
        );
        let missing = table(&[json!({}), report(1.0, 0.0)]);
        assert_eq!(
            missing.len(),
            4,
            "a missing figure misses its limit: {missing:?}"
        );
    }

    #[test]
    fn failed_audits_are_listed() {
        assert_eq!(
            failed_audits(&report(1.0, 0.0)),
            ["accessibility: Form elements have labels"]
        );
    }
}
