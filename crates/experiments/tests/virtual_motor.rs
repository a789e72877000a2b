//! Experiments on the virtual motor against what it was built with.

use crate::bench::Bench;
use crate::measured::{DRY, HEATING_S, INERTIA, VISCOUS, friction_and_inertia, warm_up};
use motorlink_experiments::{
    analysis::{SpeedLevel, friction},
    sequence::Template,
};
use motorlink_simulator::MotorConfig;

#[test]
fn friction_and_inertia_are_within_five_percent_and_inside_their_confidence() {
    let mut inside = [0; 3];
    let mut worst = 0.0_f64;
    for seed in 0..100 {
        let (_, found, dry) = friction_and_inertia(seed);
        let pairs = [
            (found.inertia_kg_m2, INERTIA),
            (found.dry_nm, dry),
            (found.viscous_nm_s, VISCOUS),
        ];
        for ((estimate, truth), inside) in pairs.into_iter().zip(&mut inside) {
            worst = worst.max((estimate.value / truth - 1.0).abs());
            *inside += u32::from(estimate.holds(truth));
        }
    }
    assert!(worst < 0.05, "{worst}");
    assert!(
        inside.into_iter().all(|count| count >= 95),
        "{inside:?} of 100"
    );
}

#[test]
fn a_winding_warms_up_with_its_time_constant() {
    let found = warm_up(1);
    // 1.001 N.m over 0.75 N.m/A and 5.2 rad/s of viscous friction: 1.336 A, 6.1 ohm, 4 K/W.
    let final_c = 28.0 + 4.0 * 6.1 * 1.3354_f64.powi(2);
    assert!(
        (found.final_c.value / final_c - 1.0).abs() < 0.02,
        "{found:?} {final_c}"
    );
    assert!(
        (found.time_constant_s.value / HEATING_S - 1.0).abs() < 0.03,
        "{found:?}"
    );
    assert!(found.time_constant_s.holds(HEATING_S), "{found:?}");
}

/// The virtual motor reports its torque current and, at a right angle to it, 0.235 A of field current.
#[test]
fn speed_against_current_gives_what_the_motor_reports() {
    let load_nm = 0.75;
    let motor = MotorConfig {
        load_nm: 0.75,
        ..MotorConfig::default()
    };
    let run = Bench::new(5, motor).run_sequence(&Template::Staircase.sequence());
    let mut levels = Vec::new();
    for step in [0, 1, 2, 3, 7, 8, 9, 10] {
        for times in run.times(step) {
            levels.extend(SpeedLevel::of(run.rpm(times), run.amps(times), 2.0));
        }
    }
    let reported = |rpm: f64| {
        let torque_nm = DRY + load_nm + VISCOUS * rpm * std::f64::consts::TAU / 60.0;
        (torque_nm / 0.75).hypot(0.235)
    };
    let found = friction(&levels).unwrap();
    for rpm in [20.0, 80.0] {
        let amps = found.coulomb_a.value + found.viscous_a_per_rpm.value * rpm;
        assert!(
            (amps / reported(rpm) - 1.0).abs() < 0.01,
            "{rpm} rpm: {amps} A, {found:?}"
        );
    }
    assert!(found.coulomb_a.plus_minus < 0.02 && found.coulomb_a.plus_minus > 1e-4);
    assert_eq!(friction(&levels[..2]), None);
}
