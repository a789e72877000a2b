//! A script of numpy and scipy computes each figure with an interval from the exported CSV file of the same run.

use std::{env, fs, process::Command};

use crate::noisy_runs::figures;
use motorlink_experiments::{kept::record_to_csv, study::StudyKind};

const SCRIPT: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/tests/independent/intervals.py"
);
/// Two digits of an interval are shown: this part of it is below the last one.
const ROUNDING: f64 = 0.02;

#[test]
#[ignore = "needs Python packages: cargo xtask test --only figures-in-python"]
fn numpy_and_scipy_compute_the_same_figures() {
    let python =
        env::var_os("MOTORLINK_PYTHON").expect("MOTORLINK_PYTHON names a Python with the packages");
    for kind in [
        StudyKind::Friction,
        StudyKind::CoastDown,
        StudyKind::Heating,
        StudyKind::TorqueSpeed,
    ] {
        for seed in 0..3 {
            let (study, record, figures) = figures(kind, seed, 0.5);
            let name = format!(
                "motorlink-{}-{}-{seed}.csv",
                std::process::id(),
                kind.field()
            );
            let path = env::temp_dir().join(name);
            fs::write(&path, record_to_csv(&record)).unwrap();
            let output = Command::new(&python)
                .arg(SCRIPT)
                .arg(study.to_json())
                .arg(&path)
                .output()
                .unwrap();
            fs::remove_file(&path).unwrap();
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{said}");
            let text = String::from_utf8(output.stdout).unwrap();
            let lines: Vec<&str> = text.lines().collect();
            assert_eq!(lines.len(), figures.len(), "{text}");
            for (line, (name, _, found)) in lines.into_iter().zip(figures) {
                let (value, plus_minus) = line.split_once(',').unwrap();
                let [value, plus_minus] = [value, plus_minus].map(|it| it.parse::<f64>().unwrap());
                let Some(found) = found else {
                    assert!(
                        plus_minus.is_nan() || plus_minus > 0.4 * value,
                        "{name}: {line}"
                    );
                    continue;
                };
                let off = (value - found.value)
                    .abs()
                    .max((plus_minus - found.plus_minus).abs());
                assert!(
                    off < ROUNDING * found.plus_minus,
                    "{name}, seed {seed}: {line} {found:?}"
                );
            }
        }
    }
}
