//! Python computes the figures of known systems, and of exported runs.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

use crate::bench::{Bench, ONE, header};
use motorlink_experiments::{
    kept::{figures_to_csv, record_to_csv},
    sequence::Sequence,
    study::{FrequencyStudy, Measured, StepStudy, Study},
};
use motorlink_protocol::Acceleration;
use motorlink_simulator::MotorConfig;

const NEEDS: &str = "needs python-control: cargo xtask test --only figures-in-python";

/// What the script prints.
fn printed(arguments: &[&Path]) -> String {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/independent/figures.py");
    let mut command = Command::new(env::var_os("MOTORLINK_PYTHON").expect(NEEDS));
    let output = command.arg(script).args(arguments).output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    assert!(output.status.success());
    String::from_utf8(output.stdout).unwrap().replace('\r', "")
}

#[test]
#[ignore = "needs python-control: cargo xtask test --only figures-in-python"]
fn the_figures_of_known_systems_are_those_of_python_control() {
    let kept = include_str!("independent/known_systems.csv");
    assert_eq!(printed(&[Path::new("systems")]), kept);
}

/// The number of compared figures of a run of this study. The script fails if one differs.
fn compared(study: &Study, seed: u64) -> u32 {
    let mut bench = Bench::new(seed, MotorConfig::default());
    bench.run_sequence(&study.sequence());
    let record = &bench.record;
    let header = header(study, record);
    let findings = study.evaluate(record, &header.measured());
    assert_eq!(header.measured(), Measured::default());
    let dir = env::temp_dir().join(format!("motorlink-figures-{seed}-{}", std::process::id()));
    fs::create_dir_all(&dir).unwrap();
    let file = |name: &str, text: String| -> PathBuf {
        let path = dir.join(name);
        fs::write(&path, text).unwrap();
        path
    };
    let run = file("run.csv", record_to_csv(record));
    let figures = file("figures.csv", figures_to_csv(&header, study, &findings));
    let count = printed(&[Path::new("compare"), &run, &figures]);
    fs::remove_dir_all(&dir).unwrap();
    count.trim().parse().unwrap()
}

#[test]
#[ignore = "needs python-control: cargo xtask test --only figures-in-python"]
fn the_figures_of_an_exported_step_are_those_of_the_script() {
    // The second acceleration does not settle: only latency and peaks are compared.
    let study = |from_rpm, to_rpm| {
        Study::Step(StepStudy {
            from_rpm,
            to_rpm,
            repeats: 3,
            accelerations: vec![Acceleration::new(1), Acceleration::new(20)],
            ..StepStudy::of(ONE)
        })
    };
    assert!(compared(&study(0.0, 100.0), 1) >= 3 * 8 + 3 * 4 + 4);
    assert!(compared(&study(-100.0, 100.0), 2) >= 3 * 8 + 3 * 4);
    assert!(compared(&study(120.0, 20.0), 3) >= 6 * 8);
}

#[test]
#[ignore = "needs python-control: cargo xtask test --only figures-in-python"]
fn the_tracking_error_of_an_exported_sequence_is_that_of_the_script() {
    let text = r#"{ "motorlink_sequence": 1, "steps": [
        { "rpm": 60, "for_s": 2 },
        { "rpm": 60, "shape": "sine", "amplitude": 30, "hz": 0.5, "for_s": 6 }] }"#;
    let sequence = Sequence::from_json(text).unwrap();
    assert_eq!(compared(&Study::Sequence(sequence), 5), 4);
}

#[test]
#[ignore = "needs python-control: cargo xtask test --only figures-in-python"]
fn the_points_of_an_exported_frequency_response_are_those_of_the_script() {
    assert!(compared(&Study::Frequency(FrequencyStudy::of(ONE)), 4) >= 15 * 3 + 4);
}
