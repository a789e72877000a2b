//! Lighthouse on the released site: how it loads on a desktop and on a phone, and whether it keeps to what
//! browsers advise.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use serde_json::Value;

use crate::browser;
use crate::npm;
use crate::process;
use crate::serve;
use crate::site::{self, Profile};
use crate::workspace::Workspace;

/// A figure of the report and the least or most that it may be.
struct Figure {
    name: &'static str,
    /// Where it is in the report.
    at: &'static str,
    must: Must,
}

enum Must {
    /// A share of 1, shown in hundredths.
    ScoreAtLeast(f64),
    AtMost(f64),
    /// Only shown.
    Tell,
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
        must: Must::Tell,
    },
    Figure {
        name: "largest paint, ms",
        at: "/audits/largest-contentful-paint/numericValue",
        must: Must::Tell,
    },
    Figure {
        name: "blocked, ms",
        at: "/audits/total-blocking-time/numericValue",
        must: Must::Tell,
    },
    Figure {
        name: "speed index, ms",
        at: "/audits/speed-index/numericValue",
        must: Must::Tell,
    },
    // The phone's processor is this machine's, taken four times as slow; Lighthouse means one of 1,500.
    Figure {
        name: "machine's speed",
        at: "/environment/benchmarkIndex",
        must: Must::Tell,
    },
];

/// How often each preset is judged: what other programs do meanwhile moves the score by ten. The run in the
/// middle is shown, as Lighthouse advises.
const RUNS: usize = 3;

/// The two presets: their names and flags.
const PRESETS: [(&str, &[&str]); 2] = [("desktop", &["--preset=desktop"]), ("mobile", &[])];

/// Builds the site and judges it.
pub fn run(workspace: &Workspace) -> Result<()> {
    let dist = site::build(workspace, Profile::Release)?;
    judge(workspace, &dist)
}

/// Judges a built site, prints a table, and fails where a figure is not reached.
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
    let missed = table(&reports);
    for report in &reports {
        for complaint in complaints(report) {
            println!("{complaint}");
        }
    }
    if missed.is_empty() {
        return Ok(());
    }
    bail!("Lighthouse: {} not reached", missed.join(", "))
}

/// The run with the middle of all scores for performance.
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

/// Prints the figures, and gives those that are not reached.
fn table(reports: &[Value]) -> Vec<String> {
    let mut missed = Vec::new();
    println!("{:20} {:>10} {:>10}", "Lighthouse", "desktop", "mobile");
    for Figure { name, at, must } in &FIGURES {
        let mut cells = Vec::new();
        for ((preset, _), report) in PRESETS.iter().zip(reports) {
            let value = report.pointer(at).and_then(Value::as_f64);
            let (cell, reached) = match (value, must) {
                (None, _) => ("-".to_owned(), matches!(must, Must::Tell)),
                (Some(value), Must::ScoreAtLeast(least)) => {
                    (format!("{:.0}", value * 100.0), value >= *least)
                }
                (Some(value), Must::AtMost(most)) => (format!("{value:.4}"), value <= *most),
                (Some(value), Must::Tell) => (format!("{value:.0}"), true),
            };
            if !reached {
                missed.push(format!("{name} ({preset})"));
            }
            cells.push(cell);
        }
        let [desktop, mobile] = cells.as_slice() else {
            continue;
        };
        println!("{name:20} {desktop:>10} {mobile:>10}");
    }
    missed
}

/// What counts into a score and is not as it should be.
fn complaints(report: &Value) -> Vec<String> {
    let mut complaints = Vec::new();
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
                complaints.push(format!(
                    "{category}: {}",
                    title.and_then(Value::as_str).unwrap_or(id)
                ));
            }
        }
    }
    complaints
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
    fn the_run_in_the_middle_counts() {
        let runs = [0.9, 0.7, 0.8].map(|score| report(score, 0.0)).to_vec();
        assert_eq!(middle(runs), Some(report(0.8, 0.0)));
        assert_eq!(middle(Vec::new()), None);
    }

    #[test]
    fn what_is_not_reached_is_named_with_its_preset() {
        assert_eq!(table(&[report(0.95, 0.0), report(1.0, 0.0)]), [""; 0]);
        assert_eq!(
            table(&[report(0.99, 0.0001), report(0.94, 0.0)]),
            ["performance (mobile)", "layout shift (desktop)"]
        );
        let missing = table(&[json!({}), report(1.0, 0.0)]);
        assert_eq!(
            missing.len(),
            4,
            "what is missing is not reached: {missing:?}"
        );
    }

    #[test]
    fn what_is_wrong_is_said() {
        assert_eq!(
            complaints(&report(1.0, 0.0)),
            ["accessibility: Form elements have labels"]
        );
    }
}
