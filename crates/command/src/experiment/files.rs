//! The files of a run.

use std::{fs, path::Path};

use motorlink_experiments::{
    chart::{AxisName, charts},
    kept::{ReportRun, ReportTexts, figures, figures_to_csv, record_to_csv, report, run_to_json},
    study::Findings,
};
use motorlink_runs::RecordedRun;

use crate::{failure::Failure, output::say};

/// Writes the run, its record, its figures and a report to this folder.
pub fn write(folder: &Path, run: &RecordedRun, findings: &Findings) -> Result<(), Failure> {
    let (header, record) = (run.header(), run.record());
    let stem = format!("run-{}", header.number);
    let files = [
        ("json", run_to_json(header, record)),
        ("csv", record_to_csv(record)),
        ("figures.csv", figures_to_csv(header, run.study(), findings)),
        ("html", to_report(run, findings)),
    ];
    for (end, text) in files {
        let path = folder.join(format!("{stem}.{end}"));
        fs::write(&path, text).map_err(Failure::file(&path))?;
        say(format_args!("{}", path.display()));
    }
    Ok(())
}

/// One HTML file with the charts and the figures.
fn to_report(run: &RecordedRun, findings: &Findings) -> String {
    let texts = ReportTexts {
        language: "en",
        title: run.header().name.clone(),
    };
    let mut rows = vec![
        ("Model".to_owned(), run.header().model.clone()),
        ("Run".to_owned(), run.plan().to_string()),
    ];
    for row in figures(findings) {
        let cells = row.into_iter();
        rows.extend(cells.map(|(name, cell)| (name.to_owned(), cell.text())));
    }
    let section = ReportRun {
        name: run.header().name.clone(),
        rows,
        meaning: Vec::new(),
    };
    let charts = charts(findings, &|byte| format!("Acceleration {byte}"));
    report(&texts, &[section], &charts, &axis)
}

fn axis(name: AxisName) -> String {
    match name {
        AxisName::Time => "Time (s)",
        AxisName::Speed => "Speed (rpm)",
        AxisName::Current => "Current (A)",
        AxisName::Temperature => "Temperature (°C)",
        AxisName::Frequency => "Frequency (Hz)",
        AxisName::Gain => "Gain (dB)",
        AxisName::Phase => "Phase (°)",
        AxisName::Position => "Position (°)",
        AxisName::RSquared => "R² of the sine",
    }
    .to_owned()
}
