//! Hold: the wheel stays where it is, however bad the line.

use crate::fixture::{Fixture, ID, degrees, ms};
use motorlink_bus::{Activity, Command};
use motorlink_protocol::Mode;
use motorlink_simulator::{WireFaults, WorldConfig};

const GOAL_DEG: f32 = 170.0;

fn losing(lose_reply: f64, seed: u64) -> Fixture {
    let config = WorldConfig {
        seed,
        faults: WireFaults {
            lose_reply,
            ..WireFaults::default()
        },
        ..WorldConfig::default()
    };
    let mut fixture = Fixture::watching(config, &[ID]);
    for _ in 0..10 {
        let _ = fixture.command(Command::SwitchMode {
            id: ID,
            mode: Mode::Position,
        });
        fixture.run(ms(600));
        if fixture.drive(degrees(GOAL_DEG)).is_ok() {
            return fixture;
        }
    }
    panic!("not in the position loop with {lose_reply} lost, seed {seed}");
}

/// The distance that the wheel lies from where it was at Hold once it rests, in degrees, and whether it
/// lies at the goal that was given up.
fn travel(lose_reply: f64, seed: u64) -> Option<(f32, bool)> {
    let mut fixture = losing(lose_reply, seed);
    fixture.run(ms(40 + seed * 2));
    let turns = |fixture: &Fixture| fixture.world.motor(ID).unwrap().turns();
    let before = turns(&fixture);
    // On so bad a line the setpoint may have been withdrawn: then there is nothing to hold.
    fixture.command(Command::Hold(ID)).ok()?;
    fixture.run(ms(2_500));
    let off_deg = (turns(&fixture) - before).abs() * 360.0;
    let angle = fixture.world.motor(ID).unwrap().angle_deg();
    Some((off_deg, (angle - GOAL_DEG).abs() < 3.0 && off_deg > 5.0))
}

#[test]
fn a_held_wheel_stays_within_10_degrees_however_many_replies_are_lost() {
    for lose_reply in [0.0, 0.05, 0.15, 0.45] {
        let runs: Vec<_> = (0..149)
            .filter_map(|seed| Some((seed, travel(lose_reply, seed)?)))
            .collect();
        let worst = runs
            .iter()
            .max_by(|a, b| a.1.0.total_cmp(&b.1.0))
            .expect("runs that hold");
        let at_goal = runs.iter().filter(|(_, (_, at_goal))| *at_goal).count();
        println!(
            "travel after Hold, {:.0} % of replies lost: worst of {} runs {:.1} degrees (seed {}), {at_goal} at the old goal",
            lose_reply * 100.0,
            runs.len(),
            worst.1.0,
            worst.0,
        );
        assert!(runs.len() > 100, "{} runs", runs.len());
        assert_eq!(at_goal, 0, "{lose_reply}");

        assert!(worst.1.0 <= 10.0, "{lose_reply}: {worst:?}");
    }
}

#[test]
fn hold_without_any_angle_is_a_stop() {
    let mut fixture = Fixture::one_motor();
    fixture.switch(Mode::Position);
    fixture.drive(degrees(170.0)).unwrap();
    fixture.run(ms(100));
    fixture.world.motor_mut(ID).unwrap().mute(true);
    fixture.run(ms(205));
    if fixture.command(Command::Hold(ID)).is_ok() {
        assert!(matches!(fixture.activity(), Activity::Stopping { .. }));
    } else {
        // The silence has withdrawn the setpoint already.
        assert!(!matches!(fixture.activity(), Activity::Driven { .. }));
    }
}
