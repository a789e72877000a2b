//! A study that runs beside the bus has its first step among its figures.
#![cfg(test)]

mod bench;

use std::time::Duration;

use bench::{Bench, ONE, ms};
use motorlink_experiments::{
    runner::{Options, Phase},
    study::{Findings, Measured, Study, StudyKind},
};
use motorlink_protocol::{Mode, family::Model};

/// The findings of a study as the page gets them.
fn findings(kind: StudyKind, mode: Mode, longest: Duration) -> Findings {
    let study = Study::of(kind, ONE);
    let mut bench = Bench::new(Model::Ddsm115, 1);
    bench.switch_to(mode);
    bench.arm_sequence(study.sequence().to_json(), Options::default());
    bench.start();
    bench.run(longest);
    assert!(matches!(bench.phase(), Some(Phase::Ended(_))));
    study.evaluate(&bench.whole_record(), &Measured::default())
}

#[test]
fn friction_measures_all_its_speeds() {
    let found = findings(StudyKind::Friction, Mode::Velocity, ms(90_000));
    let Findings::Friction(found) = found else {
        panic!("{found:?}");
    };
    assert_eq!((found.levels.len(), found.left_out), (12, 0));
}

#[test]
fn a_coast_down_measures_all_its_pushes() {
    let found = findings(StudyKind::CoastDown, Mode::Current, ms(600_000));
    let Findings::CoastDown(found) = found else {
        panic!("{found:?}");
    };
    assert_eq!(found.coasts.len(), 6);
    assert!(found.inertia.is_some());
}
